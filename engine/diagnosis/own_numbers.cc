#include "diagnosis/own_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/changed_numbers.h"
#include "diagnosis/further_causes.h"
#include "diagnosis/policy.h"
#include "identification/start.h"

namespace dynoproof::diagnosis {

Contestant ReleasedNull(const Inquiry& inquiry) {
  const Levels& levels = inquiry.levels();
  Contestant null = inquiry.Null(true);
  if (!null.Holds(0) || IsNearTheNoise(null.levels[0])) return null;
  const Result<Plan> started = identification::FindStarts(inquiry.problem(), null.hypothesis.At(null.levels[0].q));
  if (!started.ok()) return null;
  Eigen::VectorXd from = null.levels[0].q;
  for (std::size_t i = 0; i < null.hypothesis.parameters().size(); ++i) {
    const estimation::Parameter& own = null.hypothesis.parameters()[i];
    if (own.name.starts_with("of_record."))
      from[static_cast<Eigen::Index>(i)] = own.CoordinateOf(started->root.NumberOr(own.name, own.reference));
  }
  if (from == null.levels[0].q) return null;
  Contestant again(null.hypothesis);
  FitAlong(again, levels, from);
  const bool far_less = again.Holds(0) && LogLeft(again.levels[0], levels) <
                                              LogLeft(null.levels[0], levels) - std::log(policy::kMarginBest);
  return far_less ? again : null;
}

std::optional<Answer> SeveralNumbers(Inquiry& inquiry, const Contest& under_priors, const Contestant& released) {
  if (!under_priors.complete) return {};
  const Levels& levels = inquiry.levels();
  const Contestant& null = under_priors.null();
  const std::int64_t counted = levels.simulations();
  std::optional<Contestant> exact = ByNumbersAlone(null, released, levels);
  if (!exact) return {};
  const auto far = FarFromPriors(*exact, null, levels);
  if (far.empty()) return {};
  Contest contest =
      CompeteByChanges(under_priors, *exact, levels, inquiry.magnitudes(), inquiry.registry(), kMostCauses);
  contest.cost = {{"changes of numbers", levels.simulations() - counted}};
  Settled settled;
  if (contest.contestants.size() > 1) settled = inquiry.SettledAlone(contest);
  // Changes of which the records show ratios alone make up for each other: one set of them is as good as another.
  const bool make_up = std::ranges::any_of(
      settled.causes, [&](std::size_t i) { return !IdleEffects(contest.contestants[i], settled.level).empty(); });
  if (contest.contestants.size() == 1 || make_up) {
    settled = Settled();
    settled.rule = "the model's own numbers, let go together";
    settled.level = levels.free_run();
    settled.exact = true;
    TellNumbers(far, settled);
    contest.released = true;
    contest.contestants = {*std::move(exact)};
  }
  inquiry.journal().push_back({"numbers",
                               {"nominal model"},
                               "let go together they leave nothing but noise",
                               far,
                               make_up                  ? "changes of several of them make up for each other"
                               : settled.causes.empty() ? "no three of them suffice"
                                                        : contest.contestants[settled.causes.front()].Name()});
  inquiry.Enter(contest, settled, "numbers let go together");
  Answer answer{std::move(contest), std::move(settled)};
  if (std::optional<Answer> other = FromItsHalves(inquiry, answer, under_priors)) return other;
  return answer;
}

void TellNumbers(const std::vector<std::pair<std::string, double>>& far, Settled& settled) {
  std::vector<std::string> names;
  for (const auto& [path, off] : far) names.push_back(path);
  settled.verdict = Conclusion::kUnexplained;
  settled.reason =
      fmt::format("nominal values alone, far from their priors, leave nothing but noise: {}", fmt::join(names, ", "));
}

}  // namespace dynoproof::diagnosis
