#include "experiment/check_windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/solver.h"

namespace dynoproof {
namespace {

/// The outputs of `reference` and of `realtime`, the latter started anew from the state of the former every `window_s`.
struct WindowedRun {
  Samples reference, restarted;
};
Result<WindowedRun> RunInWindows(const Rig& rig, double window_s) {
  Result<std::unique_ptr<Solver>> reference = MakeReferenceSolver(rig), realtime = MakeRealtimeSolver(rig);
  if (!reference.ok()) return reference.failure();
  if (!realtime.ok()) return realtime.failure();
  Simulation exact(rig, **reference), restarted(rig, **realtime);
  if (Status failed = exact.Start()) return *failed;
  if (Status failed = restarted.Start()) return *failed;
  const auto window = std::max<std::int64_t>(1, std::llround(window_s / rig.SecondsOf(rig.period)));
  WindowedRun run;
  for (Samples* samples : {&run.reference, &run.restarted}) samples->outputs.assign(rig.outputs.size(), {});
  for (std::int64_t step = 0; step <= rig.steps; ++step) {
    if (step > 0 && step % window == 0) {
      Frame frame = exact.frame();
      if (Status failed = (*realtime)->Resume(frame)) return *failed;
      restarted.Restore(frame);
    }
    for (auto [simulation, samples] : {std::pair(&exact, &run.reference), std::pair(&restarted, &run.restarted)}) {
      if (Status failed = simulation->Tick()) return *failed;
      samples->time.push_back(rig.SecondsOf(simulation->frame().time));
      for (std::size_t i = 0; i < rig.outputs.size(); ++i) samples->outputs[i].push_back(simulation->OutputSample(i));
      if (step == rig.steps) continue;
      if (Status failed = simulation->Integrate()) return *failed;
    }
  }
  return run;
}

}  // namespace

std::vector<score::Check> WindowsCheck::Run(CheckContext& context) const {
  const std::string name = "windows " + p_.signal;
  const Value* stated = context.plan().root.Find("prediction_window_s");
  const double window_s = p_.window_s > 0.0                          ? p_.window_s
                          : stated != nullptr && stated->is_number() ? stated->number()
                                                                     : 0.0;
  if (!(window_s > 0.0)) {
    return {FailedCheck(kName, name, p_.nrmse, "1", p_.origin, "neither window_s nor prediction_window_s is stated")};
  }
  const Result<WindowedRun> run = RunInWindows(context.rig(), window_s);
  if (!run.ok()) return {FailedCheck(kName, name, p_.nrmse, "1", p_.origin, run.failure().ToString())};
  const int output = FindOutput(context.rig(), p_.signal);
  const double inf = std::numeric_limits<double>::infinity();
  std::string what = fmt::format("windows of {} s", window_s);
  double distance = RelativeDistance(run->reference, run->restarted, output, -inf, inf);
  if (std::isnan(distance)) {  // a constant signal has no spread: its nominal takes that place
    const std::vector<double>&exact = run->reference.outputs[output], &restarted = run->restarted.outputs[output];
    distance = 0.0;
    for (std::size_t k = 0; k < exact.size() && !std::isnan(distance); ++k) {  // a NaN of a signal fails the check
      const double error = std::abs(exact[k] - restarted[k]);
      if (!(error <= distance)) distance = error;
    }
    distance /= context.rig().outputs[output].nominal;
    what += "; the signal is constant: its largest error over its nominal";
  }
  return {score::AtMost(name, kName, distance, p_.nrmse, "1", p_.origin, what)};
}

}  // namespace dynoproof
