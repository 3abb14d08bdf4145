#include "diagnosis/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include "base/random.h"
#include "diagnosis/decide.h"
#include "diagnosis/extend.h"
#include "diagnosis/resume.h"
#include "diagnosis/screening.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kTrainingShare = 0.7;
constexpr double kSearchRows = 2e4;       // a channel: where the search takes place, 2 s of a drive line
constexpr std::size_t kCarried = 3;       // fits that go on from there to all training data
constexpr double kScreeningTime_s = 1.2;  // of a record: some 500 periods of a drive line's first mode
constexpr std::size_t kFullFits = 8;      // candidates that are fitted fully after the screening
constexpr std::size_t kPolished = 5;      // of these, those whose doubts are linearised anew
constexpr std::size_t kWarmed = 3;        // and those that are carried up from the shortest part
constexpr double kContender = 0.25;   // of the nominal model's excess of chi2: half of the way in RMS is still to go
constexpr double kBeyondDoubt = 4.0;  // spreads: by chance once in 16 000
constexpr int kLaps = 5;              // of the race to the end
constexpr double kStride = 0.1;       // of the gap to the best: less in a lap, and a rival is out
constexpr double kBeaten = 2.0;       // times the best one's chi2, when it has found its place: no rival any more
constexpr double kHopeless = 6.0;     // times the best one's chi2, when nothing has been linearised anew yet

class Diagnosing {
 public:
  Diagnosing(const Study& study, const std::vector<MappedRecord>& data, const std::vector<MappedRecord>& holdout,
             const DiagnoseOptions& options)
      : whole_(study),
        part_(PartOf(study)),
        study_(part_ ? &*part_ : &whole_),
        short_(ShortPlan(study.plan()), data, study.registry(), ShortShare(data)),
        tiny_(study.plan(), data, study.registry(), 0.25 * ShortShare(data)),
        data_(data),
        holdout_(holdout),
        options_(options),
        saved_(options.out, options.resume, study) {}

  Result<Diagnosis> Run() {
    result_.own_holdout = !holdout_.empty();
    if (!result_.own_holdout) result_.notes.push_back("the last 30 % of the data are the hold-out");
    Step("nominal run", 0.0);
    const Result<Eigen::VectorXd> nominal = study_->Predict(study_->Nominal());
    if (!nominal.ok()) return nominal.failure();
    nominal_prediction_ = *nominal;
    const Result<DoubtModel> doubts = LineariseDoubts(*study_, study_->Nominal(), FreedomOf(*study_, {}));
    if (!doubts.ok()) return doubts.failure();
    Whitener whitener(study_->channels(), study_->measured() - *nominal, 0);
    Fit null = Fitter(*study_, whitener).Evaluate({}, *doubts);
    if (!null.ok()) return Failure{null.broken, study_->plan().id};
    // Its size and then its colour without what the doubts explain.
    for (const int order : {0, Whitener::kOrder, Whitener::kOrder}) {
      whitener = WhitenerOf(null, order);
      null = Fitter(*study_, whitener).Evaluate({}, *doubts);
    }
    // Candidates start from the nominal values as they are written: doubts that were driven to explain an effect would
    // hide it. Only as a hypothesis of its own does the nominal model get all the freedom of its doubts.
    const Fit base = null;
    null = Warm(null);
    null = Fitter(*study_, WhitenerOf(null, 0)).Polish(std::move(null), 3);

    candidates_ = CandidatesFor(*study_, MagnitudesOf(*study_));
    threshold_ = Threshold(whitener.rows(), candidates_.size());
    std::vector<Fit> fits = FitBest(Fitter(*study_, whitener), base, "one effect", 0.05, 0.5);
    Suggest(Fitter(*study_, whitener), null, fits);
    SortAgain(fits, null);
    Fit best = fits.empty() ? null : fits.front();
    std::vector<Structure> structure = StructureOf(best);
    if (!fits.empty() && Above(structure)) {
      // Before a second effect is called for, the first one gets the time it needs.
      for (const int order : {0, 0, Whitener::kOrder}) best = Fitter(*study_, WhitenerOf(best, order)).Polish(best, 8);
      const Fitter fitter(*study_, WhitenerOf(best));
      fits.front() = best;
      for (Fit& fit : fits) fitter.Weigh(fit);
      structure = StructureOf(best);
    }
    if (!fits.empty() && Above(structure)) TryPairs(fits, null, best, structure);
    if (part_) {
      if (Status failed = ToTheWhole(null, fits, structure)) return *failed;
    }
    Judge(null, fits, structure);
    if (Status failed = Conclude(null, fits)) return *failed;
    result_.simulations = simulations_;
    Step("done", 1.0);
    return std::move(result_);
  }

 private:
  static Plan ShortPlan(Plan plan) {
    plan.root["run"]["realtime"]["substeps"] = Value(2);
    return plan;
  }
  /// Searching takes as long as the records are; what a line's behaviour can tell, its first seconds do.
  static std::optional<Study> PartOf(const Study& whole) {
    const auto rows = static_cast<double>(whole.measured().size());
    const double channels = static_cast<double>(std::max<std::size_t>(1, whole.channels().size()));
    const double share = kSearchRows * channels / std::max(rows, 1.0);
    if (share > 0.7) return std::nullopt;
    return Study(whole.plan(), whole.records(), whole.registry(), share);
  }
  static double ShortShare(const std::vector<MappedRecord>& data) {
    double share = 0.3;
    for (const MappedRecord& record : data) share = std::max(share, kScreeningTime_s / std::max(record.end_s, 1e-9));
    return std::min(share, kTrainingShare);
  }

  void Step(const std::string& what, double fraction) { options_.progress(what, fraction); }

  Whitener WhitenerOf(const Fit& fit, int order = Whitener::kOrder) const {
    return {study_->channels(), study_->measured() - fit.predicted, order};
  }
  std::vector<Structure> StructureOf(const Fit& fit) const {
    return FindStructure(*study_, study_->measured() - fit.predicted, fit.predicted);
  }
  static bool Above(const std::vector<Structure>& structure) {
    return std::any_of(structure.begin(), structure.end(), [](const Structure& s) { return s.found(); });
  }

  /// Screens every candidate on top of `base` and fits the best ones fully.
  std::vector<Fit> FitBest(const Fitter& fitter, const Fit& base, const std::string& what, double begin, double end) {
    const std::string stage = base.Name();
    std::vector<Screened> screened = saved_.Screening(stage);
    if (screened.empty()) {
      screened = ScreenShort(base, what, begin, begin + 0.7 * (end - begin));
      saved_.KeepScreening(stage, screened);
    }
    for (const Screened& one : screened) simulations_ += one.simulations;
    if (base.hypothesis.effects.empty()) screened_ = screened;
    std::vector<Fit> fits;
    for (std::size_t k = 0; k < screened.size() && fits.size() < kFullFits; ++k) {
      const Screened& one = screened[k];
      if (!std::isfinite(one.chi2) || short_base_chi2_ - one.chi2 < 0.3 * short_threshold_) break;
      const Candidate& candidate = candidates_[one.candidate];
      std::vector<Assumed> effects = base.hypothesis.effects;
      if (std::any_of(effects.begin(), effects.end(), [&](const Assumed& assumed) {
            return assumed.effect == candidate.effect && assumed.place == candidate.place;
          }))
        continue;
      effects.push_back(candidate.At(one.parameters));
      Step("fitting " + candidate.ToString(),
           begin + (end - begin) * (0.7 + 0.3 * static_cast<double>(fits.size()) / kFullFits));
      Fit fit = OptimiseAfresh(fitter, effects, base);
      simulations_ += fit.simulations;
      if (fit.ok()) fits.push_back(std::move(fit));
    }
    std::stable_sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.criterion < b.criterion; });
    return fits;
  }

  /// A doubt that the nominal model needs far outside its spread is no doubt any more: it is a candidate, found by all
  /// the doubts moving together, which no single start can.
  void Suggest(const Fitter& fitter, const Fit& null, std::vector<Fit>& fits) {
    constexpr double kFar = 3.0;
    for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
      const Doubt& doubt = study_->doubts()[i];
      if (doubt.effect.empty() || !doubt.relative || std::abs(null.hypothesis.z[i]) < kFar) continue;
      const Effect* effect = study_->registry().FindEffect(doubt.effect);
      const std::optional<Place> place = ParsePlace(doubt.at);
      if (effect == nullptr || !place) continue;
      const EffectParameter& delta = effect->info().parameters.front();
      Hypothesis at = null.hypothesis;
      at.effects.push_back({effect, *place, {std::clamp(doubt.spread * at.z[i], delta.lower, delta.upper)}});
      at.z[i] = 0.0;
      const Result<DoubtModel> doubts = LineariseDoubts(*study_, at, FreedomOf(*study_, at.effects));
      if (!doubts.ok()) continue;
      Step("fitting " + at.effects.back().ToString(), 0.5);
      Fit fit = fitter.Optimise(at.effects, *doubts, 8);
      simulations_ += fit.simulations + static_cast<int>(doubts->free.size()) + 1;
      if (!fit.ok()) continue;
      std::erase_if(fits, [&](const Fit& other) { return other.Name() == fit.Name() && other.chi2 > fit.chi2; });
      if (std::none_of(fits.begin(), fits.end(), [&](const Fit& other) { return other.Name() == fit.Name(); }))
        fits.push_back(std::move(fit));
    }
    std::stable_sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.criterion < b.criterion; });
  }

  /// Screens on the first part of the records, with half the substeps: it only ranks.
  std::vector<Screened> ScreenShort(const Fit& base, const std::string& what, double begin, double end) {
    const Result<DoubtModel> doubts =
        LineariseDoubts(short_, {base.doubts.z0, base.hypothesis.effects}, base.doubts.freedom);
    if (!doubts.ok()) return {};
    const Result<Eigen::VectorXd> at = short_.Predict({base.doubts.z0, base.hypothesis.effects});
    if (!at.ok()) return {};
    Whitener whitener(short_.channels(), short_.measured() - *at, 0);
    Fit fit;
    for (const int order : {0, Whitener::kOrder, Whitener::kOrder}) {
      fit = Fitter(short_, whitener).Evaluate(base.hypothesis.effects, *doubts);
      if (!fit.ok()) return {};
      whitener = Whitener(short_.channels(), short_.measured() - fit.predicted, order);
    }
    const Fitter fitter(short_, whitener);
    fit = fitter.Evaluate(base.hypothesis.effects, *doubts);
    short_base_chi2_ = fit.chi2;
    short_threshold_ = Threshold(whitener.rows(), candidates_.size());
    return Screen(short_, fitter, fit, candidates_, short_threshold_,
                  [&](double done) { Step("screening, " + what, begin + (end - begin) * done); });
  }

  /// From the saved optimum where there is one. The doubts are those of the base, less the effect's own.
  Fit OptimiseAfresh(const Fitter& fitter, std::vector<Assumed> effects, const Fit& base) {
    const bool known = saved_.Recall(effects);
    std::vector<double> freedom = FreedomOf(*study_, effects);
    Hypothesis at{base.doubts.z0, effects};
    if (freedom != base.doubts.freedom) {
      // Another set of doubts: they are linearised about the effect itself.
      const Result<DoubtModel> doubts = LineariseDoubts(*study_, at, freedom);
      if (!doubts.ok()) return fitter.Evaluate(effects, base.doubts);
      Fit fit = fitter.Optimise(effects, *doubts, known ? 2 : 8);
      fit.simulations += static_cast<int>(doubts->free.size()) + 1;
      saved_.Keep(fit.hypothesis.effects);
      return fit;
    }
    Fit fit = fitter.Optimise(effects, base.doubts, known ? 2 : 8);
    if (fit.ok()) saved_.Keep(fit.hypothesis.effects);
    return fit;
  }

  /// With the noise's colour taken from the best fit, everything is fitted again: now differences count by their weight
  /// against the noise, not against the effect itself.
  void SortAgain(std::vector<Fit>& fits, Fit& null) {
    if (fits.empty()) return;
    const auto order = [&] {
      std::stable_sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.criterion < b.criterion; });
    };
    const auto each = [&](const Fitter& fitter, const std::string& what, double fraction, const auto& fit_again) {
      for (std::size_t k = 0; k < fits.size(); ++k) {
        const int before = fits[k].simulations;
        if (!fit_again(k)) continue;
        Step(what + fits[k].Name(), fraction + 0.06 * static_cast<double>(k) / kFullFits);
        simulations_ += std::max(0, fits[k].simulations - before);
        fitter.Weigh(fits[k]);
      }
      std::erase_if(fits, [](const Fit& fit) { return !fit.ok(); });
      order();
    };
    // First as if the noise were white: the residual gets as small as it can. A colour taken from a fit that is not
    // there yet would count what the fit lacks as noise, and stay there.
    {
      const Fitter fitter(*study_, WhitenerOf(fits.front(), 0));
      for (Fit& fit : fits) fitter.Weigh(fit);
      order();
      each(fitter, "fitting over longer and longer parts: ", 0.5, [&](std::size_t k) {
        if (k >= kWarmed || (k > 0 && fits[k].chi2 > kHopeless * fits.front().chi2)) return false;
        fits[k] = Warm(fits[k]);
        return true;
      });
      if (fits.empty()) return;
    }
    // A rival is not beaten before it has found its place: all that come anywhere near the best race on, round by
    // round, as long as a round brings them a good part of the way to it. The size of the noise is taken anew each
    // time: before the best one is there, the doubts' prior weighs too much.
    std::set<std::string> out;
    for (int lap = 0; lap < kLaps && out.size() < fits.size(); ++lap) {
      const Fitter fitter(*study_, WhitenerOf(fits.front(), 0));
      for (Fit& fit : fits) fitter.Weigh(fit);
      order();
      Fit nominal = null;
      fitter.Weigh(nominal);
      const double best = fits.front().chi2, reach = kContender * std::max(0.0, nominal.chi2 - best);
      each(fitter, "fitting to the end: ", 0.56 + 0.02 * lap, [&](std::size_t k) {
        const double gap = fits[k].chi2 - best;
        if (out.contains(fits[k].Name()) || (k > 0 && gap > reach)) return false;
        const double before = fits[k].chi2;
        fits[k] = fitter.Polish(std::move(fits[k]), k == 0 ? 3 : 1);
        if (fits[k].settled || before - fits[k].chi2 < kStride * std::max(gap, 1.0)) out.insert(fits[k].Name());
        return true;
      });
      if (fits.empty()) return;
      if (out.size() == fits.size() || std::all_of(fits.begin(), fits.end(), [&](const Fit& fit) {
            return out.contains(fit.Name()) || fit.chi2 - fits.front().chi2 > reach;
          }))
        break;
    }
    {
      const Fitter fitter(*study_, WhitenerOf(fits.front()));
      for (Fit& fit : fits) fitter.Weigh(fit);
      order();
      each(fitter, "fitting with the noise's colour: ", 0.68, [&](std::size_t k) {
        if (k >= kPolished || (k > 0 && fits[k].chi2 > kBeaten * fits.front().chi2)) return false;
        fits[k] = fitter.Polish(std::move(fits[k]), k == 0 ? 3 : 2);
        return true;
      });
      if (fits.empty()) return;
    }
    const Fitter fitter(*study_, WhitenerOf(fits.front()));
    // The nominal model gets every chance: also from where the doubts stand beside the best effect.
    Fit other = null;
    other.hypothesis.z = fits.front().hypothesis.z;
    for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
      if (const std::optional<double> z = AsDoubt(fits.front(), i)) other.hypothesis.z[i] = *z;
    }
    null = fitter.Polish(std::move(null), 3);
    other = fitter.Polish(std::move(other), 4);
    if (other.ok() && other.chi2 < null.chi2) null = std::move(other);
    for (Fit& fit : fits) fitter.Weigh(fit);
    order();
  }

  /// A second effect that moves a nominal value by no more than its doubt is no effect: the doubts had not found their
  /// place yet. The first effect alone, with the doubt moved there.
  std::optional<Fit> FoldBack(const Fit& pair) {
    constexpr double kWithinDoubt = 3.5;
    for (std::size_t e = 0; e < pair.hypothesis.effects.size(); ++e) {
      const Assumed& moved = pair.hypothesis.effects[e];
      for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
        const Doubt& doubt = study_->doubts()[i];
        if (doubt.effect != moved.effect->info().name || doubt.at != moved.place.ToString()) continue;
        const double z = moved.parameters.front() / doubt.spread;
        if (std::abs(z) > kWithinDoubt) continue;
        Hypothesis at = pair.hypothesis;
        at.effects.erase(at.effects.begin() + static_cast<std::ptrdiff_t>(e));
        at.z[i] = z;
        const Result<DoubtModel> doubts = LineariseDoubts(*study_, at, FreedomOf(*study_, at.effects));
        const Result<Eigen::VectorXd> predicted = study_->Predict(at);
        if (!doubts.ok() || !predicted.ok()) continue;
        Fit fit;
        fit.hypothesis = at;
        fit.doubts = *doubts;
        fit.predicted = *predicted;
        for (const int order : {0, Whitener::kOrder})
          fit = Fitter(*study_, WhitenerOf(fit, order)).Polish(std::move(fit), 5);
        return fit;
      }
    }
    return std::nullopt;
  }

  /// Carries a hypothesis to the full records over shorter ones. A sharp resonance that is off by more than its width
  /// loses the phase within a second: over a short part the way to its true place is still downhill.
  Fit Warm(const Fit& cold) {
    Hypothesis at = cold.hypothesis;
    for (const Study* study : {&tiny_, &short_, study_}) {
      const Result<DoubtModel> doubts = LineariseDoubts(*study, at, FreedomOf(*study, at.effects));
      const Result<Eigen::VectorXd> predicted = study->Predict(at);
      if (!doubts.ok() || !predicted.ok()) return cold;
      Fit fit;
      fit.hypothesis = at;
      fit.doubts = *doubts;
      fit.predicted = *predicted;
      const Fitter fitter(*study, Whitener(study->channels(), study->measured() - *predicted, 0));
      fit = fitter.Polish(std::move(fit), 2);
      simulations_ += fit.simulations;
      if (!fit.ok()) return cold;
      if (study == study_) return fit;
      at = fit.hypothesis;
    }
    return cold;
  }

  /// An effect of the fit that moves this doubt's own number, in spreads of the doubt.
  std::optional<double> AsDoubt(const Fit& fit, std::size_t doubt) const {
    const Doubt& one = study_->doubts()[doubt];
    for (const Assumed& assumed : fit.hypothesis.effects) {
      if (one.effect == assumed.effect->info().name && one.at == assumed.place.ToString())
        return assumed.parameters.front() / one.spread;
    }
    return std::nullopt;
  }

  void TryPairs(std::vector<Fit>& fits, Fit& null, const Fit& best, std::vector<Structure>& structure) {
    const Fitter fitter(*study_, WhitenerOf(best));
    Fit base = best;
    fitter.Weigh(base);
    base.doubts.z0 = base.hypothesis.z;  // candidates are added at the optimum
    std::vector<Fit> pairs = FitBest(fitter, base, "two effects", 0.7, 0.95);
    if (pairs.size() > 3) pairs.resize(3);
    if (pairs.empty()) return;
    SortAgain(pairs, null);
    if (pairs.empty()) return;
    if (const std::optional<Fit> alone = FoldBack(pairs.front())) {
      fits = {*alone};
      structure = StructureOf(*alone);
      return;
    }
    // A second effect has to explain what the first one leaves, all of it: else nothing is known about either.
    std::vector<Structure> left = StructureOf(pairs.front());
    const Fitter last(*study_, WhitenerOf(pairs.front()));
    Fit alone = last.Polish(best, 6);
    last.Weigh(pairs.front());
    if (Above(left) || alone.criterion - pairs.front().criterion < threshold_) {
      partial_ = "no pair of effects accounts for the rest either";
      return;
    }
    single_ = std::move(fits);
    fits = std::move(pairs);
    structure = std::move(left);
  }

  /// Fits that stood on the part go on to all training data: the nominal model, and whatever is not far behind the
  /// best.
  Status ToTheWhole(Fit& null, std::vector<Fit>& fits, std::vector<Structure>& structure) {
    const Fitter last(*study_, fits.empty() ? WhitenerOf(null) : WhitenerOf(fits.front()));
    for (Fit& fit : fits) last.Weigh(fit);
    const double best = fits.empty() ? 0.0 : fits.front().criterion, rows = last.whitener().rows();
    for (std::size_t k = 0; k < fits.size(); ++k) {
      if (k == 0 || (k < kCarried && fits[k].criterion - best < 0.5 * rows)) continue;
      const Assumed& assumed = fits[k].hypothesis.effects.back();
      result_.considered.push_back(
          {assumed.effect->info().name, assumed.place.ToString(),
           fmt::format("explains less of the first part of the data: -2 log evidence {:.0f} behind",
                       fits[k].criterion - best),
           TotalNrmse(fits[k].predicted)});
    }
    const auto drop = [&, k = std::size_t{0}](const Fit& fit) mutable {
      const std::size_t place = k++;
      return place > 0 && (place >= kCarried || fit.criterion - best >= 0.5 * rows);
    };
    std::erase_if(fits, drop);
    study_ = &whole_;
    const Result<Eigen::VectorXd> nominal = study_->Predict(study_->Nominal());
    if (!nominal.ok()) return nominal.failure();
    nominal_prediction_ = *nominal;
    const auto carry = [&](Fit& fit, const Fit* leader) {
      Step("all training data: " + fit.Name(), 0.95);
      const Hypothesis at = fit.hypothesis;
      const Result<DoubtModel> doubts = LineariseDoubts(*study_, at, FreedomOf(*study_, at.effects));
      const Result<Eigen::VectorXd> predicted = study_->Predict(at);
      if (!doubts.ok() || !predicted.ok()) {
        fit.broken = "cannot be simulated over all training data";
        return;
      }
      fit.doubts = *doubts;
      fit.predicted = *predicted;
      for (const int order : {0, Whitener::kOrder})
        fit = Fitter(*study_, WhitenerOf(leader != nullptr ? *leader : fit, order)).Polish(std::move(fit), 3);
    };
    for (std::size_t k = 0; k < fits.size(); ++k) carry(fits[k], k > 0 && fits[0].ok() ? &fits[0] : nullptr);
    std::erase_if(fits, [](const Fit& fit) { return !fit.ok(); });
    carry(null, fits.empty() ? nullptr : &fits.front());
    if (!null.ok()) return Failure{null.broken, study_->plan().id};
    const Fitter fitter(*study_, WhitenerOf(fits.empty() ? null : fits.front()));
    for (Fit& fit : fits) fitter.Weigh(fit);
    std::stable_sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.criterion < b.criterion; });
    threshold_ = Threshold(fitter.whitener().rows(), candidates_.size());
    structure = StructureOf(fits.empty() ? null : fits.front());
    return {};
  }

  void Judge(Fit& null, std::vector<Fit>& fits, const std::vector<Structure>& structure) {
    const Fitter fitter(*study_, fits.empty() ? WhitenerOf(null) : WhitenerOf(fits.front()));
    fitter.Weigh(null);
    fitter.Derive(null);
    const std::vector<double> null_blocks = CrossValidate(*study_, fitter, null);
    const double rows = fitter.whitener().rows();
    std::vector<Fit> standing;
    for (Fit& fit : fits) {
      fitter.Weigh(fit);
      fitter.Derive(fit);
      simulations_ += fit.parameters() + 1;
      const std::vector<double> blocks = CrossValidate(*study_, fitter, fit);
      const Standing s = Compare(*study_, null, null_blocks, fit, blocks, rows, candidates_.size());
      Considered& considered = result_.considered.emplace_back();
      const Assumed& last = fit.hypothesis.effects.back();
      considered.name = last.effect->info().name;
      considered.at = last.place.ToString();
      if (fit.hypothesis.effects.size() > 1)
        considered.name = fit.hypothesis.effects.front().ToString() + " + " + considered.name;
      considered.validation_nrmse = TotalNrmse(fit.predicted) * std::sqrt(s.validation_chi2 / std::max(1.0, fit.chi2));
      considered.why_not = WhyNot(s, fit, fits.front());
      bool within = false;  // a change no larger than the doubt about its number is none
      bool beyond = false;  // and one that the nominal model cannot do without either, far outside the doubt, is one
      for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
        const std::optional<double> z = AsDoubt(fit, i);
        if (!z) continue;
        within = within || std::abs(*z) < 3.5;
        const double without = null.hypothesis.z[i];
        beyond = beyond || (std::min(std::abs(*z), std::abs(without)) > kBeyondDoubt && *z * without > 0.0 &&
                            s.chi2_gain > 0.5 * without * without);
      }
      if (within) considered.why_not = "changes a nominal value by no more than the doubt about it";
      if (beyond) considered.why_not = WhyNot({.significant = true}, fit, fits.front());
      if ((s.significant || beyond) && !within) standing.push_back(fit);
    }
    fits = std::move(standing);
    const bool rest = Above(structure);
    for (std::size_t c = 0; c < structure.size(); ++c)
      result_.p_value = std::min({result_.p_value, structure[c].p_value, structure[c].line_p_value});
    result_.white =
        std::all_of(structure.begin(), structure.end(), [](const Structure& s) { return s.p_value > 1e-3; });
    result_.at_noise_floor = !rest;
    const std::vector<std::string> strained = StrainedDoubts(null);
    if (fits.empty()) {
      const bool agrees = !rest && strained.empty();
      result_.verdict = agrees ? Verdict::kNoEffect : Verdict::kUnexplained;
      result_.reason =
          agrees ? "the data agree with the model within the doubt about its nominal values"
          : rest ? "the residual follows the inputs or has a line, and no candidate accounts for it"
                 : fmt::format("the data agree with the model only where {} lies far outside the doubt about it",
                               fmt::join(strained, ", "));
      return;
    }
    alike_ = AmbiguitySet(fits, threshold_);
    if (DataChi2(null) - DataChi2(fits.front()) < threshold_) also_ = strained;
    if (rest) {
      result_.verdict = Verdict::kUnexplained;
      result_.reason = fmt::format("the best candidate, {}, leaves structure in the residual{}{}", fits.front().Name(),
                                   partial_.empty() ? "" : "; ", partial_);
    } else if (const std::size_t count = alike_.size() + also_.size(); count > 3) {
      result_.verdict = Verdict::kUnexplained;
      result_.reason = fmt::format("{} candidates account for the data alike", count);
    } else {
      result_.verdict = count > 1 ? Verdict::kAmbiguous : Verdict::kEffectFound;
      result_.reason = count > 1 ? "these data cannot tell the candidates apart"
                                 : "the residual is at the noise floor with it, and with nothing else";
    }
  }

  /// Nominal values that no effect stands for, which the nominal model needs far outside the doubt about them.
  std::vector<std::string> StrainedDoubts(const Fit& null) const {
    constexpr double kFar = 3.5;
    std::vector<std::string> strained;
    for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
      const Doubt& doubt = study_->doubts()[i];
      if (!doubt.start && doubt.effect.empty() && std::abs(null.hypothesis.z[i]) > kFar)
        strained.push_back("nominal_value@" + doubt.path);
    }
    return strained;
  }

  /// Without what the doubts cost.
  double DataChi2(const Fit& fit) const {
    double chi2 = fit.chi2;
    for (const int i : fit.doubts.free) {
      const auto k = static_cast<std::size_t>(i);
      chi2 -= std::pow(fit.hypothesis.z[k] / fit.doubts.freedom[k], 2);
    }
    return chi2;
  }

  std::string WhyNot(const Standing& s, const Fit& fit, const Fit& best) const {
    if (!s.significant)
      return fmt::format("gains too little over the nominal values alone (chi2 {:.0f}, {} of {} validation parts)",
                         s.chi2_gain, s.blocks_better, kBlocks);
    const double behind = fit.criterion - best.criterion;
    if (behind <= 0.0) return "";
    if (behind <= 10.0) return fmt::format("as good as the best within {:.1f} (-2 log evidence)", behind);
    if (fit.chi2 <= best.chi2 + 10.0)
      return fmt::format("no better than the best with more parameters (-2 log evidence {:.0f} behind)", behind);
    return fmt::format("explains less: -2 log evidence {:.0f} behind", behind);
  }

  /// RMS over the channels of the NRMSE.
  double TotalNrmse(const Eigen::VectorXd& predicted) const {
    double sum = 0.0;
    for (const Channel& c : study_->channels()) {
      const double ms = (study_->measured() - predicted).segment(c.begin, c.count).squaredNorm() /
                        static_cast<double>(std::max<Eigen::Index>(1, c.count));
      sum += ms / std::max(c.spread * c.spread, 1e-300);
    }
    return std::sqrt(sum / static_cast<double>(study_->channels().size()));
  }

  Status Conclude(Fit& null, std::vector<Fit>& fits) {
    const bool known = result_.verdict != Verdict::kNoEffect && !fits.empty();
    const Fit& best = known ? fits.front() : null;
    NoiseFloor(best);
    result_.where = FindWhere(*study_, study_->measured() - nominal_prediction_, floor_);
    for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
      if (best.hypothesis.z[i] == 0.0) continue;
      const DoubtValue value = ValueOf(study_->doubts()[i], best.hypothesis.z[i], study_->plan());
      result_.refitted.push_back(
          {study_->doubts()[i].path, value.nominal, value.value, best.hypothesis.z[i], study_->doubts()[i].start});
    }
    if (known) ReportEffects(fits);
    if (Status failed = MeasureGain(best)) return failed;
    if (result_.verdict == Verdict::kNoEffect) {
      for (const Screened& one : screened_) {
        const Candidate& candidate = candidates_[one.candidate];
        if (candidate.strengths.empty() || !std::isfinite(one.smallest)) continue;
        result_.would_have_seen.push_back({candidate.effect->info().name, candidate.place.ToString(),
                                           candidate.effect->info().parameters[candidate.strengths[0]].unit,
                                           one.smallest});
      }
    }
    if (!known) return {};
    const Result<std::string> file = WriteExtended(*study_, best, result_, options_);
    if (!file.ok()) return file.failure();
    result_.extended_scenario = *file;
    return {};
  }

  void ReportEffects(const std::vector<Fit>& fits) {
    const Fit& best = fits.front();
    double evidence = 0.0;
    for (const Fit& fit : fits) evidence += std::exp(-0.5 * (fit.criterion - best.criterion));
    Eigen::Index k = 0;
    for (const Assumed& assumed : best.hypothesis.effects) {
      FoundEffect& found = result_.effects.emplace_back();
      found.name = assumed.effect->info().name;
      found.at = assumed.place.ToString();
      found.confidence = result_.verdict == Verdict::kUnexplained ? 0.0 : std::min(0.999, 1.0 / evidence);
      for (std::size_t i = 0; i < assumed.parameters.size(); ++i, ++k) {
        const EffectParameter& p = assumed.effect->info().parameters[i];
        const double half = 1.959964 * std::sqrt(std::max(0.0, best.covariance(k, k)));
        found.parameters.push_back({p.name, p.unit, assumed.parameters[i],
                                    std::max(p.lower, assumed.parameters[i] - half),
                                    std::min(p.upper, assumed.parameters[i] + half)});
      }
    }
    if (result_.verdict == Verdict::kEffectFound || alike_.size() + also_.size() < 2) return;
    std::vector<std::string> names;
    std::vector<Assumed> alike;
    for (const std::size_t i : alike_) {
      names.push_back(fits[i].Name());
      alike.push_back(fits[i].hypothesis.effects.back());
    }
    names.insert(names.end(), also_.begin(), also_.end());
    result_.ambiguous_with.push_back(names);
    result_.experiment_text = SeparatingText(*study_, alike);
    const Result<std::string> file = WriteSeparating(*study_, alike, options_);
    if (file.ok()) result_.experiment_scenario = *file;
  }

  /// The floor by channel: white noise as the highest frequencies show it, or, where the noise has a colour of its own
  /// and nothing but noise is left, the residual itself.
  void NoiseFloor(const Fit& best) {
    const Eigen::VectorXd residual = study_->measured() - best.predicted;
    double sum = 0.0;
    for (const Channel& c : study_->channels()) {
      const auto rows = residual.segment(c.begin, c.count);
      const double rms = std::sqrt(rows.squaredNorm() / static_cast<double>(c.count));
      const double white = HighFrequencyFloor(rows);
      const double floor = result_.at_noise_floor ? rms : std::min(white, rms);
      floor_.push_back(std::max(floor, 1e-9 * std::max(c.spread, c.nominal)));
      result_.floor_by_signal[c.name] = floor_.back();
      result_.residual_by_signal[c.name] = rms;
      sum += floor_.back() * floor_.back() / std::max(c.spread * c.spread, 1e-300);
    }
    result_.noise_floor = std::sqrt(sum / static_cast<double>(study_->channels().size()));
  }

  /// Opened once, after the choice.
  Status MeasureGain(const Fit& best) {
    Step("hold-out", 0.97);
    const auto gains = [&](const Study& study, const Eigen::VectorXd& before, const Eigen::VectorXd& after,
                           double from_share) {
      std::map<std::string, SignalGain> all;
      for (const Channel& c : study.channels()) {
        const auto first = static_cast<Eigen::Index>(from_share * static_cast<double>(c.count));
        const Eigen::Index count = c.count - first;
        if (count < 10) continue;
        const auto y = study.measured().segment(c.begin + first, count);
        const double spread = std::max(std::sqrt((y.array() - y.mean()).square().mean()), 1e-12 * c.nominal);
        const Eigen::ArrayXd b = (y - before.segment(c.begin + first, count)).array().square();
        const Eigen::ArrayXd a = (y - after.segment(c.begin + first, count)).array().square();
        SignalGain gain{std::sqrt(b.mean()) / spread, std::sqrt(a.mean()) / spread, 0.0, 0.0};
        Bootstrap(b, a, spread, gain);
        all[c.name] = gain;  // of several records the last one
      }
      return all;
    };
    // Before: the scenario as written, but from the record's own start.
    Hypothesis plain = study_->Nominal(), start = study_->Nominal();
    for (std::size_t i = 0; i < plain.z.size(); ++i) {
      if (study_->doubts()[i].start) start.z[i] = best.hypothesis.z[i];
    }
    const Result<Eigen::VectorXd> before = study_->Predict(start), after = study_->Predict(best.hypothesis);
    if (!before.ok()) return before.failure();
    if (!after.ok()) return after.failure();
    result_.train = gains(*study_, *before, *after, 0.0);
    const Study full(study_->plan(), result_.own_holdout ? holdout_ : data_, study_->registry());
    Hypothesis chosen = best.hypothesis;
    if (result_.own_holdout) {
      for (std::size_t i = 0; i < chosen.z.size(); ++i) {
        if (study_->doubts()[i].start) chosen.z[i] = start.z[i] = 0.0;
      }
    }
    const Result<Eigen::VectorXd> b = full.Predict(start), a = full.Predict(chosen);
    if (!b.ok()) return b.failure();
    if (!a.ok()) return a.failure();
    simulations_ += 4;
    result_.holdout = gains(full, *b, *a, result_.own_holdout ? 0.0 : kTrainingShare);
    double sum_before = 0.0, sum_after = 0.0;
    for (const auto& [name, gain] : result_.holdout) {
      sum_before += gain.before * gain.before;
      sum_after += gain.after * gain.after;
    }
    if ((result_.verdict == Verdict::kEffectFound || result_.verdict == Verdict::kAmbiguous) &&
        sum_after >= sum_before) {
      result_.verdict = Verdict::kUnexplained;
      result_.reason = "what gains on the training data does not gain on the hold-out";
    }
    return {};
  }

  /// Blocks of the squares are drawn anew 1000 times: residuals are correlated within a block, hardly across.
  static void Bootstrap(const Eigen::ArrayXd& before, const Eigen::ArrayXd& after, double spread, SignalGain& gain) {
    const Eigen::Index blocks = std::min<Eigen::Index>(40, before.size() / 5);
    if (blocks < 2) return;
    std::vector<std::pair<double, double>> sums(static_cast<std::size_t>(blocks));
    const Eigen::Index length = before.size() / blocks;
    for (Eigen::Index i = 0; i < blocks; ++i)
      sums[static_cast<std::size_t>(i)] = {before.segment(i * length, length).mean(),
                                           after.segment(i * length, length).mean()};
    std::vector<double> drawn;
    for (std::uint64_t draw = 0; draw < 1000; ++draw) {
      double b = 0.0, a = 0.0;
      for (std::uint64_t i = 0; i < sums.size(); ++i) {
        const auto& one = sums[RandomBits(1, draw, i) % sums.size()];
        b += one.first;
        a += one.second;
      }
      const auto n = static_cast<double>(sums.size());
      drawn.push_back((std::sqrt(b / n) - std::sqrt(a / n)) / spread);
    }
    std::sort(drawn.begin(), drawn.end());
    gain.lower = drawn[25];
    gain.upper = drawn[974];
  }

  const Study& whole_;               // all that is for training
  const std::optional<Study> part_;  // its first part, where the search takes place when the records are long
  const Study* study_;               // where the fits stand now: the part, then the whole
  const Study short_, tiny_;
  double short_base_chi2_ = 0.0, short_threshold_ = 0.0;
  const std::vector<MappedRecord>& data_;
  const std::vector<MappedRecord>& holdout_;
  const DiagnoseOptions& options_;
  SavedFits saved_;
  Diagnosis result_;
  std::vector<Candidate> candidates_;
  std::vector<Screened> screened_;
  std::vector<Fit> single_;
  std::vector<std::size_t> alike_;
  std::vector<std::string> also_;  // nominal values that account for the data alike
  std::vector<double> floor_;
  Eigen::VectorXd nominal_prediction_;
  std::string partial_;
  double threshold_ = 0.0;
  int simulations_ = 0;
};

}  // namespace

std::string ToString(Verdict verdict) {
  switch (verdict) {
    case Verdict::kEffectFound:
      return "effect_found";
    case Verdict::kNoEffect:
      return "no_effect";
    case Verdict::kAmbiguous:
      return "ambiguous";
    case Verdict::kUnexplained:
      break;
  }
  return "unexplained";
}

Result<Diagnosis> Diagnose(const Plan& plan, const std::vector<MappedRecord>& data,
                           const std::vector<MappedRecord>& holdout, const Registry& registry,
                           const DiagnoseOptions& options) {
  const Study study(plan, data, registry, holdout.empty() ? kTrainingShare : 1.0);
  return Diagnosing(study, data, holdout, options).Run();
}

}  // namespace dynoproof::diagnosis
