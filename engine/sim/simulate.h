// The course of a run, written once for both solvers. x: states, u: held signals; - before, + after a tick.
//
//   start      sources at t = 0 give u; blocks start; delay lines are filled with their first values (control: tick 0)
//   tick k     1 sample    evaluate all signals from (x-, u-); samples leave the delay lines of the sensors, and
//                          those that a sensor shows whole periods later enter them
//              2 control   each controller that is due ticks, in data-flow order (ties by name); it sees the samples
//                          of 1 and the new outputs of the controllers before it
//              3 hold      sources and controllers give the commands u+; commands enter the delay lines
//              4 record    row k: commands u+ and samples of 1
//              5 integrate to tick k + 1, stopping at the fixed cuts of the period: there a delayed command switches
//                          and a shifted sample is taken; events are located within (reference) or stepped over
//                          (realtime)
//
// Row k of a trace thus holds what was measured at t_k and what was commanded from t_k on.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/status.h"
#include "sim/rig.h"
#include "sim/solver.h"

namespace dynoproof {

/// What a run gives: one row per tick.
struct Samples {
  std::vector<double> time;                  // steps + 1 [s]
  std::vector<std::vector<double>> inputs;   // by Rig::inputs, commands
  std::vector<std::vector<double>> outputs;  // by Rig::outputs, samples
  std::map<std::string, std::int64_t> counters;
  std::string solver_summary;
};

/// One run, tick by tick; the frame may be saved and put back between ticks.
class Simulation {
 public:
  Simulation(const Rig& rig, Solver& solver) : rig_(rig), solver_(solver), frame_(rig.MakeFrame()) {}

  Status Start();
  /// Steps 1 to 4 of the present tick.
  Status Tick();
  /// Between 4 and 5: the states by what the samples miss.
  void Correct(Correction& correction, std::span<const double> errors) { correction.Apply(frame_, errors); }
  /// The signals by the states and commands that the next period begins with.
  void Evaluate() { solver_.Evaluate(frame_, rig_.SecondsOf(frame_.time)); }
  /// Step 5.
  Status Integrate();

  const Frame& frame() const { return frame_; }
  void Restore(const Frame& frame) { frame_ = frame; }
  double InputCommand(std::size_t input) const { return frame_.signals[rig_.inputs[input].command]; }
  double OutputSample(std::size_t output) const { return frame_.signals[rig_.outputs[output].sample]; }

 private:
  void TakeSamples();
  void TickControls();
  void HoldCommands();
  Status CheckFinite() const;

  const Rig& rig_;
  Solver& solver_;
  Frame frame_;
};

/// How long the periods of a run took on this machine, for a look at them: counts on a logarithmic scale. Never part of
/// a result, a trace or a verdict.
struct StepTimes {
  static constexpr int kBinsPerDecade = 20, kBins = 6 * kBinsPerDecade;
  static constexpr double kLeast_s = 1e-8;
  std::array<std::int64_t, kBins> counts = {};  // bin i begins at kLeast_s 10^(i / kBinsPerDecade)
  void Add(double duration_s);
};

/// Called now and then with the fraction done; false stops the run (it then fails with "interrupted").
using Progress = std::function<bool(double)>;

/// Runs the rig from start to end.
Result<Samples> Simulate(const Rig& rig, Solver& solver, const Progress& progress = {}, StepTimes* times = nullptr);

}  // namespace dynoproof
