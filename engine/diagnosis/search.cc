#include "diagnosis/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/contest.h"
#include "diagnosis/decide.h"
#include "diagnosis/follow_friction.h"
#include "diagnosis/gain.h"
#include "diagnosis/resume.h"
#include "diagnosis/shake.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kSearchRows = 2e4;  // a channel: where the search takes place, 2 s of a drive line
constexpr std::size_t kCarried = 4;  // fits that go on from there to all training data; an ambiguity set holds three
constexpr double kScreeningTime_s = 1.2;  // of a record: some 500 periods of a drive line's first mode
constexpr std::size_t kFullFits = 8;      // candidates that are fitted fully after the screening
constexpr int kShakes = 12;               // of a fit with dry friction
constexpr double kRough = 500.0;          // -2 log evidence that such a fit may lack where it came to rest

bool Rubs(const Fit& fit) {
  return fit.ok() && !fit.hypothesis.effects.empty() &&
         fit.hypothesis.effects.back().effect->info().traits.dry_friction;
}

bool Same(const Assumed& a, const Assumed& b) { return a.SameCause(b) && a.parameters == b.parameters; }

class Searching {
 public:
  Searching(const Study& study, const std::vector<MappedRecord>& data, double training_share,
            const SearchOptions& options)
      : whole_(study),
        // Suspects were followed as the plan has it: where motion is chaotic, coarser steps lead elsewhere.
        part_(study.Part(PartShare(study), options.suspects.empty() ? Rough(study.plan()) : study.plan())),
        study_(&part_),
        short_(Rough(study.plan()), data, study.registry(), ShortShare(data, training_share), study.decompositions()),
        options_(options),
        saved_(options.saved_fits, options.resume, study),
        contest_(part_, saved_, options.progress) {}

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
      Fit warm = contest_.Warm(null, fitter);
      null = fitter.Polish(std::move(null), 3);
      KeepBetter(null, std::move(warm));
    }

    found_.candidates = CandidatesFor(*study_, MagnitudesOf(*study_));
    found_.threshold = Threshold(whitener.rows(), found_.candidates.size());
    std::vector<Fit> fits = FitBest(Fitter(*study_, whitener), base, "one effect", 0.05, 0.5);
    std::vector<Structure> structure;
    const bool lost = fits.empty() && AnyFound(StructureOf(null));
    const bool slips = options_.suspects.empty() && (lost || (!fits.empty() && Rubs(fits.front())));
    if (slips) {
      const Result<bool> explained = FromTheBeginning(std::nullopt, fits, null, structure);
      if (!explained.ok()) return explained.failure();
      if (*explained) return Complete(std::move(null), std::move(fits), std::move(structure));
    }
    if (lost) {
      // Nobody was seen beside a line that rings at the wrong frequencies: once more beside the one that was fitted.
      Fit fitted = null;
      fitted.doubts.z0 = fitted.hypothesis.z;
      fits = FitBest(Fitter(*study_, WhitenerOf(*study_, fitted)), fitted, "one effect beside fitted nominal values",
                     0.5, 0.6);
    }
    for (const Hypothesis& suspect : options_.suspects) {
      fits.push_back(FitAt(*study_, suspect));
      if (fits.back().ok()) Fitter(*study_, whitener).Weigh(fits.back());
    }
    std::erase_if(fits, [](const Fit& fit) { return !fit.ok(); });
    BestFirst(fits);
    contest_.Suggest(Fitter(*study_, whitener), null, fits);
    contest_.Decide(EntrantsOf(screened_), fits, null);
    // By now the nominal model has come to the end of its doubts too, and may say what nobody else has.
    if (!fits.empty() && contest_.Suggest(Fitter(*study_, WhitenerOf(*study_, fits.front())), null, fits))
      contest_.Decide(EntrantsOf(screened_), fits, null);
    Fit rough = fits.empty() ? null : fits.front();
    if (Status failed = ToTheWhole(null, fits, structure)) return *failed;
    if (!slips && options_.suspects.empty()) {
      const Assumed* best = fits.empty() ? nullptr : &fits.front().hypothesis.effects.back();
      const bool rest = AnyFound(structure);
      if (rest || (best != nullptr && best->effect->info().traits.speed_dependent)) {
        const Result<bool> explained =
            FromTheBeginning(rest ? std::nullopt : std::optional(best->place), fits, null, structure);
        if (!explained.ok()) return explained.failure();
      }
    }
    if (AnyFound(structure)) {
      // Before an effect is called for, or a second one, the machine gets the time it needs.
      Fit& best = fits.empty() ? null : fits.front();
      best = ToTheEnd(std::move(best), 8);
      if (AnyFound(StructureOf(best)) && !Rubs(best)) {
        best = InStep(std::move(best));
        const std::optional<Hypothesis> found =
            AnyFound(StructureOf(best)) ? contest_.FromAnyStart(StartsBeside(fits)) : std::optional(best.hypothesis);
        if (found && !found->effects.empty()) {
          if (Status failed = AskAgain(*found, null, fits)) return *failed;
        }
      }
      const Fitter fitter(*study_, WhitenerOf(*study_, fits.empty() ? null : fits.front()));
      fitter.Weigh(null);
      Sort(fitter, fits);
      structure = StructureOf(fits.empty() ? null : fits.front());
    }
    if (!fits.empty() && AnyFound(structure)) {
      if (Status failed = TryPairs(fits, null, rough, structure)) return *failed;
    }
    return Complete(std::move(null), std::move(fits), std::move(structure));
  }

 private:
  Found Complete(Fit null, std::vector<Fit> fits, std::vector<Structure> structure) {
    found_.null = std::move(null);
    found_.fits = std::move(fits);
    found_.structure = std::move(structure);
    found_.simulations = simulations_ + contest_.simulations();
    return std::move(found_);
  }

  /// One substep a sample: what a nonlinear law costs falls by four, and a search does not need the last digits.
  static Plan Rough(Plan plan) {
    SetSubsteps(plan, 1);
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
    const std::string stage = what + ": " + base.Name();
    screened_ = saved_.Screening(stage);
    if (screened_.empty()) {
      screened_ = ScreenShort(base, what, begin, begin + 0.7 * (end - begin));
      saved_.KeepScreening(stage, screened_);
    }
    for (const Screened& one : screened_) simulations_ += one.simulations;
    if (base.hypothesis.effects.empty()) found_.screened = screened_;
    std::vector<Fit> fits;
    const std::vector<Assumed> entrants = EntrantsOf(screened_);
    const std::size_t most = std::min(entrants.size(), kFullFits + ByPower(screened_).size());
    std::size_t fitted = 0;
    for (std::size_t k = 0; k < entrants.size() && fitted < most; ++k) {
      std::vector<Assumed> effects = base.hypothesis.effects;
      if (std::any_of(effects.begin(), effects.end(),
                      [&](const Assumed& assumed) { return assumed.SameCause(entrants[k]); }))
        continue;
      effects.push_back(entrants[k]);
      Step("fitting " + entrants[k].ToString(),
           begin + (end - begin) * (0.7 + 0.3 * static_cast<double>(fitted) / static_cast<double>(most)));
      // Its own size first, beside doubts that follow linearly: the screening saw it at a small one.
      if (!saved_.Recall(effects)) {
        const Fit sized = fitter.Optimise(effects, base.doubts, 8);
        simulations_ += sized.simulations;
        if (sized.ok()) effects = sized.hypothesis.effects;
      }
      Fit fit = FitAt(*study_, {base.doubts.z0, effects});
      ++simulations_;
      if (!fit.ok()) continue;
      ++fitted;
      fitter.Weigh(fit);
      TakeUp(fits, std::move(fit));
    }
    BestFirst(fits);
    return fits;
  }

  /// Who explains most of the residual's power at once, the best two. By the noise's colour they may look like nothing:
  /// that is taken from the residual, which is the effect itself until somebody explains it.
  std::vector<Assumed> ByPower(std::vector<Screened> screened) const {
    constexpr double kExplains = 0.25;  // of the power is left
    std::erase_if(screened, [](const Screened& one) { return !(one.left < kExplains); });
    std::stable_sort(screened.begin(), screened.end(),
                     [](const Screened& a, const Screened& b) { return a.left < b.left; });
    std::vector<Assumed> best;
    for (std::size_t k = 0; k < std::min<std::size_t>(2, screened.size()); ++k)
      best.push_back(found_.candidates[screened[k].candidate].At(screened[k].closest));
    return best;
  }

  /// These and the promising ones, at the sizes that the screening saw.
  std::vector<Assumed> EntrantsOf(const std::vector<Screened>& screened) const {
    std::vector<Assumed> entrants = ByPower(screened);
    for (const Screened& one : screened) {
      if (!one.promising) break;
      const Assumed next = found_.candidates[one.candidate].At(one.parameters);
      if (std::none_of(entrants.begin(), entrants.end(), [&](const Assumed& other) { return Same(next, other); }))
        entrants.push_back(next);
    }
    return entrants;
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

  /// By its own noise, first as if that were white, then with its colour.
  Fit ToTheEnd(Fit fit, int rounds) const {
    for (const int order : {0, Whitener::kOrder})
      fit = Fitter(*study_, WhitenerOf(*study_, fit, order)).Polish(std::move(fit), rounds);
    return fit;
  }

  static Hypothesis Without(Hypothesis hypothesis, std::size_t effect) {
    hypothesis.effects.erase(hypothesis.effects.begin() + static_cast<std::ptrdiff_t>(effect));
    return hypothesis;
  }

  /// The one effect of a pair whose other is none: it moves a nominal value by no more than its doubt, which had not
  /// found its place yet, or has no size that can be told from nothing.
  std::optional<Fit> FoldBack(const Fit& pair) {
    Fit derived = pair;
    Fitter(*study_, WhitenerOf(*study_, pair)).Derive(derived);
    for (std::size_t e = 0; e < pair.hypothesis.effects.size(); ++e) {
      const Assumed& second = pair.hypothesis.effects[e];
      bool none = IsNothing(*study_, derived, e);
      Hypothesis at = Without(pair.hypothesis, e);
      for (std::size_t i = 0; i < study_->doubts().size(); ++i) {
        const Doubt& doubt = study_->doubts()[i];
        if (!Changes(second, doubt)) continue;
        at.z[i] = DeviateOf(doubt, second.parameters.front());
        none = none || std::abs(at.z[i]) <= kWithinDoubt;
      }
      if (!none) continue;
      Fit fit = FitAt(*study_, std::move(at));
      if (!fit.ok()) continue;
      return ToTheEnd(std::move(fit), 5);
    }
    return std::nullopt;
  }

  /// A mode that is hardly seen may have lost step by a whole turn: it leaves a line in the spectrum, and no slope
  /// leads back. Once more from the nominal values, over parts that grow little by little.
  Fit InStep(Fit fit) {
    Step("from a short part: " + fit.Name(), 0.96);
    const Fit cold = FitAt(part_, fit.hypothesis);
    if (!cold.ok()) return fit;
    Fit anew = FitAt(*study_, contest_.Grown(cold, Fitter(part_, WhitenerOf(part_, cold, 0))).hypothesis);
    ++simulations_;
    if (anew.ok()) anew = ToItsPlace(*study_, std::move(anew));
    if (!anew.ok()) return fit;
    const Fitter fitter(*study_, WhitenerOf(*study_, fit));
    fitter.Weigh(fit);
    fitter.Weigh(anew);
    KeepBetter(fit, std::move(anew));
    return fit;
  }

  /// Decides anew where the search takes place, with one hypothesis to begin with, and goes on to all training data.
  /// No fits: a run broke.
  Status DecideAnew(const Hypothesis& from, std::vector<Fit>& fits, Fit& nominal, std::vector<Structure>& structure) {
    study_ = &part_;
    fits = {FitAt(*study_, from)};
    nominal = FitAt(*study_, nominal.hypothesis);
    if (!fits.front().ok() || !nominal.ok()) {
      fits.clear();
      study_ = &whole_;
      return {};
    }
    contest_.Decide(EntrantsOf(found_.screened), fits, nominal);
    return ToTheWhole(nominal, fits, structure);
  }

  /// Where nobody explains the data: all that moves modes, and whatever else can be wrong where the best fit (the
  /// first) sees something, at all sizes that a search starts from. The screening has seen one of them, beside modes
  /// that were out of step.
  std::vector<Assumed> StartsBeside(const std::vector<Fit>& fits) const {
    const Assumed* best = fits.empty() ? nullptr : &fits.front().hypothesis.effects.back();
    std::vector<Assumed> starts;
    for (const Candidate& candidate : found_.candidates) {
      const bool here = best != nullptr && candidate.place == best->place && candidate.effect != best->effect;
      for (const std::vector<double>& start : candidate.starts) {
        Assumed assumed = candidate.At(start);
        if (ChangesStructure(assumed) || assumed.effect->info().traits.dry_friction) break;
        const bool moves = std::any_of(study_->doubts().begin(), study_->doubts().end(),
                                       [&](const Doubt& doubt) { return Changes(assumed, doubt); });
        if (here || moves) starts.push_back(std::move(assumed));
      }
    }
    return starts;
  }

  /// Somebody has come to the noise after all: whoever was beaten while nobody was there is asked again, beside the
  /// doubts as that one has them.
  Status AskAgain(const Hypothesis& found, Fit& null, std::vector<Fit>& fits) {
    std::vector<Fit> again;
    std::vector<Structure> left;
    Fit nominal = null;
    contest_.Recall(beaten_);
    if (Status failed = DecideAnew(found, again, nominal, left)) return failed;
    if (again.empty() || AnyFound(left)) return {};
    const Fitter last(*study_, WhitenerOf(*study_, again.front()));
    Sort(last, again);
    for (Fit& fit : fits) {
      last.Weigh(fit);
      TakeUp(again, std::move(fit));
    }
    fits = std::move(again);
    last.Weigh(null);
    last.Weigh(nominal);
    KeepBetter(null, std::move(nominal));
    return {};
  }

  /// Laws of the same place contain one another, and the way of friction is rough: once more beside the doubts as the
  /// best one (the first) has them.
  void AskAtItsPlace(std::vector<Fit>& fits) const {
    const Fitter fitter(*study_, WhitenerOf(*study_, fits.front()));
    for (std::size_t k = 1; k < fits.size(); ++k) {
      if (!fits[k].ok() || fits[k].hypothesis.effects.back().place != fits[0].hypothesis.effects.back().place) continue;
      Fit beside = FitAt(*study_, {fits[0].hypothesis.z, fits[k].hypothesis.effects});
      fitter.Weigh(fits[k]);
      if (beside.ok()) KeepBetter(fits[k], fitter.Polish(std::move(beside), 8));
      // What one law is ahead of a simpler one may be no more than where on its rough way it has come to rest.
      if (Rubs(fits[k]) && fits[k].parameters() < fits[0].parameters() &&
          fits[k].criterion - fits[0].criterion < kRough)
        fits[k] = Shaken(*study_, fitter, std::move(fits[k]), kShakes);
    }
  }

  /// The best of `single` and of either half of a pair alone, from where the pair stands; weighed by `fitter`.
  Fit OneOf(const Fit& pair, const Fitter& fitter, Fit single) const {
    for (std::size_t e = 0; e < pair.hypothesis.effects.size() && pair.hypothesis.effects.size() > 1; ++e) {
      Fit fit = FitAt(*study_, Without(pair.hypothesis, e));
      if (fit.ok()) fit = ToItsPlace(*study_, std::move(fit));
      if (!fit.ok()) continue;
      fitter.Weigh(fit);
      if (fit.criterion < single.criterion) single = std::move(fit);
    }
    return single;
  }

  /// Dry friction that sticks and slips is lost by a search over the whole record, and with one substep a sample: it is
  /// followed from the beginning (at `place`, or wherever), and has to stand against who was found so far. Whether the
  /// best of them explains the records; only then anything is changed.
  Result<bool> FromTheBeginning(const std::optional<Place>& place, std::vector<Fit>& fits, Fit& null,
                                std::vector<Structure>& structure) {
    const Study fine = whole_.Part(PartShare(whole_));
    const std::optional<Followed> followed = FollowFriction(
        fine, place, [&](double done) { Step("following friction from the beginning", 0.5 + 0.1 * done); });
    if (!followed || followed->share < 1.0) return false;
    Fit nominal = FitAt(fine, null.hypothesis);
    std::vector<Fit> rivals;
    const auto add = [&](const Hypothesis& hypothesis) {
      Fit fit = FitAt(fine, hypothesis);
      const auto known = [&](const Fit& other) { return other.Name() == fit.Name(); };
      if (fit.ok() && std::none_of(rivals.begin(), rivals.end(), known)) rivals.push_back(std::move(fit));
    };
    add(followed->hypothesis);
    for (const Hypothesis& other : followed->alike) add(other);
    add(AsCoulomb(fine, followed->hypothesis));
    for (const Fit& fit : fits) add(fit.hypothesis);
    if (!nominal.ok() || rivals.empty()) return false;
    Sort(Fitter(fine, WhitenerOf(fine, rivals.front())), rivals);
    Contest contest(fine, saved_, options_.progress);
    contest.Recall(beaten_);
    contest.Decide(EntrantsOf(found_.screened), rivals, nominal);
    simulations_ += contest.simulations();
    std::vector<Structure> left;
    const Study* before = std::exchange(study_, &fine);
    const std::vector<Considered> considered = found_.considered;
    if (Status failed = ToTheWhole(nominal, rivals, left)) return *failed;
    if (rivals.empty() || AnyFound(left)) {
      study_ = before;
      found_.considered = considered;
      return false;
    }
    fits = std::move(rivals);
    null = std::move(nominal);
    structure = std::move(left);
    return true;
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
    contest_.Decide(EntrantsOf(screened_), pairs, nominal);
    std::optional<Fit> alone = pairs.empty() ? std::nullopt : FoldBack(pairs.front());
    if (alone && alone->ok()) {
      // Who it left behind on its way has to be asked again, its own law at other places first.
      pairs = {std::move(*alone)};
      contest_.Decide(EntrantsOf(found_.screened), pairs, nominal);
    }
    std::vector<Structure> left;
    if (Status failed = ToTheWhole(nominal, pairs, left)) return failed;
    if (pairs.empty()) return {};
    const Fitter last(*study_, WhitenerOf(*study_, pairs.front()));
    last.Weigh(pairs.front());
    Fit best = OneOf(pairs.front(), last, last.Polish(fits.front(), 6));
    // A second effect has to be needed: what one does as well from where the pair has led it, it does alone - and has
    // to stand against the others alone. On the rough way of friction it does no worse than that.
    const bool pair = pairs.front().hypothesis.effects.size() > 1;
    const double needed = found_.threshold + (Rubs(best) ? kRough : 0.0);
    double gain = best.criterion - pairs.front().criterion;
    if (pair && !AnyFound(left) && gain < needed) {
      if (Status failed = DecideAnew(best.hypothesis, pairs, nominal, left)) return failed;
      if (pairs.empty()) return {};
      gain = 0.0;
    }
    // And it has to explain what the first one leaves, all of it: else nothing is known about either.
    if (AnyFound(left) || gain < (pairs.front().hypothesis.effects.size() > 1 ? needed : 0.0)) {
      found_.partial = "no pair of effects accounts for the rest either";
      return {};
    }
    fits = std::move(pairs);
    structure = std::move(left);
    last.Weigh(null);
    last.Weigh(nominal);
    KeepBetter(null, std::move(nominal));
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
      if (fit.hypothesis.effects.size() == 1) beaten_.push_back(fit.hypothesis.effects.front());
    }
    fits = std::move(carried);
    study_ = &whole_;
    const auto carry = [&](Fit& fit, const Fit* leader) {
      Step("all training data: " + fit.Name(), 0.95);
      fit = FitAt(*study_, std::move(fit.hypothesis));
      if (!fit.ok()) return;
      for (const int order : {0, Whitener::kOrder})
        fit = Fitter(*study_, WhitenerOf(*study_, leader != nullptr ? *leader : fit, order))
                  .Polish(std::move(fit), order > 0 ? 12 : 2);
    };
    for (std::size_t k = 0; k < fits.size(); ++k) carry(fits[k], k > 0 && fits[0].ok() ? &fits[0] : nullptr);
    if (!fits.empty() && fits[0].ok()) {
      fits[0] = ToItsPlace(*study_, std::move(fits[0]));
      if (Rubs(fits[0])) {
        const Fitter fitter(*study_, WhitenerOf(*study_, fits[0]));
        fits[0] = Shaken(*study_, fitter, std::move(fits[0]), kShakes);
      }
      AskAtItsPlace(fits);
    }
    std::erase_if(fits, [](const Fit& fit) { return !fit.ok(); });
    carry(null, fits.empty() ? nullptr : &fits.front());
    if (!null.ok()) return Failure{null.broken, study_->plan().id};
    const Fitter fitter(*study_, WhitenerOf(*study_, fits.empty() ? null : fits.front()));
    Sort(fitter, fits);
    found_.threshold = Threshold(fitter.whitener().rows(), found_.candidates.size());
    structure = StructureOf(fits.empty() ? null : fits.front());
    return {};
  }

  const Study& whole_;  // all that is for training
  const Study part_;    // where the search takes place: coarser, and its first part when the records are long
  const Study* study_;  // where the fits stand now: the part, then the whole
  const Study short_;   // where candidates are screened
  const SearchOptions& options_;
  SavedFits saved_;
  Contest contest_;
  Found found_;
  std::vector<Screened> screened_;  // on top of what stood then
  std::vector<Assumed> beaten_;     // alone, where the search takes place
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

Result<Found> Search(const Study& study, const std::vector<MappedRecord>& data, double training_share,
                     const SearchOptions& options) {
  return Searching(study, data, training_share, options).Run();
}

}  // namespace dynoproof::diagnosis
