#include "diagnosis/course.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/parts.h"
#include "diagnosis/policy.h"
#include "identification/between_samples.h"

namespace dynoproof::diagnosis {
namespace {

bool Allows(const Plan& plan, const MappedRecord& record, const std::string& between) {
  const std::vector<std::string> possible = identification::PossibleBetween(plan, record);
  return std::ranges::find(possible, between) != possible.end();
}

/// Whether that is what was guessed.
bool IsOn(const Plan& plan, const MappedRecord& record, const std::string& between) {
  return std::ranges::all_of(identification::UnstatedInputs(plan, record), [&](const std::string& input) {
    const auto own = record.between.find(input);
    return own != record.between.end() && own->second == between;
  });
}

/// Whether a run goes on between samples of inputs of which nobody says what they do there.
bool IsDoubtful(const Plan& plan, const MappedRecord& record) {
  constexpr double kFiner = 1.5;
  return std::ranges::any_of(identification::UnstatedInputs(plan, record), [&](const std::string& input) {
    const auto step = record.step_s.find(input);
    return step == record.step_s.end() || step->second > kFiner * record.period_s;
  });
}

/// A model fitted beside other data, from its fit at a level, and with nominal values anew: these may have made up for a wrong course.
estimation::Estimate LeastFrom(const Contestant& model, std::size_t level, const estimation::Predictor& there) {
  const estimation::EstimatorOptions how{.renewals = 6, .points = PointsFor(model.hypothesis), .near = true};
  const Eigen::VectorXd& fitted = model.levels[level].q;
  const auto of_effects = static_cast<Eigen::Index>(model.hypothesis.of_effects());
  Eigen::VectorXd anew = model.hypothesis.start();
  anew.head(of_effects) = fitted.head(of_effects);
  estimation::Estimate best = estimation::Fit(model.hypothesis, there, fitted, how);
  estimation::Estimate other = estimation::Fit(model.hypothesis, there, anew, how);
  return other.ok() && (!best.ok() || LogExcess(other.scales, there.data()) < LogExcess(best.scales, there.data()))
             ? other
             : best;
}

}  // namespace

std::optional<Course> OtherCourse(const Plan& plan, const Contest& contest, const Levels& levels,
                                  const Registry& registry) {
  const Contestant *corrected = LeaderAt(contest.contestants, levels, contest.first),
                   *free = LeaderAt(contest.contestants, levels, levels.free_run());
  const std::vector<MappedRecord>& records = levels.data().records();
  const auto doubtful = [&](const MappedRecord& record) { return IsDoubtful(plan, record); };
  if (corrected == nullptr || std::ranges::none_of(records, doubtful)) return {};
  const double own = LogLeft(corrected->levels[contest.first], levels);
  std::optional<Course> best;
  for (const std::string& between : identification::PossibleBetween(plan, records.front())) {
    if (!std::ranges::all_of(records, [&](const auto& record) { return Allows(plan, record, between); })) continue;
    if (std::ranges::all_of(records, [&](const auto& record) { return IsOn(plan, record, between); })) continue;
    const Result<std::unique_ptr<Levels>> there =
        Levels::Of(plan, OnCourse(records, plan, between), registry, 0.0, kComparedRows, &levels);
    if (!there.ok() || (*there)->size() <= contest.first) continue;
    for (const auto& [model, level] : {std::pair(corrected, contest.first), std::pair(free, levels.free_run())}) {
      if (model == nullptr) continue;
      const estimation::Estimate fit = LeastFrom(*model, level, (**there)[contest.first]);
      if (!fit.ok()) continue;
      const double times = std::exp(0.5 * (LogLeft(fit, **there) - own));
      if (times < policy::kOtherCourse && (!best || times < best->times)) best = Course{between, model->Name(), times};
    }
  }
  return best;
}

std::vector<MappedRecord> OnCourse(std::vector<MappedRecord> records, const Plan& plan, const std::string& between) {
  for (MappedRecord& record : records) {
    if (Allows(plan, record, between)) record = identification::WithBetween(std::move(record), plan, between);
  }
  return records;
}

}  // namespace dynoproof::diagnosis
