#include "thesis/two_stage.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <utility>
#include <vector>

#include "identification/identify.h"
#include "thesis/landmarks.h"

namespace dynoproof::identification {
namespace {

bool IsDamping(const std::string& key) { return key.substr(key.rfind('.') + 1).starts_with("damping"); }

Sighting SightingOf(const Landmarks& landmarks) {
  const auto& [resonances, gains, zeros] = landmarks;
  return {"landmarks",
          {{"resonances_hz", resonances}, {"gains", gains}, {"zeros_hz", zeros}},
          fmt::format("resonances at {:.1f} Hz; {}\n", fmt::join(resonances, ", "),
                      zeros.empty() ? "no zeros" : fmt::format("zeros at {:.1f} Hz", fmt::join(zeros, ", ")))};
}

Status InTwoStages(const EstimationProblem& problem, const std::vector<Axis>& axes, const IdentifyOptions& options,
                   Identified& result) {
  const Result<Landmarks> measured = MeasuredLandmarks(problem);
  if (!measured.ok()) return measured.failure();
  result.sighting = SightingOf(*measured);
  std::vector<Axis> still, damping;
  for (const Axis& axis : axes) (IsDamping(axis.key) ? damping : still).push_back(axis);
  Plan plan = problem.plan();
  const auto stage = [&](const std::vector<Axis>& own, const Objective& objective, double begin) -> Status {
    if (own.empty()) return {};
    const Result<Optimum> best = Minimise(
        plan, objective, own,
        {options.starts, TriesOf(options.keys, false), [&](double done) { options.progress(begin + 0.5 * done); }});
    if (!best.ok()) return best.failure();
    Take(*best, own, result);
    plan = With(std::move(plan), own, best->x);
    return {};
  };
  if (Status failed = stage(still, *FrequencyObjective(problem, *measured), 0.0)) return failed;
  return stage(damping, *GainObjective(problem, *measured), 0.5);
}

}  // namespace

void AddTwoStage() {
  AddMethod("two_stage",
            {"thesis (2.69) to (2.72): where a drive line's resonances and zeros lie, then how high the resonances are",
             InTwoStages});
}

}  // namespace dynoproof::identification
