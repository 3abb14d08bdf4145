#include "diagnosis/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "diagnosis/decide.h"
#include "diagnosis/gain.h"
#include "diagnosis/resume.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kSearchRows = 2e4;  // a channel: where the search takes place, 2 s of a drive line
constexpr std::size_t kCarried = 4;  // fits that go on from there to all training data; an ambiguity set holds three
constexpr double kScreeningTime_s = 1.2;  // of a record: some 500 periods of a drive line's first mode
constexpr std::size_t kFullFits = 8;      // candidates that are fitted fully after the screening
constexpr std::size_t kPolished = 5;      // of these, those that are fitted with the noise's colour
constexpr std::size_t kWarmed = 3;        // and those that start anew from the shortest part
constexpr double kContender = 0.25;  // of the nominal model's excess of chi2: half of the way in RMS is still to go
constexpr int kLaps = 5;             // of the race to the end
constexpr double kStride = 0.1;      // of the gap to the best: less in a lap, and a rival is out
constexpr double kStrained = 2.5;    // spreads: of a dozen nominal values one lies that far off by chance in six cases
constexpr double kBeaten = 2.0;      // times the best one's chi2 beside the same doubts: no rival any more

void BestFirst(std::vector<Fit>& fits) {
  std::stable_sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.criterion < b.criterion; });
}
/// Best first, all under one whitener.
void Sort(const Fitter& fitter, std::vector<Fit>& fits) {
  for (Fit& fit : fits) fitter.Weigh(fit);
  BestFirst(fits);
}

/// Takes the other fit where it explains more.
void KeepBetter(Fit& fit, Fit other) {
  if (other.ok() && other.chi2 < fit.chi2) fit = std::move(other);
}

class Searching {
 public:
  Searching(const Study& study, const std::vector<MappedRecord>& data, double training_share,
            const SearchOptions& options)
      : whole_(study),
        part_(Rough(study.plan()), study.records(), study.registry(), PartShare(study), study.decompositions()),
        study_(&part_),
        short_(Rough(study.plan()), data, study.registry(), ShortShare(data, training_share), study.decompositions()),
        options_(options),
        saved_(options.out, options.resume, study) {
    for (const double share : {1.0 / 27.0, 1.0 / 9.0, 1.0 / 3.0})
      rungs_.emplace_back(Rough(study.plan()), study.records(), study.registry(), share * PartShare(study),
                          study.decompositions());
  }

  Result<Found> Run() {
    Step("nominal run", 0.0);
    const Result<DoubtModel> doubts = LineariseDoubts(*study_, study_->Nominal(), FreedomOf(*study_, {}));
    if (!doubts.ok()) return doubts.failure();
    Whitener whitener(study_->channels(), study_->measured() - doubts->predicted, 0);
    Fit null = Fitter(*study_, whitener).Evaluate({}, *doubts);
    if (!null.ok()) return Failure{null.broken, study_->plan().id};
    // Its size and then its colour without what the doubts explain.
    for (const int order : {0, Whitener::kOrder, Whitener::kOrder}) {
      whitener = WhitenerOf(*study_, null, order);
      null = Fitter(*study_, whitener).Evaluate({}, *doubts);
    }
    // Candidates start from the nominal values as they are written: doubts that were driven to explain an effect would
    // hide it. Only as a hypothesis of its own does the nominal model get all the freedom of its doubts.
    const Fit base = null;
    {
      const Fitter fitter(*study_, WhitenerOf(*study_, null, 0));
      Fit warm = Warm(null, fitter);
      null = fitter.Polish(std::move(null), 3);
      KeepBetter(null, std::move(warm));
    }

    found_.candidates = CandidatesFor(*study_, MagnitudesOf(*study_));
    found_.threshold = Threshold(whitener.rows(), found_.candidates.size());
    std::vector<Fit> fits = FitBest(Fitter(*study_, whitener), base, "one effect", 0.05, 0.5);
    Suggest(Fitter(*study_, whitener), null, fits);
    SortAgain(fits, null);
    Fit rough = fits.empty() ? null : fits.front();
    std::vector<Structure> structure;
    if (Status failed = ToTheWhole(null, fits, structure)) return *failed;
    if (AnyFound(structure)) {
      // Before an effect is called for, or a second one, the machine gets the time it needs.
      Fit& best = fits.empty() ? null : fits.front();
      for (const int order : {0, Whitener::kOrder})
        best = Fitter(*study_, WhitenerOf(*study_, best, order)).Polish(std::move(best), 8);
      const Fitter fitter(*study_, WhitenerOf(*study_, best));
      fitter.Weigh(null);
      Sort(fitter, fits);
      structure = StructureOf(fits.empty() ? null : fits.front());
    }
    if (!fits.empty() && AnyFound(structure)) {
      if (Status failed = TryPairs(fits, null, rough, structure)) return *failed;
    }
    found_.null = std::move(null);
    found_.fits = std::move(fits);
    found_.structure = std::move(structure);
    found_.simulations = simulations_;
    return std::move(found_);
  }

 private:
  /// One substep a sample: what a nonlinear law costs falls by four, and a search does not need the last digits.
  static Plan Rough(Plan plan) {
    plan.root["run"]["realtime"]["substeps"] = Value(1);
    return plan;
  }
  /// Searching takes as long as the records are; what a line's behaviour can tell, its first seconds do.
  static double PartShare(const Study& whole) {
    const auto rows = static_cast<double>(whole.measured().size());
    const double channels = static_cast<double>(std::max<std::size_t>(1, whole.channels().size()));
    const double share = kSearchRows * channels / std::max(rows, 1.0);
    return share > 0.7 ? 1.0 : share;
  }
  static double ShortShare(const std::vector<MappedRecord>& data, double training_share) {
    double share = 0.3;
    for (const MappedRecord& record : data) share = std::max(share, kScreeningTime_s / std::max(record.end_s, 1e-9));
    return std::min(share, training_share);
  }

  void Step(const std::string& what, double fraction) { options_.progress(what, fraction); }

  std::vector<Structure> StructureOf(const Fit& fit) const {
    return FindStructure(*study_, study_->measured() - fit.predicted, fit.predicted);
  }

  /// Screens every candidate on top of `base` and fits the best ones fully.
  std::vector<Fit> FitBest(const Fitter& fitter, const Fit& base, const std::string& what, double begin, double end) {
    const std::string stage = base.Name();
    screened_ = saved_.Screening(stage);
    if (screened_.empty()) {
      screened_ = ScreenShort(base, what, begin, begin + 0.7 * (end - begin));
      saved_.KeepScreening(stage, screened_);
    }
    for (const Screened& one : screened_) simulations_ += one.simulations;
    if (base.hypothesis.effects.empty()) found_.screened = screened_;
    std::vector<Fit> fits;
    for (const Screened& one : screened_) {
      if (!one.promising || fits.size() == kFullFits) break;
      const Candidate& candidate = found_.candidates[one.candidate];
      std::vector<Assumed> effects = base.hypothesis.effects;
      if (std::any_of(effects.begin(), effects.end(), [&](const Assumed& assumed) {
            return assumed.effect == candidate.effect && assumed.place == candidate.place;
          }))
        continue;
      effects.push_back(candidate.At(one.parameters));
      Step("fitting " + candidate.ToString(),
           begin + (end - begin) * (0.7 + 0.3 * static_cast<double>(fits.size()) / kFullFits));
      // Its own size first, beside doubts that follow linearly: the screening saw it at a small one.
      if (!saved_.Recall(effects)) {
        const Fit sized = fitter.Optimise(effects, base.doubts, 8);
        simulations_ += sized.simulations;
        if (sized.ok()) effects = sized.hypothesis.effects;
      }
      Fit fit = FitAt(*study_, {base.doubts.z0, effects});
      ++simulations_;
      if (!fit.ok()) continue;
      fitter.Weigh(fit);
      fits.push_back(std::move(fit));
    }
    BestFirst(fits);
    return fits;
  }

  /// A doubt that is needed far outside its spread is no doubt any more: the effect that says so.
  std::optional<Assumed> AsEffect(const Doubt& doubt, double z) const {
    constexpr double kWorthATry = 3.0;  // spreads
    const Effect* effect = study_->registry().FindEffect(doubt.effect);
    const std::optional<Place> place = ParsePlace(doubt.at);
    if (effect == nullptr || !place || !doubt.relative || std::abs(z) < kWorthATry) return std::nullopt;
    const EffectParameter& delta = effect->info().parameters.front();
    return Assumed{effect, *place, {std::clamp(ChangeOf(doubt, z), delta.lower, delta.upper)}};
  }

  /// Such effects are candidates, found by all the doubts moving together, which no single start can.
  void Suggest(const Fitter& fitter, const Fit& null, std::vector<Fit>& fits) {
    for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
      const std::optional<Assumed> effect = AsEffect(study_->doubts()[i], null.hypothesis.z[i]);
      if (!effect) continue;
      Hypothesis at = null.hypothesis;
      at.effects.push_back(*effect);
      at.z[i] = 0.0;
      Step("fitting " + at.effects.back().ToString(), 0.5);
      Fit fit = FitAt(*study_, std::move(at));
      ++simulations_;
      if (!fit.ok()) continue;
      fitter.Weigh(fit);
      std::erase_if(fits, [&](const Fit& other) { return other.Name() == fit.Name() && other.chi2 > fit.chi2; });
      if (std::none_of(fits.begin(), fits.end(), [&](const Fit& other) { return other.Name() == fit.Name(); }))
        fits.push_back(std::move(fit));
    }
    BestFirst(fits);
  }

  /// Screens on the first part of the records: it only ranks.
  std::vector<Screened> ScreenShort(const Fit& base, const std::string& what, double begin, double end) {
    const Result<DoubtModel> doubts =
        LineariseDoubts(short_, {base.doubts.z0, base.hypothesis.effects}, base.doubts.freedom);
    if (!doubts.ok()) return {};
    Whitener whitener(short_.channels(), short_.measured() - doubts->predicted, 0);
    Fit fit;
    for (const int order : {0, Whitener::kOrder, Whitener::kOrder}) {
      fit = Fitter(short_, whitener).Evaluate(base.hypothesis.effects, *doubts);
      if (!fit.ok()) return {};
      whitener = WhitenerOf(short_, fit, order);
    }
    const Fitter fitter(short_, whitener);
    fit = fitter.Evaluate(base.hypothesis.effects, *doubts);
    const double threshold = Threshold(whitener.rows(), found_.candidates.size());
    std::vector<Screened> screened = Screen(short_, fitter, fit, found_.candidates, threshold, [&](double done) {
      Step("screening, " + what, begin + (end - begin) * done);
    });
    for (Screened& one : screened) one.promising = std::isfinite(one.chi2) && fit.chi2 - one.chi2 >= 0.3 * threshold;
    return screened;
  }

  /// Everything is fitted again, effects and doubts together, until the order no longer changes.
  void SortAgain(std::vector<Fit>& fits, Fit& null) {
    if (fits.empty()) return;
    Race(fits, null);
    if (fits.empty()) return;
    Challenge(fits);
    {
      // With the noise's colour taken from the best fit differences count by their weight against the noise.
      const Fitter fitter(*study_, WhitenerOf(*study_, fits.front()));
      Sort(fitter, fits);
      Each(fits, "fitting with the noise's colour: ", 0.68, [&](std::size_t k) {
        if (k >= kPolished || (k > 0 && fits[k].chi2 > kBeaten * fits.front().chi2)) return false;
        fits[k] = fitter.Polish(std::move(fits[k]), 4);
        return true;
      });
      if (fits.empty()) return;
    }
    const Fitter fitter(*study_, WhitenerOf(*study_, fits.front()));
    // The nominal model gets every chance: also from where the doubts stand beside the best effect.
    Fit other = null;
    other.hypothesis.z = Beside(fits.front()).z;
    null = fitter.Polish(std::move(null), 3);
    KeepBetter(null, fitter.Polish(std::move(other), 4));
    Sort(fitter, fits);
  }

  /// Fits again those that `fit_again` takes up, best first, and sorts.
  template <class FitAgain>
  void Each(std::vector<Fit>& fits, const std::string& what, double fraction, const FitAgain& fit_again) {
    for (std::size_t k = 0; k < fits.size(); ++k) {
      const int before = fits[k].simulations;
      if (!fit_again(k)) continue;
      Step(what + fits[k].Name(), fraction + 0.06 * static_cast<double>(k) / kFullFits);
      simulations_ += std::max(0, fits[k].simulations - before);
    }
    std::erase_if(fits, [](const Fit& fit) { return !fit.ok(); });
    BestFirst(fits);
  }

  /// A rival is not beaten before it has found its place: all that come anywhere near the best race on, lap by lap, as
  /// long as a lap brings them a good part of the way to it. As if the noise were white: the residual gets as small as
  /// it can; a colour taken from a fit that is not there yet would count what it lacks as noise, and stay there.
  void Race(std::vector<Fit>& fits, const Fit& null) {
    std::set<std::string> out;
    for (int lap = 0; lap < kLaps && out.size() < fits.size(); ++lap) {
      const Fitter fitter(*study_, WhitenerOf(*study_, fits.front(), 0));
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
        if (lap == 0 && (k == 0 || (k < kWarmed && !AtFloor(fits[k])))) {
          Fit anew = fits[k];
          anew.hypothesis.z = study_->Nominal().z;
          KeepBetter(fits[k], Warm(anew, fitter));
          if (!AtFloor(fits[k])) KeepBetter(fits[k], FromItsOwn(FitAt(*study_, anew.hypothesis), fitter));
        }
        if (fits[k].settled || before - fits[k].chi2 < kStride * std::max(gap, 1.0)) out.insert(fits[k].Name());
        return true;
      });
      // Nothing is left to gain: who does as well beside the same doubts is asked next.
      if (fits.empty() || Accounts(fits.front())) return;
    }
  }

  /// Fits on, as if what the fit itself leaves were the noise; weighed by `fitter`, as its rivals are. By the best
  /// one's noise, what a fit lacks that is still far off would outweigh all prior knowledge, and drive its doubts away.
  Fit FromItsOwn(Fit fit, const Fitter& fitter) {
    if (!fit.ok()) return fit;
    const Fitter own(*study_, WhitenerOf(*study_, fit, 0));
    fit = own.Polish(std::move(fit), 3);
    if (fit.ok()) fitter.Weigh(fit);
    return fit;
  }

  /// Whether a fit leaves nothing to gain for others: neither in the residual nor in what it asks of the machine.
  bool Accounts(const Fit& fit) const { return AtFloor(fit) && Farthest(*study_, fit) < kStrained; }

  /// Whether all that a fit leaves is white noise, as large as its highest frequencies say.
  bool AtFloor(const Fit& fit) const {
    constexpr double kNear = 1.2;
    if (!fit.ok() || fit.predicted.size() == 0) return false;
    const Eigen::VectorXd residual = study_->measured() - fit.predicted;
    return std::all_of(study_->channels().begin(), study_->channels().end(), [&](const Channel& channel) {
      const auto rows = residual.segment(channel.begin, channel.count);
      return rows.norm() < kNear * HighFrequencyFloor(rows) * std::sqrt(static_cast<double>(channel.count));
    });
  }

  /// Who could do the same beside the doubts as the best one leaves them?
  void Challenge(std::vector<Fit>& fits) {
    std::set<std::string> asked;
    for (int round = 0; round < 2; ++round) {
      const Fitter fitter(*study_, WhitenerOf(*study_, fits.front()));
      for (Fit& fit : fits) fitter.Weigh(fit);
      const Fit best = fits.front();
      const Hypothesis about = Beside(best);
      const Result<DoubtModel> doubts = LineariseDoubts(*study_, about, FreedomOf(*study_, about.effects));
      if (!doubts.ok()) return;
      for (const Assumed& challenger : ChallengersOf(fits)) {
        std::vector<Assumed> effects(best.hypothesis.effects.begin(), best.hypothesis.effects.end() - 1);
        effects.push_back(challenger);
        DoubtModel beside = *doubts;
        for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
          if (Changes(challenger, study_->doubts()[i])) beside.z0[i] = 0.0;  // the challenger says it instead
        }
        Fit fit = fitter.Optimise(effects, beside, 4);
        simulations_ += fit.simulations;
        if (!fit.ok() || fit.chi2 > kBeaten * best.chi2 || !asked.insert(best.Name() + "/" + fit.Name()).second)
          continue;
        Step("beside " + best.Name() + ": " + fit.Name(), 0.62);
        Answer(fitter, std::move(fit), fits);
      }
      BestFirst(fits);
      if (fits.front().Name() == best.Name() || best.criterion - fits.front().criterion < 1.0) return;
    }
  }

  /// Those that were fitted with the best one (the first); what says openly that a nominal value is as far off as the
  /// best one needs it; other effects at its place, because of laws that contain one another the simplest must win; and
  /// the same effect at other places.
  std::vector<Assumed> ChallengersOf(const std::vector<Fit>& fits) const {
    const Assumed& last = fits.front().hypothesis.effects.back();
    std::vector<Assumed> challengers;
    for (std::size_t k = 1; k < fits.size(); ++k) challengers.push_back(fits[k].hypothesis.effects.back());
    for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
      const std::optional<Assumed> effect = AsEffect(study_->doubts()[i], fits.front().hypothesis.z[i]);
      if (effect) challengers.push_back(*effect);
    }
    for (const Screened& one : screened_) {
      if (!one.promising) break;
      const Candidate& candidate = found_.candidates[one.candidate];
      const bool same = candidate.effect == last.effect;
      if (same == (candidate.place == last.place)) continue;  // neither, or the best one itself
      challengers.push_back(candidate.At(same ? last.parameters : one.parameters));
    }
    return challengers;
  }

  /// Fits a challenger to the end, and takes it up where it is new or better than it was.
  void Answer(const Fitter& fitter, Fit fit, std::vector<Fit>& fits) {
    const auto known =
        std::find_if(fits.begin(), fits.end(), [&](const Fit& other) { return other.Name() == fit.Name(); });
    if (known != fits.end() && known->settled && known->chi2 < fit.chi2 + 1.0) return;
    for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
      if (Changes(fit.hypothesis.effects.back(), study_->doubts()[i])) fit.hypothesis.z[i] = 0.0;
    }
    fit.simulations = 0;
    fit = fitter.Polish(std::move(fit), 6);
    simulations_ += fit.simulations;
    if (known != fits.end())
      KeepBetter(*known, std::move(fit));
    else if (fit.ok())
      fits.push_back(std::move(fit));
  }

  /// The machine as a fit leaves it, for others to stand beside: if the fit itself says that a nominal value has
  /// changed, that number is a doubt again.
  Hypothesis Beside(const Fit& fit) const {
    Hypothesis about = fit.hypothesis;
    for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
      const Doubt& doubt = study_->doubts()[i];
      if (const std::optional<double> z = AsDoubt(doubt, fit)) about.z[i] = *z;
      std::erase_if(about.effects, [&](const Assumed& assumed) { return Changes(assumed, doubt); });
    }
    return about;
  }

  /// The one effect of a pair whose other is none: it moves a nominal value by no more than its doubt, which had not
  /// found its place yet, or has no size that can be told from nothing.
  std::optional<Fit> FoldBack(const Fit& pair) {
    Fit derived = pair;
    Fitter(*study_, WhitenerOf(*study_, pair)).Derive(derived);
    for (std::size_t e = 0; e < pair.hypothesis.effects.size(); ++e) {
      const Assumed& second = pair.hypothesis.effects[e];
      bool none = IsNothing(derived, e);
      Hypothesis at = pair.hypothesis;
      at.effects.erase(at.effects.begin() + static_cast<std::ptrdiff_t>(e));
      for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
        const Doubt& doubt = study_->doubts()[i];
        if (!Changes(second, doubt)) continue;
        at.z[i] = DeviateOf(doubt, second.parameters.front());
        none = none || std::abs(at.z[i]) <= kWithinDoubt;
      }
      if (!none) continue;
      Fit fit = FitAt(*study_, std::move(at));
      if (!fit.ok()) continue;
      for (const int order : {0, Whitener::kOrder})
        fit = Fitter(*study_, WhitenerOf(*study_, fit, order)).Polish(std::move(fit), 5);
      return fit;
    }
    return std::nullopt;
  }

  /// Carries a hypothesis to the full records over shorter ones. A sharp mode beside its true frequency loses the phase
  /// within a second, the best amplitude there is none, and no slope leads on: over a short part it is still downhill.
  /// What is short tells modes, not effects; these are held at first.
  Fit Warm(const Fit& cold, const Fitter& last) {
    Fit fit = cold;
    for (const Study& rung : rungs_) {
      if (rung.measured().size() < 50 * static_cast<Eigen::Index>(rung.channels().size())) continue;
      fit = FitAt(rung, std::move(fit.hypothesis));
      if (!fit.ok()) return cold;
      const bool modes = &rung != &rungs_.back();
      fit = Fitter(rung, WhitenerOf(rung, fit, 0)).Polish(std::move(fit), 4, modes ? Moves::kDoubts : Moves::kAll);
      simulations_ += fit.simulations;
      if (!fit.ok()) return cold;
    }
    fit = FitAt(*study_, std::move(fit.hypothesis));
    if (!fit.ok()) return cold;
    fit = FromItsOwn(std::move(fit), last);
    simulations_ += fit.simulations;
    return fit.ok() ? fit : cold;
  }

  /// `rough`: the best single effect where the search takes place.
  Status TryPairs(std::vector<Fit>& fits, Fit& null, const Fit& rough, std::vector<Structure>& structure) {
    study_ = &part_;
    const Fitter fitter(*study_, WhitenerOf(*study_, rough));
    Fit base = rough, nominal = FitAt(*study_, null.hypothesis);
    fitter.Weigh(base);
    base.doubts.z0 = base.hypothesis.z;  // candidates are added at the optimum
    std::vector<Fit> pairs = FitBest(fitter, base, "two effects", 0.7, 0.95);
    if (pairs.size() > 3) pairs.resize(3);
    SortAgain(pairs, nominal);
    std::optional<Fit> alone = pairs.empty() ? std::nullopt : FoldBack(pairs.front());
    if (alone) pairs = {std::move(*alone)};
    std::vector<Structure> left;
    if (Status failed = ToTheWhole(nominal, pairs, left)) return failed;
    if (pairs.empty()) return {};
    const Fitter last(*study_, WhitenerOf(*study_, pairs.front()));
    Fit best = last.Polish(fits.front(), 6);
    last.Weigh(pairs.front());
    // A second effect has to explain what the first one leaves, all of it: else nothing is known about either.
    const double gain = best.criterion - pairs.front().criterion;
    if (AnyFound(left) || gain < (pairs.front().hypothesis.effects.size() > 1 ? found_.threshold : 0.0)) {
      found_.partial = "no pair of effects accounts for the rest either";
      return {};
    }
    fits = std::move(pairs);
    structure = std::move(left);
    last.Weigh(null);
    last.Weigh(nominal);
    if (nominal.chi2 < null.chi2) null = std::move(nominal);
    return {};
  }

  /// Fits that stood on the part go on to all training data: the nominal model, and whatever is not far behind the
  /// best.
  Status ToTheWhole(Fit& null, std::vector<Fit>& fits, std::vector<Structure>& structure) {
    const Fitter last(*study_, fits.empty() ? WhitenerOf(*study_, null) : WhitenerOf(*study_, fits.front()));
    for (Fit& fit : fits) last.Weigh(fit);
    const double best = fits.empty() ? 0.0 : fits.front().criterion, rows = last.whitener().rows();
    std::vector<Fit> carried;
    for (Fit& fit : fits) {
      const double behind = fit.criterion - best;
      if (carried.empty() || (carried.size() < kCarried && behind < 0.5 * rows)) {
        carried.push_back(std::move(fit));
        continue;
      }
      Considered& left = found_.considered.emplace_back(ConsideredOf(fit));
      left.why_not = fmt::format("explains less of the first part of the data: -2 log evidence {:.0f} behind", behind);
      left.validation_nrmse = TotalNrmse(*study_, fit.predicted);
    }
    fits = std::move(carried);
    study_ = &whole_;
    const auto carry = [&](Fit& fit, const Fit* leader) {
      Step("all training data: " + fit.Name(), 0.95);
      fit = FitAt(*study_, std::move(fit.hypothesis));
      if (!fit.ok()) return;
      for (const int order : {0, Whitener::kOrder})
        fit = Fitter(*study_, WhitenerOf(*study_, leader != nullptr ? *leader : fit, order))
                  .Polish(std::move(fit), order > 0 ? 4 : 2);
    };
    for (std::size_t k = 0; k < fits.size(); ++k) carry(fits[k], k > 0 && fits[0].ok() ? &fits[0] : nullptr);
    std::erase_if(fits, [](const Fit& fit) { return !fit.ok(); });
    carry(null, fits.empty() ? nullptr : &fits.front());
    if (!null.ok()) return Failure{null.broken, study_->plan().id};
    const Fitter fitter(*study_, WhitenerOf(*study_, fits.empty() ? null : fits.front()));
    Sort(fitter, fits);
    found_.threshold = Threshold(fitter.whitener().rows(), found_.candidates.size());
    structure = StructureOf(fits.empty() ? null : fits.front());
    return {};
  }

  const Study& whole_;        // all that is for training
  const Study part_;          // where the search takes place: coarser, and its first part when the records are long
  const Study* study_;        // where the fits stand now: the part, then the whole
  const Study short_;         // where candidates are screened
  std::vector<Study> rungs_;  // shorter and shorter parts, the shortest first
  const SearchOptions& options_;
  SavedFits saved_;
  Found found_;
  std::vector<Screened> screened_;  // on top of what stood then
  int simulations_ = 0;
};

}  // namespace

Considered ConsideredOf(const Fit& fit) {
  Considered considered;
  const std::vector<Assumed>& effects = fit.hypothesis.effects;
  for (std::size_t e = 0; e + 1 < effects.size(); ++e) considered.name += effects[e].ToString() + " + ";
  considered.name += effects.back().effect->info().name;
  considered.at = effects.back().place.ToString();
  return considered;
}

std::optional<double> AsDoubt(const Doubt& doubt, const Fit& fit) {
  for (const Assumed& assumed : fit.hypothesis.effects) {
    if (Changes(assumed, doubt)) return DeviateOf(doubt, assumed.parameters.front());
  }
  return std::nullopt;
}

Result<Found> Search(const Study& study, const std::vector<MappedRecord>& data, double training_share,
                     const SearchOptions& options) {
  return Searching(study, data, training_share, options).Run();
}

}  // namespace dynoproof::diagnosis
