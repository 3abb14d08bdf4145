#include "diagnosis/selection.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace dynoproof::diagnosis {
namespace {

constexpr std::size_t kPolished = 5;  // hypotheses that are fitted with the noise's colour
constexpr std::size_t kWarmed = 3;    // and those that start anew from the shortest part
constexpr double kContender = 0.25;   // of the nominal model's excess of chi2: half of the way in RMS is still to go
constexpr int kLaps = 5;              // of the race to the end
constexpr double kProgress = 0.1;     // of the gap to the best: less in a lap, and a rival is out
constexpr double kStrained = 2.5;     // spreads: of a dozen nominal values one lies that far off by chance in six cases
constexpr std::size_t kRegrown = 4;   // causes that begin anew on parts that grow
constexpr double kNear = 100.0;       // of chi2 behind the leader: ten times what makes two hypotheses alike
constexpr double kCloses = 0.5;       // of its gap to the leader a challenger has to leave by two steps at most
constexpr double kBeaten = 2.0;  // times the best one's chi2 beside the same nuisance parameters: no rival any more

}  // namespace

void BestFirst(std::vector<Estimate>& fits) {
  std::stable_sort(fits.begin(), fits.end(),
                   [](const Estimate& a, const Estimate& b) { return a.criterion < b.criterion; });
}

void Sort(const Estimator& estimator, std::vector<Estimate>& fits) {
  for (Estimate& fit : fits) estimator.Score(fit);
  BestFirst(fits);
}

void KeepBetter(Estimate& fit, Estimate other) {
  if (other.ok() && other.chi2 < fit.chi2) fit = std::move(other);
}

void TakeUp(std::vector<Estimate>& fits, Estimate fit) {
  const auto known =
      std::find_if(fits.begin(), fits.end(), [&](const Estimate& other) { return other.Name() == fit.Name(); });
  if (known != fits.end())
    KeepBetter(*known, std::move(fit));
  else
    fits.push_back(std::move(fit));
}

Selection::Selection(const EstimationProblem& problem, SavedFits& saved, Progress progress)
    : problem_(problem), saved_(saved), step_(std::move(progress)) {
  if (PredictionWindow(problem.plan())) return;  // no mode is ever far out of phase
  for (const double share : {1.0 / 27.0, 1.0 / 9.0, 1.0 / 3.0}) rungs_.push_back(problem.Part(share));
}

const NuisanceModel& Selection::AtNominal() const {
  if (at_nominal_) return *at_nominal_;
  Result<NuisanceModel> model = LineariseNuisances(problem_, problem_.Nominal(), FreedomOf(problem_, {}));
  return at_nominal_.emplace(model.ok() ? *std::move(model) : NuisanceModel{});
}

/// A nuisance parameter far outside its prior is promoted to the effect that changes the same number;
/// nothing within it.
std::optional<EffectInstance> Selection::AsEffect(const Nuisance& nuisance, double z) const {
  constexpr double kWorthATry = 3.0;  // spreads
  if (nuisance.effect == nullptr || !nuisance.relative || std::abs(z) < kWorthATry) return std::nullopt;
  const EffectParameter& delta = nuisance.effect->info().parameters.front();
  return EffectInstance{nuisance.effect, nuisance.at, {std::clamp(ChangeOf(nuisance, z), delta.lower, delta.upper)}};
}

/// Such effects are candidates, found by all the nuisance parameters moving together, which no single start can.
bool Selection::Suggest(const Estimator& estimator, const Estimate& null, std::vector<Estimate>& fits) {
  bool taken = false;
  for (std::size_t i = 0; i < problem_.nuisances().size(); ++i) {
    const std::optional<EffectInstance> effect = AsEffect(problem_.nuisances()[i], null.hypothesis.z[i]);
    if (!effect) continue;
    Hypothesis at = null.hypothesis;
    at.effects.push_back(*effect);
    at.z[i] = 0.0;
    step_("fitting " + at.effects.back().ToString(), 0.5);
    Estimate fit = EstimateAt(problem_, std::move(at));
    if (!fit.ok()) continue;
    estimator.Score(fit);
    std::erase_if(fits, [&](const Estimate& other) { return other.Name() == fit.Name() && other.chi2 > fit.chi2; });
    if (std::any_of(fits.begin(), fits.end(), [&](const Estimate& other) { return other.Name() == fit.Name(); }))
      continue;
    fits.push_back(std::move(fit));
    taken = true;
  }
  BestFirst(fits);
  return taken;
}

/// Everything is fitted again, effects and nuisance parameters together, until the order no longer changes.
void Selection::Decide(const std::vector<EffectInstance>& entrants, std::vector<Estimate>& fits, Estimate& null) {
  if (fits.empty()) return;
  Race(fits, null);
  if (fits.empty()) return;
  if (!rungs_.empty() && fits.front().hypothesis.effects.size() == 1 && !AtFloor(fits.front()) &&
      !ChangesStructure(fits.front().hypothesis.effects.front()))
    Regrow(entrants, fits);
  ConditionalRefits(entrants, fits);
  {
    // With the noise's colour taken from the best fit differences count by their weight against the noise.
    const Estimator estimator(problem_, WhitenerOf(problem_, fits.front()));
    Sort(estimator, fits);
    Each(fits, "fitting with the noise's colour: ", 0.68, [&](std::size_t k) {
      if (k >= kPolished || (k > 0 && fits[k].chi2 > kBeaten * fits.front().chi2)) return false;
      fits[k] = estimator.Refine(std::move(fits[k]), 4);
      return true;
    });
    if (fits.empty()) return;
  }
  const Estimator estimator(problem_, WhitenerOf(problem_, fits.front()));
  // The nominal model gets every chance: also from where the nuisance parameters stand beside the best effect.
  Estimate other = null;
  other.hypothesis.z = Beside(fits.front()).z;
  null = estimator.Refine(std::move(null), 3);
  KeepBetter(null, estimator.Refine(std::move(other), 4));
  Sort(estimator, fits);
  // A best fit that has not been refined here (taken up late, weighed without the price of its nuisance
  // parameters) is fitted now: what follows needs its slopes.
  while (!fits.empty() &&
         fits.front().nuisances.jacobian.cols() != static_cast<Eigen::Index>(fits.front().nuisances.free.size())) {
    fits.front() = estimator.Refine(std::move(fits.front()), 4);
    std::erase_if(fits, [](const Estimate& fit) { return !fit.ok(); });
    Sort(estimator, fits);
  }
}

/// Fits again those that `fit_again` takes up, best first, and sorts.
template <class FitAgain>
void Selection::Each(std::vector<Estimate>& fits, const std::string& what, double fraction, const FitAgain& fit_again) {
  for (std::size_t k = 0; k < fits.size() && !problem_.spent(); ++k) {
    if (!fit_again(k)) continue;
    step_(what + fits[k].Name(), fraction + 0.06 * static_cast<double>(k) / static_cast<double>(fits.size()));
  }
  std::erase_if(fits, [](const Estimate& fit) { return !fit.ok(); });
  BestFirst(fits);
}

/// Successive elimination: every candidate that comes anywhere near the best gets another round of iterations, as
/// long as a round closes a good part of its gap to the best. As if the noise were white: the residual gets as small as
/// it can; a colour taken from a fit that is not there yet would count what it lacks as noise, and stay there.
void Selection::Race(std::vector<Estimate>& fits, const Estimate& null) {
  std::set<std::string> out;
  for (int lap = 0; lap < kLaps && out.size() < fits.size() && !problem_.spent(); ++lap) {
    const Estimator estimator(problem_, WhitenerOf(problem_, fits.front(), 0));
    Sort(estimator, fits);
    Estimate nominal = null;
    estimator.Score(nominal);
    const double best = fits.front().chi2, reach = kContender * std::max(0.0, nominal.chi2 - best);
    bool accounted = Accounts(fits.front());
    Each(fits, "fitting to the end: ", 0.5 + 0.02 * lap, [&](std::size_t k) {
      const double gap = fits[k].chi2 - best;
      if (out.contains(fits[k].Name()) || (lap > 0 && k > 0 && gap > reach)) return false;
      const double before = fits[k].chi2;
      if (lap == 0 && k > 0 && accounted) return false;
      fits[k] = FromItsOwn(std::move(fits[k]), estimator);
      if (fits[k].ok()) saved_.Keep(fits[k].hypothesis.effects);
      // The nuisance parameters may have run off before the effect had its size: once more from the nominal values.
      if (lap == 0 && (k == 0 || (!Accounts(fits[k]) && (k < kWarmed || AtFloor(fits[k]) || MovesModes(fits[k]))))) {
        Estimate anew = fits[k];
        anew.hypothesis.z = problem_.Nominal().z;
        KeepBetter(fits[k], FromShortHorizons(anew, estimator));
        if (!Accounts(fits[k])) KeepBetter(fits[k], FromItsOwn(EstimateAt(problem_, anew.hypothesis), estimator));
      }
      // Where the leader is at the noise with strained values only, somebody else may be there without.
      if (lap == 0 && k > 0 && AtFloor(fits.front()) && !Accounts(fits[k]))
        KeepBetter(fits[k], OverGrowingHorizons(fits[k], estimator));
      accounted = accounted || Accounts(fits[k]);
      if (fits[k].settled || before - fits[k].chi2 < kProgress * std::max(gap, 1.0)) out.insert(fits[k].Name());
      return true;
    });
    // Nothing is left to gain. Alternatives from the same nuisance parameters are fitted next.
    if (fits.empty() || Accounts(fits.front())) return;
  }
}

/// Fits on, as if what the fit itself leaves were the noise; weighed by `fitter`, as its rivals are. By the best one's
/// noise, what a fit lacks that is still far off would outweigh all prior knowledge, and drive its nuisance parameters
/// away.
Estimate Selection::FromItsOwn(Estimate fit, const Estimator& estimator) const {
  if (!fit.ok()) return fit;
  const Estimator own(problem_, WhitenerOf(problem_, fit, 0));
  if (fit.nuisances.jacobian.size() == 0) TakeSlopes(problem_, AtNominal(), problem_, fit);
  fit = own.Refine(std::move(fit), 3, {.slopes = Slopes::kKnown});
  if (fit.ok()) estimator.Score(fit);
  return fit;
}

/// Whether an effect of the fit says that a nominal value has changed.
bool Selection::MovesModes(const Estimate& fit) const {
  return std::any_of(problem_.nuisances().begin(), problem_.nuisances().end(),
                     [&](const Nuisance& nuisance) { return AsNuisance(nuisance, fit).has_value(); });
}

/// Whether a fit leaves nothing to gain for others: neither in the residual nor in what it asks of the machine.
bool Selection::Accounts(const Estimate& fit) const {
  return AtFloor(fit) && LargestDeviation(problem_, fit) < kStrained;
}

/// Whether all that a fit leaves is white noise, as large as its highest frequencies say.
bool Selection::AtFloor(const Estimate& fit) const {
  constexpr double kNear = 1.2;
  if (!fit.ok() || fit.predicted.size() == 0) return false;
  const Eigen::VectorXd residual = problem_.measured() - fit.predicted;
  return std::all_of(problem_.channels().begin(), problem_.channels().end(), [&](const Channel& channel) {
    const auto rows = residual.segment(channel.begin, channel.count);
    return RmsOf(rows) < kNear * HighFrequencyFloor(rows);
  });
}

/// Where nobody comes to the noise: the first entrants begin anew, at the sizes at which they entered and on parts that
/// grow. Fitted to all of a line that rings out of step they may have left a size that was right. Not beside a change
/// of structure, which short parts do not tell, and which comes to its place by itself.
void Selection::Regrow(const std::vector<EffectInstance>& entrants, std::vector<Estimate>& fits) {
  const Estimator estimator(problem_, WhitenerOf(problem_, fits.front(), 0));
  Sort(estimator, fits);
  for (std::size_t k = 0; k < std::min(kRegrown, entrants.size()) && !problem_.spent(); ++k) {
    if (ChangesStructure(entrants[k])) continue;
    Estimate fit;
    fit.hypothesis = problem_.Nominal();
    fit.hypothesis.effects = {entrants[k]};
    if (!begun_anew_.insert(fit.Name()).second) continue;
    step_("from a short part: " + fit.Name(), 0.6);
    fit = OverGrowingHorizons(fit, estimator);
    if (!fit.ok() || fit.predicted.size() == 0) continue;
    const bool explains = AtFloor(fit);
    TakeUp(fits, std::move(fit));
    if (explains) break;
  }
  BestFirst(fits);
}

/// Alternative models, refitted from the nuisance parameters of the best one.
void Selection::ConditionalRefits(const std::vector<EffectInstance>& entrants, std::vector<Estimate>& fits) {
  for (int round = 0; round < 2 && !problem_.spent(); ++round) {
    const Estimator estimator(problem_, WhitenerOf(problem_, fits.front()));
    for (Estimate& fit : fits) estimator.Score(fit);
    const Estimate best = fits.front();
    const Hypothesis about = Beside(best);
    const Result<NuisanceModel> nuisances = LineariseNuisances(problem_, about, FreedomOf(problem_, about.effects));
    if (!nuisances.ok()) return;
    for (const EffectInstance& alternative : AlternativesTo(entrants, fits)) {
      if (problem_.spent()) break;
      if (!MayAnswer(alternative, best.hypothesis)) continue;
      std::vector<EffectInstance> effects(best.hypothesis.effects.begin(), best.hypothesis.effects.end() - 1);
      effects.push_back(alternative);
      NuisanceModel beside = *nuisances;
      for (std::size_t i = 0; i < problem_.nuisances().size(); ++i) {
        if (Changes(alternative, problem_.nuisances()[i])) beside.z0[i] = 0.0;  // the challenger says it instead
      }
      Estimate fit = estimator.Optimise(effects, beside, 4);
      if (!fit.ok() || fit.chi2 > kBeaten * best.chi2) continue;
      step_("beside " + best.Name() + ": " + fit.Name(), 0.62);
      Answer(estimator, std::move(fit), fits);
    }
    BestFirst(fits);
    if (fits.front().Name() == best.Name() || best.criterion - fits.front().criterion < 1.0) return;
  }
}

/// Whether an alternative has not been asked yet beside this leader, as it stands now.
bool Selection::MayAnswer(const EffectInstance& alternative, const Hypothesis& leader) {
  constexpr double kMoved = 0.01;  // of a number of the leader: then its nuisance parameters have moved, too
  std::string question = alternative.ToString() + " beside";
  std::vector<double> numbers;
  for (const EffectInstance& instance : leader.effects) {
    question += " " + instance.ToString();
    numbers.insert(numbers.end(), instance.parameters.begin(), instance.parameters.end());
  }
  std::vector<double>& known = asked_[question];
  const bool same = !known.empty() && std::equal(known.begin(), known.end(), numbers.begin(), [](double a, double b) {
    return std::abs(a - b) <= kMoved * std::abs(a);
  });
  known = std::move(numbers);
  return !same;
}

/// Those that were fitted with the best one (the first), and those that are recalled; what says openly that a nominal
/// value is as far off as the best one needs it; other effects at its place, because of laws that contain one another
/// the simplest must win; and the same effect at other places.
std::vector<EffectInstance> Selection::AlternativesTo(const std::vector<EffectInstance>& entrants,
                                                      const std::vector<Estimate>& fits) const {
  const EffectInstance& last = fits.front().hypothesis.effects.back();
  std::vector<EffectInstance> challengers;
  for (std::size_t k = 1; k < fits.size(); ++k) challengers.push_back(fits[k].hypothesis.effects.back());
  for (const EffectInstance& beaten : beaten_) {
    if (!beaten.SameCause(last)) challengers.push_back(beaten);
  }
  for (std::size_t i = 0; i < problem_.nuisances().size(); ++i) {
    const std::optional<EffectInstance> effect = AsEffect(problem_.nuisances()[i], fits.front().hypothesis.z[i]);
    if (effect) challengers.push_back(*effect);
  }
  for (const EffectInstance& entrant : entrants) {
    const bool same = entrant.effect == last.effect;
    if (same == (entrant.place == last.place)) continue;  // neither, or the best one itself
    challengers.push_back({entrant.effect, entrant.place, same ? last.parameters : entrant.parameters});
  }
  return challengers;
}

/// Fits a challenger to the end, and takes it up where it is new or better than it was.
void Selection::Answer(const Estimator& estimator, Estimate fit, std::vector<Estimate>& fits) {
  const auto known =
      std::find_if(fits.begin(), fits.end(), [&](const Estimate& other) { return other.Name() == fit.Name(); });
  if (known != fits.end() && known->settled && known->chi2 < fit.chi2 + 1.0) return;
  for (std::size_t i = 0; i < problem_.nuisances().size(); ++i) {
    if (Changes(fit.hypothesis.effects.back(), problem_.nuisances()[i])) fit.hypothesis.z[i] = 0.0;
  }
  const double best = fits.front().chi2;
  for (int round = 0; round < 3 && fit.ok() && !fit.settled; ++round) {
    const double gap = fit.chi2 - best;
    fit = estimator.Refine(std::move(fit), 2, {.slopes = Slopes::kKnown});
    if (fit.chi2 - best > std::max(kNear, kCloses * gap)) break;  // it gets there no more
  }
  if (fit.ok()) TakeUp(fits, std::move(fit));
}

/// The machine as a fit leaves it, for others to stand beside: if the fit itself says that a nominal value has
/// changed, that number is a nuisance parameter again.
Hypothesis Selection::Beside(const Estimate& fit) const {
  Hypothesis about = fit.hypothesis;
  for (std::size_t i = 0; i < problem_.nuisances().size(); ++i) {
    const Nuisance& nuisance = problem_.nuisances()[i];
    if (const std::optional<double> z = AsNuisance(nuisance, fit)) about.z[i] = *z;
    std::erase_if(about.effects, [&](const EffectInstance& instance) { return Changes(instance, nuisance); });
  }
  return about;
}

/// Carries a hypothesis to the full records over shorter ones. A sharp mode beside its true frequency loses the phase
/// within a second, the best amplitude there is none, and no slope leads on: over a short part it is still downhill.
/// What is short tells modes, not effects; these are held at first, unless they are what moves the modes.
Estimate Selection::FromShortHorizons(const Estimate& cold, const Estimator& last) {
  Estimate fit = cold;
  for (const EstimationProblem& rung : rungs_) {
    if (rung.measured().size() < 50 * static_cast<Eigen::Index>(rung.channels().size())) continue;
    fit = EstimateAt(rung, std::move(fit.hypothesis));
    if (!fit.ok()) return cold;
    const bool modes = &rung != &rungs_.back() && !MovesModes(cold);
    TakeSlopes(problem_, AtNominal(), rung, fit);
    fit = Estimator(rung, WhitenerOf(rung, fit, 0))
              .Refine(std::move(fit), 4, {.moves = modes ? Moves::kNuisances : Moves::kAll, .slopes = Slopes::kKnown});
    if (!fit.ok()) return cold;
  }
  fit = EstimateAt(problem_, std::move(fit.hypothesis));
  if (!fit.ok()) return cold;
  fit = FromItsOwn(std::move(fit), last);
  return fit.ok() ? fit : cold;
}

Estimate Selection::OverGrowingHorizons(const Estimate& cold, const Estimator& last) {
  constexpr double kFirst = 1.0 / 27.0, kGrowth = 1.5;
  Hypothesis at = cold.hypothesis;
  at.z = problem_.Nominal().z;
  for (double share = kFirst; share < 1.0 && !problem_.spent(); share *= kGrowth) {
    const EstimationProblem part = problem_.Part(share);
    Estimate fit = EstimateAt(part, std::move(at));
    if (!fit.ok()) return cold;
    TakeSlopes(problem_, AtNominal(), part, fit);
    // Twice: what is missed at first would count as noise.
    for (int k = 0; k < 2 && fit.ok(); ++k)
      fit = Estimator(part, WhitenerOf(part, fit, 0)).Refine(std::move(fit), 8, {.slopes = Slopes::kKnown});
    if (!fit.ok()) return cold;
    at = std::move(fit.hypothesis);
  }
  Estimate fit = EstimateAt(problem_, std::move(at));
  return fit.ok() ? FromItsOwn(std::move(fit), last) : cold;
}

std::optional<Hypothesis> Selection::FromAnyStart(const std::vector<EffectInstance>& starts) {
  if (rungs_.empty()) return std::nullopt;
  const EstimationProblem& shortest = rungs_.front();
  std::vector<Estimate> fits;
  for (const EffectInstance& start : starts) {
    if (problem_.spent()) return std::nullopt;
    step_("from any start: " + start.ToString(), 0.96);
    Hypothesis at = problem_.Nominal();
    at.effects = {start};
    Estimate fit = EstimateAt(shortest, std::move(at));
    if (fit.ok()) TakeSlopes(problem_, AtNominal(), shortest, fit);
    for (int k = 0; k < 2 && fit.ok(); ++k)
      fit = Estimator(shortest, WhitenerOf(shortest, fit, 0)).Refine(std::move(fit), 4, {.slopes = Slopes::kKnown});
    if (fit.ok()) fits.push_back(std::move(fit));
  }
  // By the noise of the one that leaves least: beside much larger residuals only the nuisance parameters would count.
  for (int k = 0; k < 2 && !fits.empty(); ++k) Sort(Estimator(shortest, WhitenerOf(shortest, fits.front(), 0)), fits);
  std::set<std::string> begun;
  for (const Estimate& fit : fits) {
    if (begun.size() >= kRegrown) break;
    if (!begun.insert(fit.Name()).second) continue;
    step_("from a short part: " + fit.Name(), 0.96);
    Estimate anew;
    anew.hypothesis = fit.hypothesis;
    anew = OverGrowingHorizons(anew,
                               Estimator(problem_, WhitenerOf(problem_, EstimateAt(problem_, problem_.Nominal()), 0)));
    if (AtFloor(anew)) return anew.hypothesis;
  }
  return std::nullopt;
}

}  // namespace dynoproof::diagnosis
