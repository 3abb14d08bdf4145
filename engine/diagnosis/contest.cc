#include "diagnosis/contest.h"

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
constexpr double kBeaten = 2.0;       // times the best one's chi2 beside the same doubts: no rival any more

}  // namespace

void BestFirst(std::vector<Fit>& fits) {
  std::stable_sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.criterion < b.criterion; });
}

void Sort(const Fitter& fitter, std::vector<Fit>& fits) {
  for (Fit& fit : fits) fitter.Weigh(fit);
  BestFirst(fits);
}

void KeepBetter(Fit& fit, Fit other) {
  if (other.ok() && other.chi2 < fit.chi2) fit = std::move(other);
}

void TakeUp(std::vector<Fit>& fits, Fit fit) {
  const auto known =
      std::find_if(fits.begin(), fits.end(), [&](const Fit& other) { return other.Name() == fit.Name(); });
  if (known != fits.end())
    KeepBetter(*known, std::move(fit));
  else
    fits.push_back(std::move(fit));
}

Contest::Contest(const Study& study, SavedFits& saved, Progress progress)
    : study_(study), saved_(saved), step_(std::move(progress)) {
  if (PredictionWindow(study.plan())) return;  // no mode is ever far out of phase
  for (const double share : {1.0 / 27.0, 1.0 / 9.0, 1.0 / 3.0}) rungs_.push_back(study.Part(share));
}

/// A doubt that is needed far outside its spread is no doubt any more: the effect that says so.
std::optional<Assumed> Contest::AsEffect(const Doubt& doubt, double z) const {
  constexpr double kWorthATry = 3.0;  // spreads
  if (doubt.effect == nullptr || !doubt.relative || std::abs(z) < kWorthATry) return std::nullopt;
  const EffectParameter& delta = doubt.effect->info().parameters.front();
  return Assumed{doubt.effect, doubt.at, {std::clamp(ChangeOf(doubt, z), delta.lower, delta.upper)}};
}

/// Such effects are candidates, found by all the doubts moving together, which no single start can.
bool Contest::Suggest(const Fitter& fitter, const Fit& null, std::vector<Fit>& fits) {
  bool taken = false;
  for (std::size_t i = 0; i < study_.doubts().size(); ++i) {
    const std::optional<Assumed> effect = AsEffect(study_.doubts()[i], null.hypothesis.z[i]);
    if (!effect) continue;
    Hypothesis at = null.hypothesis;
    at.effects.push_back(*effect);
    at.z[i] = 0.0;
    step_("fitting " + at.effects.back().ToString(), 0.5);
    Fit fit = FitAt(study_, std::move(at));
    ++simulations_;
    if (!fit.ok()) continue;
    fitter.Weigh(fit);
    std::erase_if(fits, [&](const Fit& other) { return other.Name() == fit.Name() && other.chi2 > fit.chi2; });
    if (std::any_of(fits.begin(), fits.end(), [&](const Fit& other) { return other.Name() == fit.Name(); })) continue;
    fits.push_back(std::move(fit));
    taken = true;
  }
  BestFirst(fits);
  return taken;
}

/// Everything is fitted again, effects and doubts together, until the order no longer changes.
void Contest::Decide(const std::vector<Assumed>& entrants, std::vector<Fit>& fits, Fit& null) {
  if (fits.empty()) return;
  Race(fits, null);
  if (fits.empty()) return;
  if (!rungs_.empty() && fits.front().hypothesis.effects.size() == 1 && !AtFloor(fits.front()) &&
      !ChangesStructure(fits.front().hypothesis.effects.front()))
    Regrow(entrants, fits);
  Challenge(entrants, fits);
  {
    // With the noise's colour taken from the best fit differences count by their weight against the noise.
    const Fitter fitter(study_, WhitenerOf(study_, fits.front()));
    Sort(fitter, fits);
    Each(fits, "fitting with the noise's colour: ", 0.68, [&](std::size_t k) {
      if (k >= kPolished || (k > 0 && fits[k].chi2 > kBeaten * fits.front().chi2)) return false;
      fits[k] = fitter.Polish(std::move(fits[k]), 4);
      return true;
    });
    if (fits.empty()) return;
  }
  const Fitter fitter(study_, WhitenerOf(study_, fits.front()));
  // The nominal model gets every chance: also from where the doubts stand beside the best effect.
  Fit other = null;
  other.hypothesis.z = Beside(fits.front()).z;
  null = fitter.Polish(std::move(null), 3);
  KeepBetter(null, fitter.Polish(std::move(other), 4));
  Sort(fitter, fits);
  // Who comes out first without having been fitted here (taken up late, weighed without the price of its doubts) is
  // fitted now: what follows needs its slopes.
  while (!fits.empty() &&
         fits.front().doubts.jacobian.cols() != static_cast<Eigen::Index>(fits.front().doubts.free.size())) {
    fits.front() = fitter.Polish(std::move(fits.front()), 4);
    std::erase_if(fits, [](const Fit& fit) { return !fit.ok(); });
    Sort(fitter, fits);
  }
}

/// Fits again those that `fit_again` takes up, best first, and sorts.
template <class FitAgain>
void Contest::Each(std::vector<Fit>& fits, const std::string& what, double fraction, const FitAgain& fit_again) {
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const int before = fits[k].simulations;
    if (!fit_again(k)) continue;
    step_(what + fits[k].Name(), fraction + 0.06 * static_cast<double>(k) / static_cast<double>(fits.size()));
    simulations_ += std::max(0, fits[k].simulations - before);
  }
  std::erase_if(fits, [](const Fit& fit) { return !fit.ok(); });
  BestFirst(fits);
}

/// A rival is not beaten before it has found its place: all that come anywhere near the best race on, lap by lap, as
/// long as a lap brings them a good part of the way to it. As if the noise were white: the residual gets as small as
/// it can; a colour taken from a fit that is not there yet would count what it lacks as noise, and stay there.
void Contest::Race(std::vector<Fit>& fits, const Fit& null) {
  std::set<std::string> out;
  for (int lap = 0; lap < kLaps && out.size() < fits.size(); ++lap) {
    const Fitter fitter(study_, WhitenerOf(study_, fits.front(), 0));
    Sort(fitter, fits);
    Fit nominal = null;
    fitter.Weigh(nominal);
    const double best = fits.front().chi2, reach = kContender * std::max(0.0, nominal.chi2 - best);
    Each(fits, "fitting to the end: ", 0.5 + 0.02 * lap, [&](std::size_t k) {
      const double gap = fits[k].chi2 - best;
      if (out.contains(fits[k].Name()) || (lap > 0 && k > 0 && gap > reach)) return false;
      const double before = fits[k].chi2;
      if (lap == 0 && k > 0 && Accounts(fits.front())) return false;
      fits[k] = FromItsOwn(std::move(fits[k]), fitter);
      if (fits[k].ok()) saved_.Keep(fits[k].hypothesis.effects);
      // The doubts may have run off before the effect had its size: once more from the nominal values.
      if (lap == 0 && (k == 0 || (!Accounts(fits[k]) && (k < kWarmed || AtFloor(fits[k]) || MovesModes(fits[k]))))) {
        Fit anew = fits[k];
        anew.hypothesis.z = study_.Nominal().z;
        KeepBetter(fits[k], Warm(anew, fitter));
        if (!Accounts(fits[k])) KeepBetter(fits[k], FromItsOwn(FitAt(study_, anew.hypothesis), fitter));
      }
      // Where the leader is at the noise with strained values only, somebody else may be there without.
      if (lap == 0 && k > 0 && AtFloor(fits.front()) && !Accounts(fits.front()))
        KeepBetter(fits[k], Grown(fits[k], fitter));
      if (fits[k].settled || before - fits[k].chi2 < kProgress * std::max(gap, 1.0)) out.insert(fits[k].Name());
      return true;
    });
    // Nothing is left to gain: who does as well beside the same doubts is asked next.
    if (fits.empty() || Accounts(fits.front())) return;
  }
}

/// Fits on, as if what the fit itself leaves were the noise; weighed by `fitter`, as its rivals are. By the best
/// one's noise, what a fit lacks that is still far off would outweigh all prior knowledge, and drive its doubts away.
Fit Contest::FromItsOwn(Fit fit, const Fitter& fitter) const {
  if (!fit.ok()) return fit;
  const Fitter own(study_, WhitenerOf(study_, fit, 0));
  fit = own.Polish(std::move(fit), 3);
  if (fit.ok()) fitter.Weigh(fit);
  return fit;
}

/// Whether an effect of the fit says that a nominal value has changed.
bool Contest::MovesModes(const Fit& fit) const {
  return std::any_of(study_.doubts().begin(), study_.doubts().end(),
                     [&](const Doubt& doubt) { return AsDoubt(doubt, fit).has_value(); });
}

/// Whether a fit leaves nothing to gain for others: neither in the residual nor in what it asks of the machine.
bool Contest::Accounts(const Fit& fit) const { return AtFloor(fit) && Farthest(study_, fit) < kStrained; }

/// Whether all that a fit leaves is white noise, as large as its highest frequencies say.
bool Contest::AtFloor(const Fit& fit) const {
  constexpr double kNear = 1.2;
  if (!fit.ok() || fit.predicted.size() == 0) return false;
  const Eigen::VectorXd residual = study_.measured() - fit.predicted;
  return std::all_of(study_.channels().begin(), study_.channels().end(), [&](const Channel& channel) {
    const auto rows = residual.segment(channel.begin, channel.count);
    return RmsOf(rows) < kNear * HighFrequencyFloor(rows);
  });
}

/// Where nobody comes to the noise: the first entrants begin anew, at the sizes at which they entered and on parts that
/// grow. Fitted to all of a line that rings out of step they may have left a size that was right. Not beside a change
/// of structure, which short parts do not tell, and which comes to its place by itself.
void Contest::Regrow(const std::vector<Assumed>& entrants, std::vector<Fit>& fits) {
  const Fitter fitter(study_, WhitenerOf(study_, fits.front(), 0));
  Sort(fitter, fits);
  for (std::size_t k = 0; k < std::min(kRegrown, entrants.size()); ++k) {
    if (ChangesStructure(entrants[k])) continue;
    Fit fit;
    fit.hypothesis = study_.Nominal();
    fit.hypothesis.effects = {entrants[k]};
    if (!begun_anew_.insert(fit.Name()).second) continue;
    step_("from a short part: " + fit.Name(), 0.6);
    fit = Grown(fit, fitter);
    if (!fit.ok() || fit.predicted.size() == 0) continue;
    const bool explains = AtFloor(fit);
    TakeUp(fits, std::move(fit));
    if (explains) break;
  }
  BestFirst(fits);
}

/// Who could do the same beside the doubts as the best one leaves them?
void Contest::Challenge(const std::vector<Assumed>& entrants, std::vector<Fit>& fits) {
  std::set<std::string> asked;
  for (int round = 0; round < 2; ++round) {
    const Fitter fitter(study_, WhitenerOf(study_, fits.front()));
    for (Fit& fit : fits) fitter.Weigh(fit);
    const Fit best = fits.front();
    const Hypothesis about = Beside(best);
    const Result<DoubtModel> doubts = LineariseDoubts(study_, about, FreedomOf(study_, about.effects));
    if (!doubts.ok()) return;
    for (const Assumed& challenger : ChallengersOf(entrants, fits)) {
      std::vector<Assumed> effects(best.hypothesis.effects.begin(), best.hypothesis.effects.end() - 1);
      effects.push_back(challenger);
      DoubtModel beside = *doubts;
      for (std::size_t i = 0; i < study_.doubts().size(); ++i) {
        if (Changes(challenger, study_.doubts()[i])) beside.z0[i] = 0.0;  // the challenger says it instead
      }
      Fit fit = fitter.Optimise(effects, beside, 4);
      simulations_ += fit.simulations;
      if (!fit.ok() || fit.chi2 > kBeaten * best.chi2 || !asked.insert(best.Name() + "/" + fit.Name()).second) continue;
      step_("beside " + best.Name() + ": " + fit.Name(), 0.62);
      Answer(fitter, std::move(fit), fits);
    }
    BestFirst(fits);
    if (fits.front().Name() == best.Name() || best.criterion - fits.front().criterion < 1.0) return;
  }
}

/// Those that were fitted with the best one (the first), and those that are recalled; what says openly that a nominal
/// value is as far off as the best one needs it; other effects at its place, because of laws that contain one another
/// the simplest must win; and the same effect at other places.
std::vector<Assumed> Contest::ChallengersOf(const std::vector<Assumed>& entrants, const std::vector<Fit>& fits) const {
  const Assumed& last = fits.front().hypothesis.effects.back();
  std::vector<Assumed> challengers;
  for (std::size_t k = 1; k < fits.size(); ++k) challengers.push_back(fits[k].hypothesis.effects.back());
  for (const Assumed& beaten : beaten_) {
    if (!beaten.SameCause(last)) challengers.push_back(beaten);
  }
  for (std::size_t i = 0; i < study_.doubts().size(); ++i) {
    const std::optional<Assumed> effect = AsEffect(study_.doubts()[i], fits.front().hypothesis.z[i]);
    if (effect) challengers.push_back(*effect);
  }
  for (const Assumed& entrant : entrants) {
    const bool same = entrant.effect == last.effect;
    if (same == (entrant.place == last.place)) continue;  // neither, or the best one itself
    challengers.push_back({entrant.effect, entrant.place, same ? last.parameters : entrant.parameters});
  }
  return challengers;
}

/// Fits a challenger to the end, and takes it up where it is new or better than it was.
void Contest::Answer(const Fitter& fitter, Fit fit, std::vector<Fit>& fits) {
  const auto known =
      std::find_if(fits.begin(), fits.end(), [&](const Fit& other) { return other.Name() == fit.Name(); });
  if (known != fits.end() && known->settled && known->chi2 < fit.chi2 + 1.0) return;
  for (std::size_t i = 0; i < study_.doubts().size(); ++i) {
    if (Changes(fit.hypothesis.effects.back(), study_.doubts()[i])) fit.hypothesis.z[i] = 0.0;
  }
  fit.simulations = 0;
  fit = fitter.Polish(std::move(fit), 6);
  simulations_ += fit.simulations;
  if (fit.ok()) TakeUp(fits, std::move(fit));
}

/// The machine as a fit leaves it, for others to stand beside: if the fit itself says that a nominal value has
/// changed, that number is a doubt again.
Hypothesis Contest::Beside(const Fit& fit) const {
  Hypothesis about = fit.hypothesis;
  for (std::size_t i = 0; i < study_.doubts().size(); ++i) {
    const Doubt& doubt = study_.doubts()[i];
    if (const std::optional<double> z = AsDoubt(doubt, fit)) about.z[i] = *z;
    std::erase_if(about.effects, [&](const Assumed& assumed) { return Changes(assumed, doubt); });
  }
  return about;
}

/// Carries a hypothesis to the full records over shorter ones. A sharp mode beside its true frequency loses the phase
/// within a second, the best amplitude there is none, and no slope leads on: over a short part it is still downhill.
/// What is short tells modes, not effects; these are held at first, unless they are what moves the modes.
Fit Contest::Warm(const Fit& cold, const Fitter& last) {
  Fit fit = cold;
  for (const Study& rung : rungs_) {
    if (rung.measured().size() < 50 * static_cast<Eigen::Index>(rung.channels().size())) continue;
    fit = FitAt(rung, std::move(fit.hypothesis));
    if (!fit.ok()) return cold;
    const bool modes = &rung != &rungs_.back() && !MovesModes(cold);
    fit = Fitter(rung, WhitenerOf(rung, fit, 0)).Polish(std::move(fit), 4, modes ? Moves::kDoubts : Moves::kAll);
    simulations_ += fit.simulations;
    if (!fit.ok()) return cold;
  }
  fit = FitAt(study_, std::move(fit.hypothesis));
  if (!fit.ok()) return cold;
  fit = FromItsOwn(std::move(fit), last);
  simulations_ += fit.simulations;
  return fit.ok() ? fit : cold;
}

Fit Contest::Grown(const Fit& cold, const Fitter& last) {
  constexpr double kFirst = 1.0 / 27.0, kGrowth = 1.5;
  Hypothesis at = cold.hypothesis;
  at.z = study_.Nominal().z;
  for (double share = kFirst; share < 1.0; share *= kGrowth) {
    const Study part = study_.Part(share);
    Fit fit = FitAt(part, std::move(at));
    if (!fit.ok()) return cold;
    // Twice: what is missed at first would count as noise.
    for (int k = 0; k < 2 && fit.ok(); ++k) fit = Fitter(part, WhitenerOf(part, fit, 0)).Polish(std::move(fit), 8);
    simulations_ += fit.simulations;
    if (!fit.ok()) return cold;
    at = std::move(fit.hypothesis);
  }
  Fit fit = FitAt(study_, std::move(at));
  return fit.ok() ? FromItsOwn(std::move(fit), last) : cold;
}

std::optional<Hypothesis> Contest::FromAnyStart(const std::vector<Assumed>& starts) {
  if (rungs_.empty()) return std::nullopt;
  const Study& shortest = rungs_.front();
  std::vector<Fit> fits;
  for (const Assumed& start : starts) {
    step_("from any start: " + start.ToString(), 0.96);
    Hypothesis at = study_.Nominal();
    at.effects = {start};
    Fit fit = FitAt(shortest, std::move(at));
    for (int k = 0; k < 2 && fit.ok(); ++k)
      fit = Fitter(shortest, WhitenerOf(shortest, fit, 0)).Polish(std::move(fit), 4);
    simulations_ += fit.simulations;
    if (fit.ok()) fits.push_back(std::move(fit));
  }
  // By the noise of the one that leaves least: beside much larger residuals only the doubts would count.
  for (int k = 0; k < 2 && !fits.empty(); ++k) Sort(Fitter(shortest, WhitenerOf(shortest, fits.front(), 0)), fits);
  std::set<std::string> begun;
  for (const Fit& fit : fits) {
    if (begun.size() >= kRegrown) break;
    if (!begun.insert(fit.Name()).second) continue;
    step_("from a short part: " + fit.Name(), 0.96);
    Fit anew;
    anew.hypothesis = fit.hypothesis;
    anew = Grown(anew, Fitter(study_, WhitenerOf(study_, FitAt(study_, study_.Nominal()), 0)));
    if (AtFloor(anew)) return anew.hypothesis;
  }
  return std::nullopt;
}

}  // namespace dynoproof::diagnosis
