#include "diagnosis/answer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/policy.h"
#include "diagnosis/weights.h"
#include "linear/dense.h"

namespace dynoproof::diagnosis {
namespace {

/// The share of what the null leaves that one of its numbers would remove without its prior, beside the others: linear.
double RemovedBy(const Contestant& null, std::size_t level, Eigen::Index i) {
  const estimation::Estimate& fit = null.levels[level];
  Eigen::MatrixXd others = fit.jacobian;
  Eigen::VectorXd along = others.col(i);
  others.col(i).setZero();
  along -= others * dense::LeastSquares(estimation::HessianOf(others, null.hypothesis), others.transpose() * along);
  const double power = along.squaredNorm() * fit.weighted.squaredNorm();
  return power > 0.0 ? std::pow(along.dot(fit.weighted), 2) / power : 0.0;
}

}  // namespace

std::size_t EffectsIn(const Answer& answer) {
  return answer.contest.contestants[answer.settled.causes.front()].hypothesis.effects().size();
}

bool IsExactCause(const Answer& answer) {
  return answer.contest.complete && answer.settled.exact && !answer.settled.causes.empty();
}

bool Adds(const Answer& before, const Answer& next) {
  if (next.settled.causes.empty()) return false;
  if (next.settled.exact) return true;
  if (next.settled.verdict != Conclusion::kMainCause || !(next.settled.explains >= policy::kMainCause)) return false;
  const Contestant& second = next.contest.contestants[next.settled.causes.front()];
  const auto stood = [&](std::size_t i) {
    return before.contest.contestants[i].hypothesis.effects().back() == second.hypothesis.effects().back();
  };
  return before.settled.causes.size() == 1 || std::ranges::any_of(before.settled.causes, stood);
}

std::vector<std::string> NominalValuesAlike(const identification::EstimationProblem& problem, const Answer& answer,
                                            const Levels& levels, Journal& journal) {
  std::vector<std::string> alike;
  const auto& [contest, settled] = answer;
  const Contestant& null = contest.null();
  const std::size_t level = settled.level;
  if (!settled.exact || settled.causes.empty() || contest.released || !null.Holds(level)) return alike;
  const Contestant& cause = contest.contestants[settled.causes.front()];
  for (const identification::Nuisance& nuisance : problem.nuisances()) {
    const auto& parameters = null.hypothesis.parameters();
    const auto own = std::ranges::find(parameters, nuisance.path, &estimation::Parameter::name);
    if (nuisance.start || nuisance.effect != nullptr || own == parameters.end()) continue;
    const Eigen::Index i = own - parameters.begin();
    if (RemovedBy(null, level, i) < policy::kMost) continue;
    Contestant one(null.hypothesis.WithReleased(nuisance.path));
    one.levels.resize(level + 1);
    one.levels[level] = AsLoudAs(
        null, level,
        estimation::Fit(one.hypothesis, levels[level], StartFrom(one.hypothesis, null.hypothesis, null.levels[level].q),
                        {.renewals = 6, .of_excess = policy::kCarriedTo}));
    const Contestant both[] = {cause, one};
    const bool stands = one.Holds(level) && IsExact(one.levels[level]) &&
                        !Weights(both, levels, level, RowsCount::kByBlock).Beats(0, 1);
    if (stands) alike.push_back("nominal_value@" + nuisance.path);
    journal.push_back({"ambiguity",
                       {"nominal_value@" + nuisance.path, cause.Name()},
                       "a nominal value alone, without its prior, leaves nothing but noise and is not beaten",
                       {{"value", one.Holds(level) ? one.hypothesis.parameters()[static_cast<std::size_t>(i)].ValueAt(
                                                         one.levels[level].q[i])
                                                   : std::numeric_limits<double>::quiet_NaN()}},
                       stands ? "cannot be told apart" : "told apart"});
  }
  return alike;
}

}  // namespace dynoproof::diagnosis
