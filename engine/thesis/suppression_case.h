// The robustness of the proposed suppression (thesis Sec. 5.5, 5.6), which nobody has published: many seeded runs of
// varied loops under loads from quiet to nasty, each placement judged against the eigenvalues of the loop at that
// moment.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/status.h"
#include "model/params.h"
#include "thesis/suppression_loop.h"

namespace dynoproof {

/// One run of the study: a loop and what loads it. The axes of a campaign name these.
struct SuppressionParameters {
  double I5_kg_m2 = 0.081, tau_a_s = 1e-3, rotor = 1.0, k3 = 1.0, k4 = 1.0, damping = 1.0, k_V = 9.7, noise_Nm = 1.0;
  int delay_samples = 0;
  std::string load = "quiet";
  double load_amplitude_Nm = 100.0, tone_Hz = 600.0, tone_offset_Hz = 40.0, tone_side = 1.0;
  double duration_s = 2.5, probe_gamma = 0.0;
  void Visit(auto& v) {
    v.Optional("I5_kg_m2", I5_kg_m2, Positive("kg m^2"), "inertia of the device under test");
    v.Optional("tau_a_s", tau_a_s, Positive(), "lag of the airgap torque");
    v.Optional("rotor", rotor, Positive("1"), "factor on the rotor's stiffness");
    v.Optional("k3", k3, Positive("1"), "factor on the stiffness k3");
    v.Optional("k4", k4, Positive("1"), "factor on the stiffness k4");
    v.Optional("damping", damping, Positive("1"), "factor on all damping");
    v.Optional("k_V", k_V, NonNegative("1"), "gain of the torque's feedthrough (2.3)");
    v.Optional("noise_Nm", noise_Nm, NonNegative(), "standard deviation on the measured torque");
    v.Optional("delay_samples", delay_samples, Between(0, 100), "of the command");
    v.Optional("load", load,
               std::vector<std::string>{"quiet", "printed", "gear_changes", "engine_sweep", "broadband", "near_tone",
                                        "far_tone"},
               "what acts on the device: nothing, the thesis' two tones, levels, a sweep, noise, one steady tone");
    v.Optional("load_amplitude_Nm", load_amplitude_Nm, NonNegative(), "of all loads but the thesis' own");
    v.Optional("tone_Hz", tone_Hz, Positive(), "of the far tone");
    v.Optional("tone_offset_Hz", tone_offset_Hz, NonNegative(), "near tone: from the first growing mode");
    v.Optional("tone_side", tone_side, Between(-1.0, 1.0, "1"), "near tone: -1 below, 1 above");
    v.Optional("duration_s", duration_s, Positive(), "length of the run");
    v.Optional("probe_gamma", probe_gamma, NonNegative("1"), "Appendix E; 0: no probing");
  }
};

struct SuppressionRun {
  std::vector<double> unstable_Hz;  // modes of the loop with its idle filters that grow
  struct Placement {
    double time_s, f_Hz;
    bool right;  // within 20 Hz of a mode that grew in the loop just before
  };
  std::vector<Placement> placements;
  int found = 0;               // of unstable_Hz: a placement within 20 Hz
  std::vector<double> times;   // to the first such placement of each, rising
  bool stable_at_end = false;  // the loop with its filters
  double peak_Nm = 0.0;        // largest shaft torque
};

/// The same parameters and seed give the same run.
Result<SuppressionRun> RunCase(const SuppressionParameters& parameters, std::uint64_t seed);

/// The smallest steady tone on the load that draws a filter to itself in a loop that is stable (setup 1, k_V), by
/// frequency; and the tone of at most `most_Nm` that, arriving after both filters are rightly placed (k_V = 9.7), does
/// the worst: found by seeded search.
struct SmallestTone {
  double frequency_Hz, amplitude_Nm;
};
Result<SmallestTone> SmallestMisleadingTone(double k_V, double from_Hz, double to_Hz, double step_Hz);
struct WorstLoad {
  double frequency_Hz = 0.0, amplitude_Nm = 0.0, peak_Nm = 0.0;
  int placements_after_load = 0;
  bool unstable_at_end = false;
  int tried = 0;
};
Result<WorstLoad> SearchWorstLoad(double most_Nm, int tries, std::uint64_t seed);

}  // namespace dynoproof
