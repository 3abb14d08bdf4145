#include "diagnosis/further_causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "diagnosis/policy.h"
#include "diagnosis/second_look.h"
#include "diagnosis/weights.h"

namespace dynoproof::diagnosis {
namespace {

/// A contest on top of a model may have found its minimum only now, from the values of one with an effect more, which adds nothing then.
bool FoundLater(const Levels& levels, const Contest& later, std::size_t model, Answer& answer) {
  const std::size_t level = levels.free_run();
  if (!later.null().Holds(level) || !IsExact(later.null().levels[level])) return false;
  answer.contest.contestants[model].levels = later.null().levels;
  return true;
}

/// Whether one effect fewer leaves nothing but noise, too: one that comes to nothing once all are fitted to the minimum itself has
/// only led the others there. The model without it then stands in the contest before, in which it may have been left behind.
bool DoesWithout(const Inquiry& inquiry, Answer& answer, Answer& before) {
  if (!answer.settled.exact || answer.settled.causes.empty()) return false;
  const Levels& levels = inquiry.levels();
  const std::size_t level = answer.settled.level;
  Contestant& all = answer.contest.contestants[answer.settled.causes.front()];
  inquiry.PolishAt(level, all, answer.contest.null());
  const Contestant& null = before.contest.null();
  for (const Idle& idle : IdleEffects(all, level)) {
    estimation::Hypothesis others = inquiry.NullModel(answer.contest.released);
    for (std::size_t i = 0; i < all.hypothesis.effects().size(); ++i) {
      const auto& [effect, place] = all.hypothesis.effects()[i];
      if (i != idle.effect) others = others.With(*effect, place, inquiry.magnitudes());
    }
    Contestant without(std::move(others));
    without.levels.resize(levels.size());
    for (estimation::Estimate& fit : without.levels) fit.broken = "not fitted";
    without.levels[level] = all.levels[level];
    without.levels[level].q = StartFrom(without.hypothesis, all.hypothesis, idle.q);
    if (!inquiry.PolishAt(level, without, null)) continue;
    const Contestant both[] = {all, without};
    if (Weights(both, levels, level, RowsCount::kByBlock).Beats(0, 1)) continue;
    auto& contestants = before.contest.contestants;
    const auto same = std::ranges::find(contestants, without.Name(), &Contestant::Name);
    if (same != contestants.end())
      *same = std::move(without);
    else
      contestants.push_back(std::move(without));
    return true;
  }
  return false;
}

/// The same answer as one that names nothing: the budget ended before its halves were asked.
Answer Unasked(Inquiry& inquiry, Answer answer) {
  inquiry.Cut();
  Settled& settled = answer.settled;
  settled.best = settled.causes.front();
  settled.causes.clear();
  settled.verdict = Conclusion::kUnexplained;
  settled.reason = fmt::format(
      "{} leaves nothing but noise, but only with nominal values far from their priors, and the search has spent its "
      "budget before it knew of anything nearer",
      answer.contest.contestants[*settled.best].Name());
  return answer;
}

/// The model with one of its effects, as it was fitted alone.
Contestant HalfOf(const Inquiry& inquiry, const Contestant& all, const estimation::Hypothesis::Applied& effect,
                  std::size_t level, const Contest& alone) {
  const auto known = std::ranges::find_if(alone.contestants, [&](const Contestant& one) {
    return std::ranges::equal(one.hypothesis.effects(), std::span(&effect, 1));
  });
  if (known != alone.contestants.end()) return *known;
  Contestant half(inquiry.NullModel(alone.released).With(*effect.effect, effect.place, inquiry.magnitudes()));
  FitAlong(half, inquiry.levels(), StartFrom(half.hypothesis, all.hypothesis, all.levels[level].q));
  return half;
}

}  // namespace

std::optional<Answer> FromItsHalves(Inquiry& inquiry, const Answer& answer, const Contest& alone) {
  const auto& [contest, settled] = answer;
  if (!settled.exact || settled.causes.size() != 1) return {};
  const Contestant& all = contest.contestants[settled.causes.front()];
  double off = OffNominal(all, settled.level);
  if (off < policy::kImplausible) return {};
  if (inquiry.Spent()) return Unasked(inquiry, answer);
  const auto& asked = contest.null().hypothesis.effects();
  std::vector<Contestant> halves;
  for (const estimation::Hypothesis::Applied& effect : all.hypothesis.effects()) {
    if (std::ranges::count(asked, effect) == 0) halves.push_back(HalfOf(inquiry, all, effect, settled.level, alone));
  }
  std::ranges::stable_sort(halves, std::ranges::greater(), &Contestant::share);
  std::optional<Answer> best;
  bool unasked = false;
  for (const Contestant& half : halves) {
    unasked = inquiry.Spent();
    if (off < policy::kImplausible || unasked) break;
    Result<Answer> other = inquiry.AskOnTop(half, alone);
    unasked = other.ok() && !other->contest.complete;
    if (!other.ok() || !other->settled.exact || other->settled.causes.empty()) continue;
    const double instead = OffNominal(other->contest.contestants[other->settled.causes.front()], other->settled.level);
    if (instead + policy::kImplausible <= off) best = *std::move(other), off = instead;
  }
  if (off >= policy::kImplausible && unasked) return Unasked(inquiry, best ? *std::move(best) : answer);
  return best;
}

Answer WithFurtherCauses(Inquiry& inquiry, Answer answer) {
  const Levels& levels = inquiry.levels();
  std::optional<Answer> before;
  for (int causes = 1; causes < kMostCauses && !answer.settled.exact && answer.contest.complete; ++causes) {
    const Contest& contest = answer.contest;
    std::vector<Base> bases;
    if (!inquiry.Spent() && contest.null().hypothesis.effects().empty()) {
      const Conduct conduct = inquiry.ConductOf("pairs, " + contest.pass());
      const std::int64_t counted = levels.simulations();
      bases = BasesOfPairs(contest, levels, inquiry.magnitudes(), inquiry.registry(), conduct);
      inquiry.journal().push_back({"simulations",
                                   {},
                                   conduct.stage,
                                   {{"second look", static_cast<double>(levels.simulations() - counted)}},
                                   ""});
    }
    const std::optional<std::size_t> base = BaseOf(contest, answer.settled, bases, levels, inquiry.journal());
    if (!base || inquiry.Spent()) break;
    const Contestant& null = contest.contestants[*base];
    Result<Answer> next = inquiry.AskOnTop(null, contest);
    if (!next.ok()) break;
    if (!Adds(answer, *next)) {
      if (FoundLater(levels, next->contest, *base, answer)) inquiry.SettleAgain(answer);
      break;
    }
    before = std::exchange(answer, *std::move(next));
  }
  if (!before) return answer;
  if (DoesWithout(inquiry, answer, *before)) {
    inquiry.SettleAgain(*before);
    return *std::move(before);
  }
  if (EffectsIn(answer) == 2) {
    if (std::optional<Answer> other = FromItsHalves(inquiry, answer, before->contest)) return *std::move(other);
  }
  return answer;
}

}  // namespace dynoproof::diagnosis
