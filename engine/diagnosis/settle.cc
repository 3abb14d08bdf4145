#include "diagnosis/settle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/policy.h"
#include "diagnosis/weights.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::Estimate;
using estimation::Weight;

/// The share of the null's excess that a contestant removes at a level.
double ShareAt(const Contest& contest, const Levels& levels, std::size_t i, std::size_t level) {
  return ShareOf(contest.contestants[i], contest.null(), levels, level);
}

/// Removes a law that refines another standing law at the same place without beating it. `beats(a, b)`: a is better than b.
template <class Beats>
void KeepPlainer(const Contest& contest, std::vector<std::size_t>& standing, const Beats& beats) {
  const auto& all = contest.contestants;
  std::erase_if(standing, [&](std::size_t refined) {
    return std::ranges::any_of(standing, [&](std::size_t plain) {
      return plain != refined && Refines(all[refined], all[plain]) && !beats(refined, plain);
    });
  });
}

/// The power that a model leaves more than another one, of the noise's, in the channel where that is most.
double LeavesMore(const Estimate& fit, const Estimate& other) {
  double most = 0.0;
  for (std::size_t c = 0; c < fit.scales.size(); ++c) {
    const double more = std::pow(fit.scales[c].rms, 2) - std::pow(other.scales[c].rms, 2);
    most = std::max(most, more / std::pow(fit.scales[c].noise_alone, 2));
  }
  return most;
}

/// The log excess of the plan as given or of the null, whichever is better, over that of the former.
double OfNull(const std::vector<HeldOut>& held_out, std::size_t level) {
  return std::min(0.0, held_out[0][level].value_or(LeftThere{}).log_excess);
}

/// The share that a model removes of what the plan as given and the null, whichever is better, leave on data that took no part;
/// nothing: its run breaks.
std::optional<double> HeldOutShare(const std::vector<HeldOut>& held_out, std::size_t i, std::size_t level) {
  if (!held_out[i][level]) return std::nullopt;
  return 1.0 - std::exp(held_out[i][level]->log_excess - OfNull(held_out, level));
}

/// Whether a model leaves far more than another one on data that took no part, and more than noise.
bool LeavesFarMore(const std::vector<HeldOut>& held_out, std::size_t i, std::size_t k, std::size_t level) {
  const std::optional<LeftThere>&own = held_out[i][level], &other = held_out[k][level];
  return own && other && !own->exact && own->log_excess > other->log_excess + std::log(policy::kMarginBest);
}

/// Whether data that took no part bear a cause out that leaves nothing but noise on the others: they too show noise alone, or nearly nothing
/// of what the null leaves. Where the null predicts them about as well as the cause, and both to the noise or far better than the plan as
/// given, they do not tell the two apart: then the training data have to do so plainly. A share of what the null leaves says nothing
/// there: that is what no model here explains.
bool HoldsElsewhere(const std::vector<HeldOut>& held_out, std::size_t i, std::size_t level, double training_share) {
  const std::optional<double> share = HeldOutShare(held_out, i, level);
  if (!share) return false;
  const std::optional<LeftThere>& own = held_out[i][level];
  const bool no_question = own->exact || 1.0 - std::exp(own->log_excess) >= policy::kBothPredict;
  const bool alike = no_question && !LeavesFarMore(held_out, i, 0, level);
  return *share >= (own->exact ? policy::kHeldOutPrior : policy::kBornOut) ||
         (alike && training_share >= policy::kMost);
}

/// Whether the nominal values of a model are so much nearer to their priors than those of another one that is exact, too.
bool IsMorePlausible(const Contestant& one, const Contestant& other, std::size_t level) {
  return other.Holds(level) && IsExact(other.levels[level]) &&
         OffNominal(other, level) - OffNominal(one, level) >= policy::kImplausible;
}

std::string Listed(const Contest& contest, const std::vector<std::size_t>& which) {
  std::string text;
  for (const std::size_t i : which) text += (text.empty() ? "" : ", ") + contest.contestants[i].Name();
  return text;
}

/// Enters the weight of the null model beside a contestant and its standard error, where both have an estimate. `at`: added to
/// the names.
void EnterWeight(const Weights& weights, std::size_t i, const std::string& at,
                 std::vector<std::pair<std::string, double>>& numbers) {
  if (const std::optional<Weight>& weight = weights.Of(i, 0)) {
    numbers.emplace_back("weight_of_null" + at, weight->lambda);
    numbers.emplace_back("standard_error" + at, weight->standard_error);
  }
}

template <class Beats>
JournalEntry EntryOf(const Contest& contest, const Levels& levels, const Weights& weights, const Beats& beats,
                     std::size_t level, std::size_t i) {
  JournalEntry entry{"comparison",
                     {contest.contestants[i].Name(), "nominal model"},
                     levels.Name(level) + (contest.released ? ", nominal values released" : ", under priors"),
                     {{"share", ShareAt(contest, levels, i, level)}},
                     ""};
  const Estimate& fit = contest.contestants[i].levels[level];
  entry.numbers.emplace_back("rms_over_noise", TimesNoise(fit));
  entry.numbers.emplace_back("excess", std::exp(0.5 * LogLeft(fit, levels)));
  entry.numbers.emplace_back("nominal_values_off", OffNominal(contest.contestants[i], level));
  entry.numbers.emplace_back("renewals", fit.renewals);
  entry.numbers.emplace_back("simulations", static_cast<double>(fit.simulations));
  EnterWeight(weights, i, "", entry.numbers);
  std::string rivals;
  for (std::size_t k = 1; k < contest.contestants.size(); ++k) {
    if (k != i && beats(k, i)) rivals += (rivals.empty() ? "" : ", ") + contest.contestants[k].Name();
  }
  entry.outcome = !beats(i, 0) ? "does not beat the nominal model" : rivals.empty() ? "stands" : "beaten by " + rivals;
  return entry;
}

/// Weights, priors and the share of the null's excess decide at a level where a model leaves nothing but noise.
Settled SettleByWeights(const Contest& contest, const Levels& levels, const std::vector<HeldOut>& held_out,
                        std::size_t level) {
  Settled settled;
  const auto& all = contest.contestants;
  settled.exact = true;
  settled.level = level;
  const Weights weights(contest.contestants, levels, level, RowsCount::kByBlock);
  // The residual of an exact model holds systematic errors too, as of an input between its samples, and the further numbers of a refined
  // law follow some of them. It has to lower the residual's power by more than the uncertainty of the noise's power.
  const auto beats = [&](std::size_t a, std::size_t b) {
    if (!weights.Beats(a, b)) return false;
    return !(a > 0 && b > 0 && Refines(all[a], all[b])) ||
           LeavesMore(all[b].levels[level], all[a].levels[level]) > policy::kNoiseKnown;
  };
  std::vector<std::size_t> standing, only_here;  // the latter: on these data, not on those that took no part
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (!all[i].Holds(level)) continue;
    const std::optional<double> elsewhere = HeldOutShare(held_out, i, level);
    settled.journal.push_back(EntryOf(contest, levels, weights, beats, level, i));
    if (elsewhere) settled.journal.back().numbers.emplace_back("held_out_share", *elsewhere);
    // Where the null leaves nothing but noise itself, its nominal values may tell that it is not the truth.
    const bool relieves = IsMorePlausible(all[i], all[0], level) && !beats(0, i);
    const double share = relieves ? 1.0 : ShareAt(contest, levels, i, level);
    bool stands = (relieves || beats(i, 0)) && share >= policy::kShare && IsExact(all[i].levels[level]) &&
                  NamesSomething(all[i], level);
    for (std::size_t k = 1; k < all.size(); ++k) stands = stands && !(k != i && beats(k, i));
    if (stands) (HoldsElsewhere(held_out, i, level, share) ? standing : only_here).push_back(i);
  }
  const auto by_share = [&](std::size_t a, std::size_t b) {
    return ShareAt(contest, levels, a, level) > ShareAt(contest, levels, b, level);
  };
  // The priors decide between two models that predict alike: one that needs nominal values far from their priors is removed.
  std::vector<std::size_t> implausible;
  for (const std::size_t i : standing) {
    if (std::ranges::any_of(standing,
                            [&](std::size_t k) { return IsMorePlausible(all[k], all[i], level) && !beats(i, k); }))
      implausible.push_back(i);
  }
  std::erase_if(standing, [&](std::size_t i) { return std::ranges::count(implausible, i) > 0; });
  const std::vector<std::size_t> alike_here = standing;
  std::erase_if(standing, [&](std::size_t i) {
    return std::ranges::any_of(alike_here, [&](std::size_t k) { return LeavesFarMore(held_out, i, k, level); });
  });
  KeepPlainer(contest, standing, beats);
  std::ranges::stable_sort(standing, by_share);
  std::ranges::stable_sort(only_here, by_share);
  settled.rule = "a model leaves nothing but noise (" + levels.Name(level) + ", " + contest.pass() + ")";
  settled.causes = standing;
  if (standing.empty()) {
    const bool null = all[0].Holds(level) && IsExact(all[0].levels[level]) && level == levels.free_run();
    settled.verdict = null && only_here.empty() ? Conclusion::kNoEffect : Conclusion::kUnexplained;
    if (!only_here.empty()) {
      settled.best = only_here.front();
      const double share = HeldOutShare(held_out, *settled.best, level).value_or(0.0);
      settled.reason =
          share >= policy::kHeldOutPrior
              ? fmt::format(
                    "{} leaves nothing but noise, but on the hold-out more than that: {:.0f} % are explained there",
                    all[*settled.best].Name(), 100.0 * share)
              : fmt::format(
                    "{} leaves nothing but noise, but does not gain on the hold-out: there the model without it, its "
                    "nominal values fitted, is as good",
                    all[*settled.best].Name());
    } else {
      settled.reason = null ? "the nominal model leaves nothing but noise, and no effect removes a share of it"
                            : "what leaves nothing but noise has its number on a bound, or is beaten by another model";
    }
  } else if (standing.size() == 1) {
    settled.verdict = Conclusion::kEffectFound;
    settled.explains = HeldOutShare(held_out, standing.front(), level).value_or(0.0);
    settled.reason =
        fmt::format("{} leaves nothing but noise, and no other model adds to it", Listed(contest, standing));
  } else if (standing.size() <= policy::kMostAlike) {
    settled.verdict = Conclusion::kAmbiguous;
    settled.reason = fmt::format("these records do not separate {}", Listed(contest, standing));
  } else {
    settled.reason = fmt::format("{} models leave nothing but noise and are not separated: {}", standing.size(),
                                 Listed(contest, standing));
  }
  return settled;
}

/// Where no model does: shares on data that took no part.
class Shares {
 public:
  Shares(const Contest& contest, const Levels& levels, const std::vector<HeldOut>& held_out,
         const std::vector<double>& least)
      : all_(contest.contestants), levels_(levels), held_out_(held_out), least_(least), contest_(contest) {
    weights_.resize(levels.size());
    for (std::size_t level = contest.first; level < levels.size(); ++level) {
      if (levels.IsSteppingStone(level)) continue;
      asked_.push_back(level);
      weights_[level].emplace(contest.contestants, levels, level, RowsCount::kByChannel);
    }
  }

  Settled Settle() const {
    Settled settled;
    settled.level = Shorter();
    settled.rule = "no model leaves nothing but noise; shares on data that took no part (" + contest_.pass() + ")";
    std::vector<std::size_t> admitted;
    for (std::size_t i = 1; i < all_.size(); ++i) {
      JournalEntry entry = Judged(i);
      if (entry.outcome == kAdmitted) admitted.push_back(i);
      settled.journal.push_back(std::move(entry));
      if (const double share = LeastExplained(i); share > settled.best_explains)
        settled.best_explains = share, settled.best = i;
    }
    settled.causes = Standing(std::move(admitted));
    for (const std::size_t i : settled.causes) settled.explains = std::max(settled.explains, LeastExplained(i));
    AddVerdict(settled);
    return settled;
  }

 private:
  static constexpr const char* kAdmitted = "admitted";

  /// Three error models: one beats another where it does so at one level at least, and is beaten at none. It has to leave clearly less
  /// there, too: weights are sure of a thousandth where all models leave the same systematic error.
  bool Beats(std::size_t a, std::size_t b) const {
    bool wins = false;
    for (const std::size_t level : asked_) {
      wins = wins || (weights_[level]->Beats(a, b) && LeavesLess(a, b, level));
      if (weights_[level]->Beats(b, a)) return false;
    }
    return wins;
  }
  bool LeavesLess(std::size_t a, std::size_t b, std::size_t level) const {
    const double less = LogLeft(all_[b].levels[level], levels_) - LogLeft(all_[a].levels[level], levels_);
    return less > std::log1p(policy::kNoiseKnown);
  }
  /// The logarithm of the excess that a model leaves on data that took no part.
  double Held(std::size_t i, std::size_t level) const {
    return held_out_[i][level] ? held_out_[i][level]->log_excess : std::numeric_limits<double>::infinity();
  }
  /// E of a candidate beside the better of the plan as given and the null.
  double Explained(std::size_t i, std::size_t level) const {
    return 1.0 - std::exp(Held(i, level) - OfNull(held_out_, level));
  }
  bool Near(std::size_t i, std::size_t level) const {
    return Held(i, level) <= least_[level] + std::log(policy::kMarginBest);
  }
  /// Two error models are asked: a short memory, and as long a one as there is. The free run is that, but where an output
  /// accumulates whatever no model knows, as the position of an axis does: there the longest memory within the record.
  std::size_t Shorter() const { return levels_.corrected(); }
  std::size_t Longer(std::size_t i) const {
    const std::size_t free = levels_.free_run(), longest = levels_.longest();
    return Near(i, free) && Explained(i, free) >= Explained(i, longest) ? free : longest;
  }
  double LeastExplained(std::size_t i) const { return std::min(Explained(i, Shorter()), Explained(i, Longer(i))); }

  /// Whether a candidate is admitted, and what it falls by else.
  JournalEntry Judged(std::size_t i) const {
    const double wanted = contest_.released ? policy::kHeldOutReleased : policy::kHeldOutPrior;
    double most = -1e300, worst = 1e300;
    for (const std::size_t level : asked_) {
      if (!all_[i].Holds(level) || !all_[0].Holds(level)) continue;
      most = std::max(most, ShareAt(contest_, levels_, i, level));
      worst = std::min(worst, ShareAt(contest_, levels_, i, level));
    }
    const bool harms = worst <= policy::kHarm || std::ranges::any_of(asked_, [&](std::size_t level) {
                         return level != levels_.free_run() && Explained(i, level) <= policy::kHarm;
                       });
    std::vector<std::pair<std::string, double>> numbers = {{"most_share", most}, {"least_share", worst}};
    for (const std::size_t level : asked_) {
      numbers.emplace_back("held out, " + levels_.Name(level), Explained(i, level));
      EnterWeight(*weights_[level], i, ", " + levels_.Name(level), numbers);
    }
    const char* outcome = !Beats(i, 0)                                 ? "does not beat the nominal model"
                          : harms                                      ? "makes it worse at a level"
                          : !Near(i, Shorter()) || !Near(i, Longer(i)) ? "far from the best on data that took no part"
                          : !NamesSomething(all_[i], Shorter())        ? "a number is on its bound"
                          : !(most > policy::kShare) || !(LeastExplained(i) >= wanted) ? "too small a share"
                                                                                       : kAdmitted;
    return {"comparison",
            {all_[i].Name(), "nominal model"},
            "no model is exact, " + contest_.pass(),
            std::move(numbers),
            outcome};
  }

  /// Laws of one place that act alike.
  std::string FamilyOf(std::size_t i) const {
    const std::string& own = all_[i].effect().info().traits.family;
    return (own.empty() ? all_[i].effect().info().name : own) + "@" + all_[i].place().ToString();
  }

  bool RefineOneLaw(std::size_t i, std::size_t k) const {
    const auto refined = [&](std::size_t of) -> const auto& { return all_[of].effect().info().traits.refines; };
    return all_[i].place() == all_[k].place() && std::ranges::any_of(refined(i), [&](const std::string& law) {
             return std::ranges::count(refined(k), law) > 0;
           });
  }

  /// The admitted ones that no other beats, the best first. Within a family the one with the fewest numbers that is not far from
  /// the best stands for it: the others beat it by what no model here explains. Of laws that refine the same one, one with more numbers
  /// that predicts no better does not stand beside another.
  std::vector<std::size_t> Standing(std::vector<std::size_t> admitted) const {
    const auto numbers = [&](std::size_t i) { return all_[i].effect().info().parameters.size(); };
    std::vector<std::size_t> represented = admitted;
    std::erase_if(represented, [&](std::size_t i) {
      return std::ranges::any_of(admitted, [&](std::size_t k) {
        return FamilyOf(k) == FamilyOf(i) && numbers(k) < numbers(i) &&
               Held(k, Shorter()) <= Held(i, Shorter()) + std::log(policy::kMarginFamily);
      });
    });
    std::vector<std::size_t> plain;
    for (const std::size_t i : represented) {
      if (std::ranges::none_of(represented, [&](std::size_t k) { return k != i && Beats(k, i); })) plain.push_back(i);
    }
    KeepPlainer(contest_, plain, [&](std::size_t a, std::size_t b) { return Beats(a, b); });
    const std::vector<std::size_t> unbeaten = plain;
    std::erase_if(plain, [&](std::size_t i) {
      return std::ranges::any_of(unbeaten, [&](std::size_t k) {
        return RefineOneLaw(i, k) && numbers(k) < numbers(i) && Held(k, Shorter()) <= Held(i, Shorter());
      });
    });
    std::ranges::stable_sort(plain,
                             [&](std::size_t a, std::size_t b) { return Held(a, Shorter()) < Held(b, Shorter()); });
    return plain;
  }

  void AddVerdict(Settled& settled) const {
    const std::vector<std::size_t>& causes = settled.causes;
    if (causes.size() == 1) {
      settled.verdict = Conclusion::kMainCause;
      settled.reason = fmt::format(
          "{} explains {:.0f} % of what the model gets wrong on data that took no part; the rest is "
          "more than noise",
          all_[causes[0]].Name(), 100.0 * Explained(causes[0], Shorter()));
    } else if (!causes.empty() && causes.size() <= policy::kMostAlike) {
      settled.verdict = Conclusion::kAmbiguous;
      settled.reason = fmt::format("these records do not separate {}", Listed(contest_, causes));
    } else if (!causes.empty()) {
      settled.reason = fmt::format("{} effects explain alike: {}", causes.size(), Listed(contest_, causes));
    } else {
      settled.reason =
          settled.best ? fmt::format("no effect explains enough; most removes {}, {:.0f} % on data that took no part",
                                     all_[*settled.best].Name(), 100.0 * settled.best_explains)
                       : "no effect makes the prediction better on data that took no part";
    }
  }

  const std::vector<Contestant>& all_;
  const Levels& levels_;
  const std::vector<HeldOut>& held_out_;
  const std::vector<double>& least_;
  const Contest& contest_;
  std::vector<std::size_t> asked_;  // levels
  std::vector<std::optional<Weights>> weights_;
};

}  // namespace

std::optional<std::size_t> ExactLevel(const Contest& contest, const Levels& levels) {
  // The shortest memory hides what accumulates: it is no level to find nothing at.
  const std::size_t shortest = levels.size() > 1 ? 1 : 0;
  for (std::size_t level = levels.size(); level-- > shortest;) {
    if (levels.IsSteppingStone(level)) continue;
    for (const Contestant& one : contest.contestants) {
      if (!one.Holds(level) || !IsExact(one.levels[level])) continue;
      if (level == levels.free_run() || IsQuiet(one.levels[level], levels.data())) return level;
    }
  }
  return std::nullopt;
}

Settled Settle(const Contest& contest, const Levels& levels, const std::vector<HeldOut>& held_out,
               const std::vector<double>& least) {
  const std::optional<std::size_t> level = ExactLevel(contest, levels);
  return level ? SettleByWeights(contest, levels, held_out, *level) : Shares(contest, levels, held_out, least).Settle();
}

Settled AtTheEnd(Settled settled, const Contest& contest) {
  if (settled.causes.empty()) return settled;
  const std::size_t first = settled.causes.front();
  const std::string name = contest.contestants[first].Name();
  const auto pushed = [&](std::size_t i) {
    return !NominalValuesOnBounds(contest.contestants[i], settled.level).empty();
  };
  if (settled.exact && settled.causes.size() == 1 && pushed(first) && settled.explains >= policy::kNearlyAll) {
    settled.reason += ", though with a nominal value on its bound";
  } else if (settled.exact && std::ranges::all_of(settled.causes, pushed)) {
    settled.causes.clear();
    settled.best = first;
    settled.verdict = Conclusion::kUnexplained;
    settled.reason = name + " leaves nothing but noise, but only with a nominal value on its bound";
  } else if (!settled.exact && settled.explains < policy::kMainCause) {
    settled.verdict = Conclusion::kUnexplained;
    settled.reason =
        fmt::format("{} is the best, and explains {:.0f} % of what the model gets wrong on data that took no part",
                    name, 100.0 * settled.explains);
  }
  return settled;
}

}  // namespace dynoproof::diagnosis
