#include "diagnosis/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/checkpoint.h"
#include "diagnosis/decide.h"
#include "diagnosis/follow_friction.h"
#include "diagnosis/gain.h"
#include "diagnosis/policy.h"
#include "diagnosis/selection.h"
#include "identification/random_restart.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kSearchRows = 2e4;  // a channel: where the search takes place, 2 s of a drive line
constexpr std::size_t kCarried = 4;  // fits that go on from there to all training data; an ambiguity set holds three
constexpr double kScreeningTime_s = 1.2;  // of a record: some 500 periods of a drive line's first mode
constexpr std::size_t kFullFits = 8;      // candidates that are fitted fully after the screening
constexpr int kRestarts = 12;             // of a fit with dry friction
constexpr double kRough = 500.0;          // -2 log evidence that such a fit may lack where it came to rest

bool Rubs(const Estimate& fit) {
  return fit.ok() && !fit.hypothesis.effects.empty() &&
         fit.hypothesis.effects.back().effect->info().traits.dry_friction;
}

bool Same(const EffectInstance& a, const EffectInstance& b) { return a.SameCause(b) && a.parameters == b.parameters; }

class Searching {
 public:
  Searching(const EstimationProblem& problem, const std::vector<MappedRecord>& data, double training_share,
            const SearchOptions& options)
      : whole_(problem),
        // Suspects were followed as the plan has it: where motion is chaotic, coarser steps lead elsewhere.
        part_(problem.Part(PartShare(problem), options.suspects.empty() ? Rough(problem.plan()) : problem.plan())),
        problem_(&part_),
        short_(Rough(problem.plan()), data, problem.registry(), ShortShare(data, training_share), problem.context()),
        options_(options),
        saved_(options.saved_fits, options.resume, problem),
        selection_(part_, saved_, options.progress) {}

  Result<Found> Run() {
    Step("nominal run", 0.0);
    const Result<NuisanceModel> nuisances =
        LineariseNuisances(*problem_, problem_->Nominal(), FreedomOf(*problem_, {}));
    if (!nuisances.ok()) return nuisances.failure();
    Whitener whitener(problem_->channels(), problem_->measured() - nuisances->predicted, 0);
    Estimate null = Estimator(*problem_, whitener).Evaluate({}, *nuisances);
    if (!null.ok()) return Failure{null.broken, problem_->plan().id};
    // Its size and then its colour without what the nuisance parameters explain.
    for (const int order : {0, Whitener::kOrder, Whitener::kOrder}) {
      whitener = WhitenerOf(*problem_, null, order);
      null = Estimator(*problem_, whitener).Evaluate({}, *nuisances);
    }
    // Candidates start from the nominal values as they are written: nuisance parameters that were driven to explain an
    // effect would hide it. Only as a hypothesis of its own does the nominal model get all the freedom of its nuisance
    // parameters.
    const Estimate base = null;
    {
      const Estimator estimator(*problem_, WhitenerOf(*problem_, null, 0));
      Estimate warm = selection_.FromShortHorizons(null, estimator);
      null = estimator.Refine(std::move(null), 3);
      KeepBetter(null, std::move(warm));
    }

    found_.candidates = CandidatesFor(*problem_, MagnitudesOf(*problem_));
    found_.threshold = Threshold(whitener.rows(), found_.candidates.size());
    std::vector<Estimate> fits = FitBest(Estimator(*problem_, whitener), base, "one effect", 0.05, 0.5);
    std::vector<Structure> structure;
    const bool lost = fits.empty() && AnyFound(StructureOf(null));
    const bool slips = options_.suspects.empty() && (lost || (!fits.empty() && Rubs(fits.front())));
    if (slips) {
      const Result<bool> explained = FromTheBeginning(std::nullopt, fits, null, structure);
      if (!explained.ok()) return explained.failure();
      if (*explained) return Complete(std::move(null), std::move(fits), std::move(structure));
    }
    if (lost && !whole_.spent()) {
      // Nobody was seen beside a line that rings at the wrong frequencies: once more beside the one that was fitted.
      Estimate fitted = null;
      fitted.nuisances.z0 = fitted.hypothesis.z;
      fits = FitBest(Estimator(*problem_, WhitenerOf(*problem_, fitted)), fitted,
                     "one effect beside fitted nominal values", 0.5, 0.6);
    }
    for (const Hypothesis& suspect : options_.suspects) {
      fits.push_back(EstimateAt(*problem_, suspect));
      if (fits.back().ok()) Estimator(*problem_, whitener).Score(fits.back());
    }
    std::erase_if(fits, [](const Estimate& fit) { return !fit.ok(); });
    BestFirst(fits);
    selection_.Suggest(Estimator(*problem_, whitener), null, fits);
    selection_.Decide(EntrantsOf(screened_), fits, null);
    // By now the null model has converged: those of its nuisance parameters that lie far outside their prior become candidates.
    if (!fits.empty() && selection_.Suggest(Estimator(*problem_, WhitenerOf(*problem_, fits.front())), null, fits))
      selection_.Decide(EntrantsOf(screened_), fits, null);
    Estimate rough = fits.empty() ? null : fits.front();
    if (Status failed = ToTheWhole(null, fits, structure)) return *failed;
    if (!slips && options_.suspects.empty()) {
      const EffectInstance* best = fits.empty() ? nullptr : &fits.front().hypothesis.effects.back();
      const bool rest = AnyFound(structure) && !whole_.spent();
      if (rest || (best != nullptr && best->effect->info().traits.speed_dependent)) {
        const Result<bool> explained =
            FromTheBeginning(rest ? std::nullopt : std::optional(best->place), fits, null, structure);
        if (!explained.ok()) return explained.failure();
      }
    }
    if (AnyFound(structure) && !whole_.spent()) {
      // Before an effect is called for, or a second one, the machine gets the time it needs.
      Estimate& best = fits.empty() ? null : fits.front();
      best = ToTheEnd(std::move(best), 8);
      if (AnyFound(StructureOf(best)) && !Rubs(best)) {
        best = InStep(std::move(best));
        const std::optional<Hypothesis> found =
            AnyFound(StructureOf(best)) ? selection_.FromAnyStart(StartsBeside(fits)) : std::optional(best.hypothesis);
        if (found && !found->effects.empty()) {
          if (Status failed = AskAgain(*found, null, fits)) return *failed;
        }
      }
      const Estimator estimator(*problem_, WhitenerOf(*problem_, fits.empty() ? null : fits.front()));
      estimator.Score(null);
      Sort(estimator, fits);
      structure = StructureOf(fits.empty() ? null : fits.front());
    }
    if (!fits.empty() && AnyFound(structure) && !whole_.spent()) {
      if (Status failed = TryPairs(fits, null, rough, structure)) return *failed;
    }
    return Complete(std::move(null), std::move(fits), std::move(structure));
  }

 private:
  Found Complete(Estimate null, std::vector<Estimate> fits, std::vector<Structure> structure) {
    found_.null = std::move(null);
    found_.fits = std::move(fits);
    found_.structure = std::move(structure);
    return std::move(found_);
  }

  /// One substep a sample: what a nonlinear law costs falls by four, and a search does not need the last digits. Nor does
  /// it need modes that are faster than the record's samples can show.
  static Plan Rough(Plan plan) {
    SetSubsteps(plan, 1);
    Value& run = plan.root["run"];
    run["realtime"]["condense_above_Hz"] = Value(0.5 / run.NumberOr("period_s", RunSettings().period_s));
    return plan;
  }
  /// Searching takes as long as the records are; what a line's behaviour can tell, its first seconds do.
  static double PartShare(const EstimationProblem& whole) {
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

  std::vector<Structure> StructureOf(const Estimate& fit) const {
    return FindStructure(*problem_, problem_->measured() - fit.predicted, fit.predicted);
  }

  /// Screens every candidate on top of `base` and fits the best ones fully.
  std::vector<Estimate> FitBest(const Estimator& estimator, const Estimate& base, const std::string& what, double begin,
                                double end) {
    const std::string stage = what + ": " + base.Name();
    screened_ = saved_.Screening(stage);
    if (screened_.empty()) {
      screened_ = ScreenShort(base, what, begin, begin + 0.7 * (end - begin));
      saved_.KeepScreening(stage, screened_);
    }
    if (base.hypothesis.effects.empty()) found_.screened = screened_;
    std::vector<Estimate> fits;
    const std::vector<EffectInstance> entrants = EntrantsOf(screened_);
    const std::size_t most = std::min(entrants.size(), kFullFits + ByPower(screened_).size());
    std::size_t fitted = 0;
    for (std::size_t k = 0; k < entrants.size() && fitted < most; ++k) {
      std::vector<EffectInstance> effects = base.hypothesis.effects;
      if (std::any_of(effects.begin(), effects.end(),
                      [&](const EffectInstance& instance) { return instance.SameCause(entrants[k]); }))
        continue;
      effects.push_back(entrants[k]);
      Step("fitting " + entrants[k].ToString(),
           begin + (end - begin) * (0.7 + 0.3 * static_cast<double>(fitted) / static_cast<double>(most)));
      // Its own size first, beside nuisance parameters that follow linearly: the screening saw it at a small one.
      if (!saved_.Recall(effects)) {
        const Estimate sized = estimator.Optimise(effects, base.nuisances, 8);
        if (sized.ok()) effects = sized.hypothesis.effects;
      }
      Estimate fit = EstimateAt(*problem_, {base.nuisances.z0, effects});
      if (!fit.ok()) continue;
      ++fitted;
      estimator.Score(fit);
      TakeUp(fits, std::move(fit));
    }
    BestFirst(fits);
    return fits;
  }

  /// Who explains most of the residual's power at once, the best two. By the noise's colour they may look like nothing:
  /// that is taken from the residual, which is the effect itself until somebody explains it.
  std::vector<EffectInstance> ByPower(std::vector<Screened> screened) const {
    constexpr double kExplains = 0.25;  // of the power is left
    std::erase_if(screened, [](const Screened& one) { return !(one.left < kExplains); });
    std::stable_sort(screened.begin(), screened.end(),
                     [](const Screened& a, const Screened& b) { return a.left < b.left; });
    std::vector<EffectInstance> best;
    for (std::size_t k = 0; k < std::min<std::size_t>(2, screened.size()); ++k)
      best.push_back(found_.candidates[screened[k].candidate].At(screened[k].closest));
    return best;
  }

  /// These and the promising ones, at the sizes that the screening saw.
  std::vector<EffectInstance> EntrantsOf(const std::vector<Screened>& screened) const {
    std::vector<EffectInstance> entrants = ByPower(screened);
    for (const Screened& one : screened) {
      if (!one.promising) break;
      const EffectInstance next = found_.candidates[one.candidate].At(one.parameters);
      if (std::none_of(entrants.begin(), entrants.end(),
                       [&](const EffectInstance& other) { return Same(next, other); }))
        entrants.push_back(next);
    }
    return entrants;
  }

  /// Screens on the first part of the records: it only ranks.
  std::vector<Screened> ScreenShort(const Estimate& base, const std::string& what, double begin, double end) {
    const Result<NuisanceModel> nuisances =
        LineariseNuisances(short_, {base.nuisances.z0, base.hypothesis.effects}, base.nuisances.freedom);
    if (!nuisances.ok()) return {};
    Whitener whitener(short_.channels(), short_.measured() - nuisances->predicted, 0);
    Estimate fit;
    for (const int order : {0, Whitener::kOrder, Whitener::kOrder}) {
      fit = Estimator(short_, whitener).Evaluate(base.hypothesis.effects, *nuisances);
      if (!fit.ok()) return {};
      whitener = WhitenerOf(short_, fit, order);
    }
    const Estimator estimator(short_, whitener);
    fit = estimator.Evaluate(base.hypothesis.effects, *nuisances);
    const double threshold = Threshold(whitener.rows(), found_.candidates.size());
    std::vector<Screened> screened = Screen(short_, estimator, fit, found_.candidates, threshold, [&](double done) {
      Step("screening, " + what, begin + (end - begin) * done);
    });
    for (Screened& one : screened) one.promising = std::isfinite(one.chi2) && fit.chi2 - one.chi2 >= 0.3 * threshold;
    return screened;
  }

  /// By its own noise, first as if that were white, then with its colour.
  Estimate ToTheEnd(Estimate fit, int rounds) const {
    for (const int order : {0, Whitener::kOrder})
      fit = Estimator(*problem_, WhitenerOf(*problem_, fit, order)).Refine(std::move(fit), rounds);
    return fit;
  }

  static Hypothesis Without(Hypothesis hypothesis, std::size_t effect) {
    hypothesis.effects.erase(hypothesis.effects.begin() + static_cast<std::ptrdiff_t>(effect));
    return hypothesis;
  }

  /// Reduces a pair to one effect where the other is insignificant: it moves a nominal value within its prior,
  /// which had not found its place yet, or has no size that can be told from nothing.
  std::optional<Estimate> FoldBack(const Estimate& pair) {
    Estimate derived = pair;
    Estimator(*problem_, WhitenerOf(*problem_, pair)).Derive(derived);
    for (std::size_t e = 0; e < pair.hypothesis.effects.size(); ++e) {
      const EffectInstance& second = pair.hypothesis.effects[e];
      bool none = IsNothing(*problem_, derived, e);
      Hypothesis at = Without(pair.hypothesis, e);
      for (std::size_t i = 0; i < problem_->nuisances().size(); ++i) {
        const Nuisance& nuisance = problem_->nuisances()[i];
        if (!Changes(second, nuisance)) continue;
        at.z[i] = DeviateOf(nuisance, second.parameters.front());
        none = none || std::abs(at.z[i]) <= policy::kWithinPrior;
      }
      if (!none) continue;
      Estimate fit = EstimateAt(*problem_, std::move(at));
      if (!fit.ok()) continue;
      return ToTheEnd(std::move(fit), 5);
    }
    return std::nullopt;
  }

  /// A mode that is hardly seen may have lost step by a whole turn: it leaves a line in the spectrum, and no slope
  /// leads back. Once more from the nominal values, over parts that grow little by little.
  Estimate InStep(Estimate fit) {
    Step("from a short part: " + fit.Name(), 0.96);
    const Estimate cold = EstimateAt(part_, fit.hypothesis);
    if (!cold.ok()) return fit;
    Estimate anew = EstimateAt(
        *problem_, selection_.OverGrowingHorizons(cold, Estimator(part_, WhitenerOf(part_, cold, 0))).hypothesis);
    if (anew.ok()) anew = Converged(*problem_, std::move(anew));
    if (!anew.ok()) return fit;
    const Estimator estimator(*problem_, WhitenerOf(*problem_, fit));
    estimator.Score(fit);
    estimator.Score(anew);
    KeepBetter(fit, std::move(anew));
    return fit;
  }

  /// Decides anew where the search takes place, with one hypothesis to begin with, and goes on to all training data.
  /// No fits: a run broke.
  Status DecideAnew(const Hypothesis& from, std::vector<Estimate>& fits, Estimate& nominal,
                    std::vector<Structure>& structure) {
    problem_ = &part_;
    fits = {EstimateAt(*problem_, from)};
    nominal = EstimateAt(*problem_, nominal.hypothesis);
    if (!fits.front().ok() || !nominal.ok()) {
      fits.clear();
      problem_ = &whole_;
      return {};
    }
    selection_.Decide(EntrantsOf(found_.screened), fits, nominal);
    return ToTheWhole(nominal, fits, structure);
  }

  /// Where nobody explains the data: all that moves modes, and whatever else can be wrong where the best fit (the
  /// first) sees something, at all sizes that a search starts from. The screening has seen one of them, beside modes
  /// that were out of step.
  std::vector<EffectInstance> StartsBeside(const std::vector<Estimate>& fits) const {
    const EffectInstance* best = fits.empty() ? nullptr : &fits.front().hypothesis.effects.back();
    std::vector<EffectInstance> starts;
    for (const Candidate& candidate : found_.candidates) {
      const bool here = best != nullptr && candidate.place == best->place && candidate.effect != best->effect;
      for (const std::vector<double>& start : candidate.starts) {
        EffectInstance instance = candidate.At(start);
        if (ChangesStructure(instance) || instance.effect->info().traits.dry_friction) break;
        const bool moves = std::any_of(problem_->nuisances().begin(), problem_->nuisances().end(),
                                       [&](const Nuisance& nuisance) { return Changes(instance, nuisance); });
        if (here || moves) starts.push_back(std::move(instance));
      }
    }
    return starts;
  }

  /// A fit has reached the noise after all: whoever was beaten while nobody was there is asked again, beside the
  /// nuisance parameters as that one has them.
  Status AskAgain(const Hypothesis& found, Estimate& null, std::vector<Estimate>& fits) {
    std::vector<Estimate> again;
    std::vector<Structure> left;
    Estimate nominal = null;
    selection_.Recall(beaten_);
    if (Status failed = DecideAnew(found, again, nominal, left)) return failed;
    if (again.empty() || AnyFound(left)) return {};
    const Estimator last(*problem_, WhitenerOf(*problem_, again.front()));
    Sort(last, again);
    for (Estimate& fit : fits) {
      last.Score(fit);
      TakeUp(again, std::move(fit));
    }
    fits = std::move(again);
    last.Score(null);
    last.Score(nominal);
    KeepBetter(null, std::move(nominal));
    return {};
  }

  /// A law that refines another has to be better than that one from where it stands itself: the plainer law may have come
  /// to rest elsewhere, or never have got as far as here.
  void AskPlainerLaw(const Estimator& estimator, std::vector<Estimate>& fits) const {
    if (!Rubs(fits.front()) || fits.front().hypothesis.effects.size() != 1) return;
    const Hypothesis plainer = AsCoulomb(*problem_, fits.front().hypothesis);
    if (plainer.effects.front().SameCause(fits.front().hypothesis.effects.front())) return;
    Estimate fit = EstimateAt(*problem_, plainer);
    if (fit.ok()) fit = estimator.Refine(std::move(fit), 8);
    if (fit.ok()) TakeUp(fits, std::move(fit));
  }

  /// Laws of the same place contain one another, and the way of friction is rough: once more beside the nuisance
  /// parameters as the best one (the first) has them.
  void AskAtItsPlace(std::vector<Estimate>& fits) const {
    const Estimator estimator(*problem_, WhitenerOf(*problem_, fits.front()));
    AskPlainerLaw(estimator, fits);
    for (std::size_t k = 1; k < fits.size(); ++k) {
      if (!fits[k].ok() || fits[k].hypothesis.effects.back().place != fits[0].hypothesis.effects.back().place) continue;
      Estimate beside = EstimateAt(*problem_, {fits[0].hypothesis.z, fits[k].hypothesis.effects});
      estimator.Score(fits[k]);
      if (beside.ok()) KeepBetter(fits[k], estimator.Refine(std::move(beside), 8));
      // What one law is ahead of a simpler one may be no more than where on its rough way it has come to rest.
      if (Rubs(fits[k]) && fits[k].parameters() < fits[0].parameters() &&
          fits[k].criterion - fits[0].criterion < kRough)
        fits[k] = Restarted(*problem_, estimator, std::move(fits[k]), kRestarts);
    }
  }

  /// The best of `single` and of either half of a pair alone, from where the pair stands; weighed by `fitter`.
  Estimate OneOf(const Estimate& pair, const Estimator& estimator, Estimate single) const {
    for (std::size_t e = 0; e < pair.hypothesis.effects.size() && pair.hypothesis.effects.size() > 1; ++e) {
      Estimate fit = EstimateAt(*problem_, Without(pair.hypothesis, e));
      if (fit.ok()) fit = Converged(*problem_, std::move(fit));
      if (!fit.ok()) continue;
      estimator.Score(fit);
      if (fit.criterion < single.criterion) single = std::move(fit);
    }
    return single;
  }

  /// Dry friction that sticks and slips is lost by a search over the whole record, and with one substep a sample: it is
  /// followed from the beginning (at `place`, or wherever), and has to stand against who was found so far. Whether the
  /// best of them explains the records; only then anything is changed.
  Result<bool> FromTheBeginning(const std::optional<Place>& place, std::vector<Estimate>& fits, Estimate& null,
                                std::vector<Structure>& structure) {
    const EstimationProblem fine = whole_.Part(PartShare(whole_));
    const std::optional<Followed> followed = FollowFriction(
        fine, place, [&](double done) { Step("following friction from the beginning", 0.5 + 0.1 * done); });
    if (!followed || followed->share < 1.0) return false;
    Estimate nominal = EstimateAt(fine, null.hypothesis);
    std::vector<Estimate> rivals;
    const auto add = [&](const Hypothesis& hypothesis) {
      Estimate fit = EstimateAt(fine, hypothesis);
      const auto known = [&](const Estimate& other) { return other.Name() == fit.Name(); };
      if (fit.ok() && std::none_of(rivals.begin(), rivals.end(), known)) rivals.push_back(std::move(fit));
    };
    add(followed->hypothesis);
    for (const Hypothesis& other : followed->alike) add(other);
    add(AsCoulomb(fine, followed->hypothesis));
    for (const Estimate& fit : fits) add(fit.hypothesis);
    if (!nominal.ok() || rivals.empty()) return false;
    Sort(Estimator(fine, WhitenerOf(fine, rivals.front())), rivals);
    Selection selection(fine, saved_, options_.progress);
    selection.Recall(beaten_);
    selection.Decide(EntrantsOf(found_.screened), rivals, nominal);
    std::vector<Structure> left;
    const EstimationProblem* before = std::exchange(problem_, &fine);
    const std::vector<Considered> considered = found_.considered;
    if (Status failed = ToTheWhole(nominal, rivals, left)) return *failed;
    if (rivals.empty() || AnyFound(left)) {
      problem_ = before;
      found_.considered = considered;
      return false;
    }
    fits = std::move(rivals);
    null = std::move(nominal);
    structure = std::move(left);
    return true;
  }

  /// `rough`: the best single effect where the search takes place.
  Status TryPairs(std::vector<Estimate>& fits, Estimate& null, const Estimate& rough,
                  std::vector<Structure>& structure) {
    problem_ = &part_;
    const Estimator estimator(*problem_, WhitenerOf(*problem_, rough));
    Estimate base = rough, nominal = EstimateAt(*problem_, null.hypothesis);
    estimator.Score(base);
    base.nuisances.z0 = base.hypothesis.z;  // candidates are added at the optimum
    std::vector<Estimate> pairs = FitBest(estimator, base, "two effects", 0.7, 0.95);
    if (pairs.size() > 3) pairs.resize(3);
    selection_.Decide(EntrantsOf(screened_), pairs, nominal);
    std::optional<Estimate> alone = pairs.empty() ? std::nullopt : FoldBack(pairs.front());
    if (alone && alone->ok()) {
      // Who it left behind on its way has to be asked again, its own law at other places first.
      pairs = {std::move(*alone)};
      selection_.Decide(EntrantsOf(found_.screened), pairs, nominal);
    }
    std::vector<Structure> left;
    if (Status failed = ToTheWhole(nominal, pairs, left)) return failed;
    if (pairs.empty()) return {};
    const Estimator last(*problem_, WhitenerOf(*problem_, pairs.front()));
    last.Score(pairs.front());
    Estimate best = OneOf(pairs.front(), last, last.Refine(fits.front(), 6));
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
    last.Score(null);
    last.Score(nominal);
    KeepBetter(null, std::move(nominal));
    return {};
  }

  /// Fits that stood on the part go on to all training data: the nominal model, and whatever is not far behind the
  /// best.
  Status ToTheWhole(Estimate& null, std::vector<Estimate>& fits, std::vector<Structure>& structure) {
    const Estimator last(*problem_, fits.empty() ? WhitenerOf(*problem_, null) : WhitenerOf(*problem_, fits.front()));
    for (Estimate& fit : fits) last.Score(fit);
    const double best = fits.empty() ? 0.0 : fits.front().criterion, rows = last.whitener().rows();
    std::vector<Estimate> carried;
    for (Estimate& fit : fits) {
      const double behind = fit.criterion - best;
      if (carried.empty() || (carried.size() < kCarried && behind < 0.5 * rows)) {
        carried.push_back(std::move(fit));
        continue;
      }
      Considered& left = found_.considered.emplace_back(ConsideredOf(fit));
      left.why_not = fmt::format("explains less of the first part of the data: -2 log evidence {:.0f} behind", behind);
      left.validation_nrmse = TotalNrmse(*problem_, fit.predicted);
      if (fit.hypothesis.effects.size() == 1) beaten_.push_back(fit.hypothesis.effects.front());
    }
    fits = std::move(carried);
    problem_ = &whole_;
    const auto carry = [&](Estimate& fit, const Estimate* leader) {
      Step("all training data: " + fit.Name(), 0.95);
      fit = EstimateAt(*problem_, std::move(fit.hypothesis));
      if (!fit.ok()) return;
      for (const int order : {0, Whitener::kOrder})
        fit = Estimator(*problem_, WhitenerOf(*problem_, leader != nullptr ? *leader : fit, order))
                  .Refine(std::move(fit), order > 0 ? 12 : 2);
    };
    for (std::size_t k = 0; k < fits.size(); ++k) carry(fits[k], k > 0 && fits[0].ok() ? &fits[0] : nullptr);
    if (!fits.empty() && fits[0].ok()) {
      fits[0] = Converged(*problem_, std::move(fits[0]));
      if (Rubs(fits[0])) {
        const Estimator estimator(*problem_, WhitenerOf(*problem_, fits[0]));
        fits[0] = Restarted(*problem_, estimator, std::move(fits[0]), kRestarts);
      }
      AskAtItsPlace(fits);
    }
    std::erase_if(fits, [](const Estimate& fit) { return !fit.ok(); });
    carry(null, fits.empty() ? nullptr : &fits.front());
    if (!null.ok()) return Failure{null.broken, problem_->plan().id};
    const Estimator estimator(*problem_, WhitenerOf(*problem_, fits.empty() ? null : fits.front()));
    Sort(estimator, fits);
    found_.threshold = Threshold(estimator.whitener().rows(), found_.candidates.size());
    structure = StructureOf(fits.empty() ? null : fits.front());
    return {};
  }

  const EstimationProblem& whole_;  // all that is for training
  const EstimationProblem part_;  // where the search takes place: coarser, and its first part when the records are long
  const EstimationProblem* problem_;  // where the fits stand now: the part, then the whole
  const EstimationProblem short_;     // where candidates are screened
  const SearchOptions& options_;
  SavedFits saved_;
  Selection selection_;
  Found found_;
  std::vector<Screened> screened_;      // on top of what stood then
  std::vector<EffectInstance> beaten_;  // alone, where the search takes place
};

}  // namespace

Considered ConsideredOf(const Estimate& fit) {
  Considered considered;
  const std::vector<EffectInstance>& effects = fit.hypothesis.effects;
  for (std::size_t e = 0; e + 1 < effects.size(); ++e) considered.name += effects[e].ToString() + " + ";
  considered.name += effects.back().effect->info().name;
  considered.at = effects.back().place.ToString();
  return considered;
}

Result<Found> Search(const EstimationProblem& problem, const std::vector<MappedRecord>& data, double training_share,
                     const SearchOptions& options) {
  return Searching(problem, data, training_share, options).Run();
}

}  // namespace dynoproof::diagnosis
