#include "diagnosis/judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "diagnosis/candidates.h"
#include "diagnosis/decide.h"
#include "diagnosis/extend.h"
#include "diagnosis/policy.h"
#include "identification/profile_likelihood.h"
#include "identification/start.h"

namespace dynoproof::diagnosis {
namespace {

std::string WhyNot(const Standing& s, const Estimate& fit, const Estimate& best) {
  if (!s.significant)
    return fmt::format("gains too little over the nominal values alone (chi2 {:.0f}, {} of {} validation parts)",
                       s.chi2_gain, s.blocks_better, policy::kBlocks);
  const double behind = fit.criterion - best.criterion;
  if (behind <= 0.0) return "";
  if (behind <= policy::kAlike) return fmt::format("as good as the best within {:.1f} (-2 log evidence)", behind);
  if (fit.chi2 <= best.chi2 + policy::kAlike)
    return fmt::format("no better than the best with more parameters (-2 log evidence {:.0f} behind)", behind);
  return fmt::format("explains less: -2 log evidence {:.0f} behind", behind);
}

/// How far ahead of a fit with dry friction another one may be and explain no more [-2 log evidence]: numbers to spare
/// take up what the solver's step leaves at each stop, and no fit comes to the very bottom of its rough way.
double Roughness(const EstimationProblem& problem, const Estimate& fit, const Whitener& whitener) {
  constexpr double kWay = 50.0;  // between the best two of many minima
  if (!fit.hypothesis.effects.back().effect->info().traits.dry_friction) return 0.0;
  const Result<Eigen::VectorXd> finer = problem.PredictFiner(fit.hypothesis);
  return kWay + (finer.ok() ? 2.0 * whitener(*finer - fit.predicted).squaredNorm() : 0.0);
}

/// Adds to `alike` laws with fewer numbers at the place of the best one (the first of `fits`) that foretell the
/// left-out parts of the data no worse, or explain as much as can be told. `validation`: the error there, by fit.
void AddSimplerLaws(const EstimationProblem& problem, const std::vector<Estimate>& fits,
                    const std::vector<double>& validation, std::vector<std::size_t>& alike) {
  const Whitener whitener = WhitenerOf(problem, fits.front());
  const std::vector<EffectInstance>& best = fits.front().hypothesis.effects;
  for (std::size_t i = 1; i < fits.size(); ++i) {
    const std::vector<EffectInstance>& other = fits[i].hypothesis.effects;
    if (best.size() != 1 || other.size() != 1 || !(other[0].place == best[0].place)) continue;
    if (fits[i].parameters() >= fits[0].parameters()) continue;
    const double behind = fits[i].criterion - fits[0].criterion;
    if (validation[i] > validation[0] && behind > Roughness(problem, fits[i], whitener)) continue;
    if (std::find(alike.begin(), alike.end(), i) == alike.end()) alike.push_back(i);
  }
}

}  // namespace

Judgement::Judgement(const EstimationProblem& problem, double training, double until,
                     const std::vector<MappedRecord>& data, const std::vector<MappedRecord>& given,
                     const std::vector<MappedRecord>& holdout, const DiagnoseOptions& options)
    : problem_(problem), training_(training), data_(data), given_(given), holdout_(holdout), options_(options) {
  result_.own_holdout = !holdout_.empty();
  result_.counted = until;
  if (!result_.own_holdout) result_.notes.push_back("the last 30 % of the data are the hold-out");
}

Status Judgement::Decide(const char* saved, const std::vector<Hypothesis>& suspects) {
  Result<Found> found =
      Search(problem_, data_, training_,
             {(std::filesystem::path(options_.out) / saved).string(), options_.resume, options_.progress, suspects});
  if (!found.ok()) return found.failure();
  found_ = *std::move(found);
  result_.considered = std::move(found_.considered);
  result_.journal.clear();
  Judge();
  return {};
}

std::vector<Hypothesis> Judgement::Causes() const {
  std::vector<Hypothesis> causes;
  if (result_.verdict != Verdict::kEffectFound && result_.verdict != Verdict::kAmbiguous) return causes;
  for (const std::size_t i : alike_) causes.push_back(found_.fits[i].hypothesis);
  return causes;
}

Result<Diagnosis> Judgement::Report() {
  const bool complete = !problem_.spent();  // the hold-out alone may still cost what is left
  if (Status failed = Conclude()) return *failed;
  const identification::Allowance& allowance = *problem_.context().allowance;
  result_.simulations = allowance.simulations();
  result_.search_complete = complete;
  if (!complete)
    Note(fmt::format(
        "the search has spent its budget, {:.0f} simulations of the data and {:.3g} s of CPU time: this is the "
        "best that it has tried; --most-simulations and --most-cpu let it go on",
        std::ceil(allowance.simulations()), allowance.cpu_s()));
  options_.progress("done", 1.0);
  return std::move(result_);
}

void Judgement::Judge() {
  Estimate& null = found_.null;
  std::vector<Estimate>& fits = found_.fits;
  const std::vector<Structure>& structure = found_.structure;
  const Estimator estimator(problem_, fits.empty() ? WhitenerOf(problem_, null) : WhitenerOf(problem_, fits.front()));
  estimator.Score(null);
  estimator.Derive(null);
  JournalScreening();
  const std::vector<double> null_blocks = CrossValidate(problem_, estimator, null);
  const double rows = estimator.whitener().rows();
  const std::vector<std::string> strained = Strained(null);
  const double farthest = LargestDeviation(problem_, null);
  std::vector<Estimate> standing;
  std::vector<double> validation;
  for (Estimate& fit : fits) {
    estimator.Score(fit);
    estimator.Derive(fit);
    const std::vector<double> blocks = CrossValidate(problem_, estimator, fit);
    const Standing s = Compare(problem_, null, null_blocks, fit, blocks, rows, found_.candidates.size());
    Considered& considered = result_.considered.emplace_back(ConsideredOf(fit));
    considered.validation_nrmse =
        TotalNrmse(problem_, fit.predicted) * std::sqrt(s.validation_chi2 / std::max(1.0, fit.chi2));
    considered.why_not = WhyNot(s, fit, fits.front());
    bool within = false;  // the change is within the prior of its number: not reported
    bool beyond = false;  // the null model moves the same number as far: reported
    for (std::size_t i = 0; i < problem_.nuisances().size(); ++i) {
      const std::optional<double> z = AsNuisance(problem_.nuisances()[i], fit);
      if (!z) continue;
      within = within || std::abs(*z) < policy::kWithinPrior;
      const double without = null.hypothesis.z[i];
      beyond = beyond || (std::min(std::abs(*z), std::abs(without)) > policy::kBeyondPrior && *z * without > 0.0 &&
                          s.chi2_gain > 0.5 * without * without);
    }
    // So is one that spares the nominal model a value far outside its prior: it stands beside what says
    // that value.
    beyond = beyond || (farthest > policy::kBeyondPrior && LargestDeviation(problem_, fit) < policy::kWithinPrior &&
                        s.chi2_gain > 0.5 * farthest * farthest);
    if (within) considered.why_not = "changes a nominal value by no more than its prior allows";
    if (beyond) considered.why_not = WhyNot({.significant = true}, fit, fits.front());
    bool nothing = false;
    for (std::size_t e = 0; e < fit.hypothesis.effects.size(); ++e) nothing = nothing || IsNothing(problem_, fit, e);
    if (nothing) considered.why_not = "not significant: its 95 % interval includes the neutral value";
    JournalCandidate(s, fit, within, beyond, nothing, considered.why_not.empty() ? "the best" : considered.why_not);
    if ((s.significant || beyond) && !within && !nothing) {
      standing.push_back(fit);
      validation.push_back(considered.validation_nrmse);
    }
  }
  fits = std::move(standing);
  bool rest = AnyFound(structure);
  result_.tests = TestsOf(structure);
  rest = rest || (!result_.tests.independent_of_inputs().value_or(true) && !fits.empty() &&
                  LeavesTheSignal(problem_, null, fits.front()));
  result_.at_noise_floor = !rest;
  evidence_ = {};
  alike_.clear();
  also_.clear();
  evidence_.structure = rest;
  evidence_.found = TextOf(structure);
  evidence_.pairs = found_.partial;
  evidence_.strained = strained;
  evidence_.null_deviation = farthest;
  if (!fits.empty()) {
    alike_ = AmbiguitySet(fits, found_.threshold);
    AddSimplerLaws(problem_, fits, validation, alike_);
    // What accounts for the data, leaving aside what the nuisance parameters cost, as well as the best effect does.
    if (null.chi2 - PriorChi2(null) - (fits.front().chi2 - PriorChi2(fits.front())) < found_.threshold)
      also_ = strained;
    evidence_.best = fits.front().Name();
    evidence_.deviation = LargestDeviation(problem_, fits.front());
    evidence_.alike = alike_.size() + also_.size();
  }
  Rule();
  JournalResidual();
}

void Judgement::Rule() {
  Ruling ruling = VerdictOf(evidence_);
  result_.verdict = ruling.verdict;
  result_.reason = std::move(ruling.reason);
  rule_ = std::move(ruling.rule);
}

void Judgement::JournalScreening() {
  JournalEntry entry{
      "screening", {}, "the signature of each effect at each place must explain 0.3 of the least chi2 gain", {}, ""};
  for (const Screened& one : found_.screened) {
    if (one.promising) entry.compared.push_back(found_.candidates[one.candidate].ToString());
  }
  entry.numbers = {{"candidates", static_cast<double>(found_.candidates.size())},
                   {"promising", static_cast<double>(entry.compared.size())},
                   {"least_chi2_gain", found_.threshold}};
  entry.outcome = entry.compared.empty() ? "no signature explains as much" : "the first of them are fitted, best first";
  result_.journal.push_back(std::move(entry));
}

void Judgement::JournalCandidate(const Standing& s, const Estimate& fit, bool within, bool beyond, bool nothing,
                                 const std::string& outcome) {
  result_.journal.push_back(
      {"selection",
       {fit.Name(), "nominal model"},
       "chi2 gain above the least one, criterion gain above half of it, better on three of five validation parts; no "
       "change of a nominal value within its prior, none whose interval includes the neutral value",
       {{"chi2_gain", s.chi2_gain},
        {"least_chi2_gain", found_.threshold},
        {"criterion_gain", s.criterion_gain},
        {"validation_gain", s.validation_gain},
        {"parts_better", s.blocks_better},
        {"f_test_p_value", s.p_value},
        {"within_prior", within ? 1.0 : 0.0},
        {"null_model_moves_it_too", beyond ? 1.0 : 0.0},
        {"includes_neutral", nothing ? 1.0 : 0.0}},
       outcome});
}

void Judgement::JournalResidual() {
  for (const Structure& one : found_.structure) {
    if (!one.tested) continue;
    result_.journal.push_back({"residual tests",
                               {one.signal},
                               "independent of inputs and predicted outputs, no line, no larger than noise",
                               {{"regression_f_p_value", one.p_value},
                                {"regression_share", one.explained},
                                {"line_fisher_g_p_value", one.line_p_value},
                                {"line_share", one.line_share},
                                {"line_hz", one.line_hz},
                                {"over_high_frequency_level", one.over_floor},
                                {"over_one_step_error", one.rings},
                                {"over_spread", one.size}},
                               one.found() ? one.Text() : "noise"});
  }
  if (found_.fits.size() < 2) return;
  for (std::size_t i = 1; i < found_.fits.size(); ++i) {
    const bool alike = std::find(alike_.begin(), alike_.end(), i) != alike_.end();
    result_.journal.push_back(
        {"ambiguity",
         {found_.fits[i].Name(), found_.fits.front().Name()},
         "alike within 10 of -2 log evidence, or a simpler law at the same place that predicts the "
         "validation parts no worse",
         {{"behind", found_.fits[i].criterion - found_.fits.front().criterion}},
         alike ? "cannot be told apart" : "told apart"});
  }
}

std::vector<std::string> Judgement::Strained(const Estimate& null) const {
  std::vector<std::string> strained;
  for (std::size_t i = 0; i < problem_.nuisances().size(); ++i) {
    const Nuisance& nuisance = problem_.nuisances()[i];
    if (!nuisance.start && nuisance.effect == nullptr && !(std::abs(null.hypothesis.z[i]) <= policy::kWithinPrior))
      strained.push_back("nominal_value@" + nuisance.path);
  }
  return strained;
}

Status Judgement::Conclude() {
  const Estimate& null = found_.null;
  const std::vector<Estimate>& fits = found_.fits;
  const bool known = !fits.empty();
  const Estimate& best = known ? fits.front() : null;
  NoiseFloor(best);
  const Result<Eigen::VectorXd> nominal = problem_.Predict(problem_.Nominal());
  if (!nominal.ok()) return nominal.failure();
  result_.where = Localise(problem_, problem_.measured() - *nominal, floor_);
  for (std::size_t i = 0; i < problem_.nuisances().size(); ++i) {
    if (best.hypothesis.z[i] == 0.0) continue;
    const NuisanceValue value = ValueOf(problem_.nuisances()[i], best.hypothesis.z[i], problem_.plan());
    result_.refitted.push_back({problem_.nuisances()[i].path, value.nominal, value.value, best.hypothesis.z[i],
                                problem_.nuisances()[i].start});
  }
  if (Status failed = MeasureGain(best)) return failed;
  if (known) ReportEffects(fits);
  if (result_.verdict == Verdict::kNoEffect) {
    for (const Screened& one : found_.screened) {
      const Candidate& candidate = found_.candidates[one.candidate];
      if (candidate.strengths.empty() || !std::isfinite(one.smallest)) continue;
      double smallest = one.smallest;
      for (const Nuisance& nuisance : problem_.nuisances()) {  // a change of a number within its prior is no effect
        if (Changes(candidate.At({}), nuisance))
          smallest = std::max(smallest, ChangeOf(nuisance, policy::kWithinPrior));
      }
      result_.would_have_seen.push_back({candidate.effect->info().name, candidate.place.ToString(),
                                         candidate.effect->info().parameters[candidate.strengths[0]].unit, smallest});
    }
  }
  if (!known) return {};
  const Result<std::string> file = WriteExtended(problem_, best, result_, options_);
  if (!file.ok()) return file.failure();
  result_.extended_scenario = *file;
  return {};
}

void Judgement::ReportEffects(const std::vector<Estimate>& fits) {
  const Estimate& best = fits.front();
  const Eigen::VectorXd bias = SolverBias(problem_, best);
  options_.progress("how far the numbers reach", 0.96);
  // Of the part of a cause that was found no more than its fit says: the rest would move it anyway.
  const std::vector<Reach> reach =
      result_.verdict == Verdict::kUnexplained ? ByCovariance(best) : ProfileIntervalOf(problem_, best);
  double evidence = 0.0;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    // Who stands beside the best one stands for its validation, where the evidence has come from numbers to spare.
    const bool alike = std::find(alike_.begin(), alike_.end(), i) != alike_.end();
    const double behind = fits[i].criterion - best.criterion;
    evidence += alike && fits[i].parameters() < best.parameters() ? 1.0 : std::exp(-0.5 * behind);
  }
  Eigen::Index k = 0;
  for (const EffectInstance& instance : best.hypothesis.effects) {
    FoundEffect& found = result_.effects.emplace_back();
    found.name = instance.effect->info().name;
    found.at = instance.place.ToString();
    found.confidence = result_.verdict == Verdict::kUnexplained ? 0.0 : std::min(0.999, 1.0 / evidence);
    for (std::size_t i = 0; i < instance.parameters.size(); ++i, ++k) {
      const EffectParameter& p = instance.effect->info().parameters[i];
      const double drift = result_.effects.size() == 1 && i < drift_.size() ? drift_[i] : 0.0;
      const Reach& far = reach[static_cast<std::size_t>(k)];
      const double value = instance.parameters[i], besides = bias[k] + drift;
      found.parameters.push_back({p.name, p.unit, value, std::max(p.lower, value - far.below - besides),
                                  std::min(p.upper, value + far.above + besides)});
    }
  }
  AskIntervals(best);
  if (result_.verdict == Verdict::kEffectFound || alike_.size() + also_.size() < 2) return;
  std::vector<std::string> names;
  std::vector<EffectInstance> alike;
  for (const std::size_t i : alike_) {
    names.push_back(fits[i].Name());
    alike.push_back(fits[i].hypothesis.effects.back());
  }
  names.insert(names.end(), also_.begin(), also_.end());
  result_.ambiguous_with.push_back(names);
  result_.experiment_text = SeparatingText(problem_, alike);
  const Result<std::string> file = WriteSeparating(problem_, alike, options_);
  if (file.ok()) result_.experiment_scenario = *file;
}

/// The printed interval decides as well: it may reach farther than the one of the covariance, which was asked before.
void Judgement::AskIntervals(const Estimate& best) {
  for (std::size_t e = 0; e < result_.effects.size(); ++e) {
    bool strength = false, away = false;
    for (std::size_t i = 0; i < result_.effects[e].parameters.size(); ++i) {
      const double neutral = best.hypothesis.effects[e].effect->info().parameters[i].neutral;
      if (!std::isfinite(neutral)) continue;
      const FoundParameter& found = result_.effects[e].parameters[i];
      strength = true;
      away = away || found.lower > neutral || found.upper < neutral;
    }
    evidence_.includes_neutral = evidence_.includes_neutral || (strength && !away);
  }
  if (!evidence_.includes_neutral) return;
  Rule();
  result_.journal.push_back({"intervals",
                             {evidence_.best},
                             "the printed 95 % interval of a strength excludes its neutral value",
                             {},
                             ToString(result_.verdict) + ": " + result_.reason});
}

void Judgement::NoiseFloor(const Estimate& best) {
  const Eigen::VectorXd residual = problem_.measured() - best.predicted;
  double sum = 0.0;
  bool smooth = false;
  for (const Channel& c : problem_.channels()) {
    const auto rows = residual.segment(c.begin, c.count);
    const double rms = RmsOf(rows);
    const double white = HighFrequencyFloor(rows);
    smooth = smooth || rms < 1.1 * policy::kResolution * c.spread;
    const double floor = result_.at_noise_floor ? rms : std::min(white, rms);
    floor_.push_back(std::max(floor, 1e-9 * std::max(c.spread, c.nominal)));
    result_.floor_by_signal[c.name] = floor_.back();
    result_.residual_by_signal[c.name] = rms;
    sum += floor_.back() * floor_.back() / std::max(c.spread * c.spread, 1e-300);
  }
  if (smooth)
    Note(fmt::format("the record has no noise, as that of a simulation; it counts as measured to {:g} of each output",
                     policy::kResolution));
  result_.noise_floor = std::sqrt(sum / static_cast<double>(problem_.channels().size()));
}

Status Judgement::MeasureGain(const Estimate& best) {
  options_.progress("hold-out", 0.97);
  // Before: the scenario as written, but from the record's own start.
  Hypothesis start = problem_.Nominal();
  for (std::size_t i = 0; i < start.z.size(); ++i) {
    if (problem_.nuisances()[i].start) start.z[i] = best.hypothesis.z[i];
  }
  const EstimationProblem trained(problem_.plan(), given_, problem_.registry(), training_, problem_.context());
  const auto train = MeasureGains(trained, problem_.PlanOf(start), problem_.PlanOf(best.hypothesis));
  if (!train.ok()) return train.failure();
  result_.train = *train;
  const EstimationProblem full(problem_.plan(), result_.own_holdout ? holdout_ : given_, problem_.registry(),
                               result_.counted, problem_.context());
  // A hold-out starts as the scenario does, or else each model gets the start that suits it best, by its first tenth.
  const bool own_start = result_.own_holdout && std::ranges::any_of(holdout_, &MappedRecord::in_motion);
  const double from = own_start ? identification::kStartShare : result_.own_holdout ? 0.0 : kTrainingShare;
  const auto plan_of = [&](Hypothesis hypothesis) -> Result<Plan> {
    if (!result_.own_holdout) return problem_.PlanOf(hypothesis);
    for (std::size_t i = 0; i < hypothesis.z.size(); ++i) {
      if (problem_.nuisances()[i].start) hypothesis.z[i] = 0.0;
    }
    return identification::FitStarts(full, problem_.PlanOf(hypothesis), from);
  };
  const Result<Plan> as_written = plan_of(start), fitted = plan_of(found_.null.hypothesis),
                     extended = plan_of(best.hypothesis);
  for (const Result<Plan>* plan : {&as_written, &fitted, &extended}) {
    if (!plan->ok()) return plan->failure();
  }
  const auto holdout = MeasureGains(full, *as_written, *extended, from);
  if (!holdout.ok()) return holdout.failure();
  result_.holdout = *holdout;
  const auto nominal = MeasureGains(full, *fitted, *extended, from);
  if (!nominal.ok()) return nominal.failure();
  double sum_before = 0.0, sum_after = 0.0, sum_released = 0.0;
  for (const auto& [name, gain] : result_.holdout) {
    sum_before += gain.before * gain.before;
    sum_after += gain.after * gain.after;
    sum_released += std::pow(nominal->at(name).before, 2);
  }
  evidence_.holdout_gains = GainsOnHoldout({std::sqrt(sum_before), std::sqrt(sum_released), std::sqrt(sum_after)},
                                           LargestDeviation(problem_, found_.null));
  Rule();
  result_.journal.push_back(
      {"verdict",
       {evidence_.best.empty() ? "nominal model" : evidence_.best},
       rule_,
       {{"largest_deviation", evidence_.best.empty() ? evidence_.null_deviation : evidence_.deviation},
        {"alike", static_cast<double>(evidence_.alike)},
        {"holdout_nrmse_before", std::sqrt(sum_before)},
        {"holdout_nrmse_released", std::sqrt(sum_released)},
        {"holdout_nrmse_after", std::sqrt(sum_after)}},
       ToString(result_.verdict) + ": " + result_.reason});
  return {};
}

}  // namespace dynoproof::diagnosis
