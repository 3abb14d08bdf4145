// Linear analysis of a scenario: modes, practical resonances and zeros from its [analysis] input to its output.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/status.h"
#include "linear/frequency_response.h"
#include "linear/modes.h"
#include "linear/zeros.h"
#include "sim/rig.h"

namespace dynoproof {

/// [analysis]: which input and output, and what else is derived from a run.
struct AnalysisSettings {
  std::string input, output;
  double from_Hz = 1.0, to_Hz = 2000.0;
  double hull_window_s = 0.01;
  void Visit(auto& v) {
    v.Required("input", input, Any(), "name of an [input.NAME]");
    v.Required("output", output, Any(), "name of an [output.NAME]: a torque, speed or angle of the drive line");
    v.Optional("from_Hz", from_Hz, Positive(), "practical resonances from here");
    v.Optional("to_Hz", to_Hz, Positive(), "to here");
    v.Optional("hull_window_s", hull_window_s, Positive(), "window of the hull curve of the output");
  }
};

/// The settings, when the plan has them; faults become diagnostics.
std::optional<AnalysisSettings> ReadAnalysis(const Plan& plan, const Rig& rig, Diagnostics& diagnostics);

/// Everything `modes` shows.
struct LinearAnalysis {
  const mechanics::Network* network;  // of the rig's plant
  mechanics::ModalAnalysis modal;
  std::vector<mechanics::Resonance> resonances;
  mechanics::ZeroAnalysis zeros;   // empty where the input does not reach the output,
  std::string no_zeros = {};       // which this says then
  std::vector<std::string> notes;  // what the linearised line leaves out
};

/// "I1[37]" and "I1(4)" belong to the part "I1" of the user's model.
std::string ElementOf(const std::string& name);
/// A mode's energy by part: slices of a rotor are summed up. Shares, together 1.
std::vector<std::pair<std::string, double>> EnergyByElement(const mechanics::Network& network,
                                                            const mechanics::Mode& mode);

/// The transfer function from the input to the output; fails (exit code 2) when the plant is no drive line, or the
/// output no single torque, speed or angle.
Result<mechanics::TransferFunction> TransferOf(const Rig& rig, const AnalysisSettings& settings);
Result<LinearAnalysis> Analyse(const Rig& rig, const AnalysisSettings& settings);

}  // namespace dynoproof
