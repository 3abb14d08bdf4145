#include "diagnosis/polish.h"

#include <algorithm>

#include "diagnosis/parts.h"
#include "diagnosis/policy.h"

namespace dynoproof::diagnosis {

using Eigen::VectorXd;
using estimation::Estimate;
using estimation::Hypothesis;

bool Polish(Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level, const Plan& as) {
  if (!contestant.Holds(level)) return false;
  Hypothesis finer = contestant.hypothesis.AsExactAs(as);
  // Kept columns do where the minimum is near. Along a curved valley each step needs its own.
  VectorXd q = contestant.levels[level].q;
  Estimate again;
  for (const bool near : {true, false}) {
    again = estimation::Fit(finer, levels[level], q, {.converged = policy::kNamedTo, .near = near, .central = true});
    if (!again.ok() || again.termination == estimation::kSettled) break;
    q = again.q;
  }
  again = AsLoudAs(null, level, std::move(again));
  if (!again.ok() || !IsExact(again)) return false;
  contestant.levels[level] = std::move(again);
  contestant.hypothesis = std::move(finer);
  return true;
}

double FitToAll(Contestant& contestant, const Levels& levels, std::size_t level,
                const std::vector<MappedRecord>& records, const Plan& plan, const Registry& registry) {
  constexpr double kLonger = 3.0, kMost = 10.0;  // parts, each over the one before, and the last over the first
  if (!contestant.Holds(level)) return 0.0;
  const Hypothesis& model = contestant.hypothesis;
  const auto length = [](const std::vector<MappedRecord>& all) {
    return std::ranges::max_element(all, {}, &MappedRecord::end_s)->end_s;
  };
  const double searched_s = length(levels.data().records()), all_s = std::min(length(records), kMost * searched_s);
  const bool exact = level == levels.free_run() && IsExact(contestant.levels[level]);
  if (exact && !(all_s > searched_s)) return 0.0;
  const auto free_run = [&](const VectorXd& at, const Levels& part) {
    return LogLeftAt(at, model, part, part.free_run());
  };
  const VectorXd& before = contestant.levels[level].q;
  VectorXd q = before;
  double simulations = 0.0;
  std::unique_ptr<Levels> longer;
  for (double part_s = exact ? std::min(kLonger * searched_s, all_s) : searched_s;;
       part_s = std::min(kLonger * part_s, all_s)) {
    if (part_s > searched_s) {
      Result<std::unique_ptr<Levels>> made = Levels::Of(plan, records, registry, 0.0, kComparedRows, &levels, part_s);
      if (!made.ok() || (*made)->size() != levels.size()) return simulations;
      longer = *std::move(made);
    }
    const Levels& part = longer ? *longer : levels;
    const Estimate fit = estimation::Fit(model, part[level], q, {.converged = policy::kNamedTo, .near = true});
    const bool kept = fit.ok() && (exact ? IsExact(fit) : free_run(fit.q, part) <= free_run(before, part));
    if (longer) simulations += static_cast<double>(longer->simulations()) * part_s / searched_s;
    if (!kept) return simulations;
    q = fit.q;
    if (part_s >= all_s) {
      contestant.to_all = {q, HalfIntervalOf(fit, part.data(), model)};
      return simulations;
    }
  }
}

VectorXd HalfIntervalOf(const Estimate& fit, const estimation::DataSet& data, const Hypothesis& hypothesis) {
  constexpr double kTwoSided = 1.959964;
  return kTwoSided * estimation::Sandwich(fit, data, hypothesis)
                         .diagonal()
                         .cwiseMax(estimation::CurvatureOf(fit, hypothesis).diagonal())
                         .cwiseMax(0.0)
                         .cwiseSqrt();
}

}  // namespace dynoproof::diagnosis
