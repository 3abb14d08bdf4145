#include "diagnosis/polish.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "diagnosis/parts.h"
#include "diagnosis/policy.h"

namespace dynoproof::diagnosis {

using Eigen::VectorXd;
using estimation::Estimate;
using estimation::Hypothesis;

namespace {

double LengthOf(const std::vector<MappedRecord>& records) {
  return std::ranges::max_element(records, {}, &MappedRecord::end_s)->end_s;
}

/// How much of the records one fit after the other looks at [s]: what the search has looked at, if that is asked for, and ever longer parts.
std::vector<double> PartsToFit(double searched_s, double all_s, bool from_the_search) {
  constexpr double kStep = 3.0, kMost = 10.0;  // over the part before, and over the search
  const double end_s = std::min(all_s, kMost * searched_s);
  std::vector<double> parts_s;
  if (from_the_search) parts_s.push_back(searched_s);
  for (double part_s = searched_s; part_s < end_s;) {
    part_s = std::min(kStep * part_s, end_s);
    parts_s.push_back(part_s);
  }
  return parts_s;
}

}  // namespace

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
  if (!contestant.Holds(level)) return 0.0;
  const Hypothesis& model = contestant.hypothesis;
  const bool exact = level == levels.free_run() && IsExact(contestant.levels[level]);
  const double searched_s = LengthOf(levels.data().records());
  const auto free_run = [&](const VectorXd& at, const Levels& part) {
    return LogLeftAt(at, model, part, part.free_run());
  };
  double simulations = 0.0;
  std::optional<Interval> found;
  for (const double part_s : PartsToFit(searched_s, LengthOf(records), !exact)) {
    std::unique_ptr<Levels> longer;
    if (part_s > searched_s) {
      Result<std::unique_ptr<Levels>> made = Levels::Of(plan, records, registry, 0.0, kComparedRows, &levels, part_s);
      if (!made.ok() || (*made)->size() != levels.size()) return simulations;
      longer = *std::move(made);
    }
    const Levels& part = longer ? *longer : levels;
    const VectorXd &before = contestant.levels[level].q, &from = found ? found->q : before;
    const Estimate fit = estimation::Fit(model, part[level], from, {.converged = policy::kNamedTo, .near = true});
    const bool kept = fit.ok() && (exact ? IsExact(fit) : free_run(fit.q, part) <= free_run(before, part));
    if (longer) simulations += static_cast<double>(longer->simulations()) * part_s / searched_s;
    if (!kept) return simulations;
    found = {fit.q, HalfIntervalOf(fit, part.data(), model)};
  }
  contestant.to_all = std::move(found);
  return simulations;
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
