#include "diagnosis/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/changed_numbers.h"
#include "diagnosis/contest.h"
#include "diagnosis/describe.h"
#include "diagnosis/detection.h"
#include "diagnosis/policy.h"
#include "diagnosis/second_look.h"
#include "diagnosis/settle.h"
#include "diagnosis/twins.h"
#include "diagnosis/weights.h"
#include "identification/residual_tests.h"
#include "identification/start.h"
#include "model/kept_modes.h"

namespace dynoproof::diagnosis {
namespace {

constexpr int kMostCauses = 3;  // that are looked for one after the other

/// Whether what a model leaves in its free run is noise, of whatever colour: independent of inputs and outputs, without lines
/// and no echo of the machine. Differences of a record tell white noise alone.
bool LeavesNoise(const EstimationProblem& problem, const Contestant& one, const Levels& levels) {
  const std::size_t free = levels.free_run();
  if (!one.Holds(free)) return false;
  const Result<Eigen::VectorXd> predicted = problem.PredictPlan(one.hypothesis.At(one.levels[free].q));
  if (!predicted.ok()) return false;
  const auto structure = identification::FindStructure(problem, problem.measured() - *predicted, *predicted);
  return std::ranges::all_of(structure, [](const auto& of) { return of.tested && !of.found(); });
}

/// Twice the logarithm of the likelihood by which a fit is behind another one, each channel's rows counted by their correlation. Of
/// starts alone, which the first block of rows shows and no other: leaving that out would tell nothing of them.
double LeftMore(const estimation::Estimate& fit, const estimation::Estimate& other, const estimation::DataSet& data) {
  double sum = 0.0;
  for (std::size_t c = 0; c < data.channels().size(); ++c) {
    const double rows = static_cast<double>(data.channels()[c].count) / fit.scales[c].correlation;
    sum += 2.0 * rows * std::log(fit.scales[c].rms / other.scales[c].rms);
  }
  return sum;
}

}  // namespace

Result<std::unique_ptr<Pipeline>> Pipeline::Of(const Plan& plan, const std::vector<MappedRecord>& data,
                                               const std::vector<MappedRecord>& holdout, const Registry& registry,
                                               const DiagnoseOptions& options, const Before& before) {
  identification::SearchContext context;
  context.released = true;  // what was let go is told
  auto problem = std::make_unique<EstimationProblem>(plan, data, registry, holdout.empty() ? kFittedShare : 1.0,
                                                     std::move(context));
  const Result<Plan> started = identification::FindStarts(*problem, plan);
  const Plan begun = started.ok() ? *started : plan;
  Result<Parts> parts = Split(begun, data, holdout, registry);
  if (!parts.ok()) return parts.failure();
  Plan searched = WithFewerModes(begun, *parts->training);
  // Corrections move modes: a run that keeps fewer than its observer knows of would be corrected amiss.
  if (RotorModes(searched) != RotorModes(begun)) parts = Split(searched, data, holdout, registry);
  if (!parts.ok()) return parts.failure();
  searched = InFewerSubsteps(searched, *parts->training, registry);
  return std::unique_ptr<Pipeline>(
      new Pipeline(std::move(problem), std::move(searched), *std::move(parts), data, holdout, options, before));
}

Result<Answer> Pipeline::Decide() {
  const Registry& registry = problem_.registry();
  Contestant nominal = NullOf(begun_, false, levels_, registry);
  hum_ = HumBesides(nominal);
  if (!hum_.empty()) return Answer{Contest(), Settled()};
  Result<Answer> answer = Ask(std::move(nominal), false, Contest::Pass(false));
  if (!answer.ok()) return answer.failure();
  if (!answer->settled.exact && !before_.read_again && !Spent())
    course_ = OtherCourse(begun_, answer->contest, levels_, registry);
  if (course_) return answer;
  std::optional<Drifts> drifts;
  if (!answer->settled.exact) drifts = DriftsBesides(answer->contest);
  if (drifts && drifts->Plainly()) {
    drifts_ = drifts;
    return answer;
  }
  const Answer first = WithFurtherCauses(*answer);
  if (first.settled.exact) {
    answer = first;
  } else if (drifts && drifts->Suffice()) {
    drifts_ = drifts;
    return answer;
  } else if (!Spent()) {
    // A model that was fitted naively has swallowed its missing effect, and gives it back only when it is let go.
    Contestant null = ReleasedNull();
    released_ = null;
    if (std::optional<Answer> numbers = SeveralNumbers(answer->contest, null)) return *std::move(numbers);
    std::vector<Contestant> admitted;
    for (const std::size_t i : answer->settled.causes) admitted.push_back(answer->contest.contestants[i]);
    Result<Answer> released = Ask(std::move(null), true, Contest::Pass(true), admitted);
    if (released.ok() && released->contest.complete) {
      if (released->settled.verdict == Conclusion::kNoEffect) {
        const auto far = FarFromPriors(released->contest.null(), answer->contest.null(), levels_);
        if (!far.empty()) TellNumbers(far, released->settled);
      }
      if (!released->settled.exact)
        answer->settled = Settle(answer->contest, levels_, passes_[0], LeastOf(passes_, levels_.size()));
      if (released->settled.exact || answer->settled.causes.empty())
        answer = WithFurtherCauses(*std::move(released));
      else
        answer = first;
    }
  }
  if (std::optional<Answer> otherwise = BegunOtherwise(*answer)) answer = *std::move(otherwise);
  const Contestant* best = LeaderAt(answer->contest.contestants, levels_, levels_.free_run());
  if (answer->settled.exact || best == nullptr || Spent()) return answer;
  hum_ = HumBesides(*best);
  if (hum_.empty()) drifts_ = answer->contest.released ? DriftsBesides(answer->contest) : drifts;
  return answer;
}

Result<Answer> Pipeline::DecideAsPlainlyAs(const Answer& other) {
  const auto asked = [&](const Contestant& null, bool released) {
    Result<Answer> answer = Ask(null, released, Contest::Pass(released));
    if (answer.ok() && EffectsIn(other) > 1) answer = WithFurtherCauses(*std::move(answer));
    return answer;
  };
  Result<Answer> answer = asked(NullOf(begun_, false, levels_, problem_.registry()), false);
  if (!answer.ok() || answer->settled.exact || !other.contest.released || Spent()) return answer;
  released_ = NullOf(begun_, true, levels_, problem_.registry());
  return asked(*released_, true);
}

std::vector<Hum> Pipeline::HumIn(const std::vector<MappedRecord>& others) const {
  if (others.empty() || !left_by_) return {};
  return FindHum({problem_.plan(), others, problem_.registry()}, *left_by_);
}

std::vector<Drift> Pipeline::DriftsInHoldout() const {
  if (holdout_.empty()) return {};
  return DriftsBeside(drifts_->model.At(drifts_->q), *parts_.held_out, parts_.held_out->free_run());
}

Result<Diagnosis> Pipeline::Report(Answer answer) {
  options_.progress("what it gains", 0.97);
  auto& [contest, settled] = answer;
  std::vector<std::size_t> told = settled.causes;
  if (settled.best) told.push_back(*settled.best);
  for (const std::size_t i : told) {
    if (settled.exact) PolishAt(settled.level, contest.contestants[i], contest.null());
  }
  settled = AtTheEnd(std::move(settled), contest);
  result_.verdict = settled.verdict;
  result_.reason = settled.reason;
  const std::vector<std::string> alike = NominalValuesAlike(problem_, answer, levels_, result_.journal);
  if (!alike.empty()) StandBeside(answer, alike);
  if (Status failed =
          Describe({problem_, begun_, data_, holdout_, options_}, levels_, contest, settled, released_, alike, result_))
    return *failed;
  if (result_.verdict == Conclusion::kNoEffect)
    result_.would_have_seen = SmallestSeen(contest.null(), levels_, magnitudes_, problem_.registry());
  const double cpu_s = static_cast<double>(std::clock() - before_.begun_at) / CLOCKS_PER_SEC;
  result_.simulations = simulations();
  if (!result_.search_complete)
    result_.notes.push_back(
        fmt::format("the search has spent its budget, {:.0f} simulations of the data and {:.3g} s of CPU time: this is "
                    "what was reached by then; --most-simulations and --most-cpu let it go on",
                    result_.simulations, cpu_s));
  std::vector<std::string> names;
  for (const std::size_t i : settled.causes) names.push_back(contest.contestants[i].Name());
  result_.journal.push_back(
      {"verdict", std::move(names), settled.rule, {}, ToString(result_.verdict) + ": " + result_.reason});
  options_.progress("done", 1.0);
  return std::move(result_);
}

double Pipeline::simulations() const {
  return before_.simulations + static_cast<double>(levels_.simulations() + parts_.held_out->simulations());
}

Pipeline::Pipeline(std::unique_ptr<EstimationProblem> problem, Plan begun, Parts parts,
                   const std::vector<MappedRecord>& data, const std::vector<MappedRecord>& holdout,
                   const DiagnoseOptions& options, const Before& before)
    : owned_(std::move(problem)),
      problem_(*owned_),
      begun_(std::move(begun)),
      parts_(std::move(parts)),
      levels_(*parts_.training),
      data_(data),
      holdout_(holdout),
      options_(options),
      magnitudes_(MagnitudesOf(problem_)),
      saved_(options.out + "/diagnose_state.json", options.resume, problem_.plan(), data),
      given_(LeftOf(holdout.empty() ? begun_ : problem_.plan(), *parts_.held_out)),
      before_(before) {
  result_.notes = before.notes;
  result_.journal = before.journal;
  result_.own_holdout = !holdout.empty();
  if (holdout.empty()) result_.notes.push_back("the last 30 % of the data are the hold-out");
}

bool Pipeline::Spent() const {
  const double cpu_s = static_cast<double>(std::clock() - before_.begun_at) / CLOCKS_PER_SEC;
  return before_.simulations + static_cast<double>(levels_.simulations()) >= options_.most_simulations ||
         cpu_s >= options_.most_cpu_s;
}

std::vector<Hum> Pipeline::HumBesides(const Contestant& one) {
  const std::size_t free = levels_.free_run();
  if (before_.took_hum_off >= kMostHum || PredictionWindow(begun_) || !one.Holds(free) || IsExact(one.levels[free]))
    return {};
  left_by_ = one.hypothesis.At(one.levels[free].q);
  return FindHum(problem_, *left_by_);
}

std::optional<Drifts> Pipeline::DriftsBesides(const Contest& contest) {
  if (before_.took_drifts_off >= kMostDrifts || Spent()) return {};
  std::optional<Drifts> drifts =
      FindDrifts(begun_, contest.contestants, levels_, levels_.free_run(), problem_.registry());
  if (!drifts) return {};
  before_.simulations += static_cast<double>(drifts->simulations);
  JournalEntry entry{
      "drifts of sensors",
      {drifts->beside, "the best model"},
      "left with all sensors drifting over what the best leaves, " + contest.pass(),
      {{"leaves", drifts->leaves}},
      fmt::format("{}{}", drifts->Found() ? "found" : "none", drifts->exact ? ", nothing but noise is left" : "")};
  for (const Drift& one : drifts->of_sensors) entry.numbers.emplace_back(one.signal + ", over its noise", one.of_noise);
  result_.journal.push_back(std::move(entry));
  return drifts->Found() ? drifts : std::nullopt;
}

Settled Pipeline::SettledOn(const Contest& contest, bool first) {
  std::vector<std::vector<HeldOut>> beside = {HeldOutOf(contest, *parts_.held_out, given_, !holdout_.empty())};
  const std::vector<HeldOut> own = beside.front();
  if (first) passes_.push_back(own), beside = passes_;
  return Settle(contest, levels_, own, LeastOf(beside, levels_.size()));
}

Result<Answer> Pipeline::Ask(Contestant null, bool released, const std::string& stage,
                             std::span<const Contestant> admitted) {
  const double from = 1.0 - std::pow(0.5, asked_++);
  if (!null.Holds(levels_.free_run()) || !IsExact(null.levels[levels_.free_run()])) {
    if (LeavesNoise(problem_, null, levels_)) CountAsNoise(null, {&null, 1});
  }
  const Conduct conduct{[&](double share) { options_.progress(stage, from + 0.5 * (1.0 - from) * share); },
                        [&] { return Spent(); }, &saved_, stage};
  Result<Contest> contest =
      Compete(std::move(null), released, levels_, magnitudes_, problem_.registry(), conduct, admitted);
  if (!contest.ok()) return contest.failure();
  Settled settled;
  if (contest->complete) {
    if (const std::optional<std::size_t> exact = ExactLevel(*contest, levels_)) {
      const std::int64_t before = levels_.simulations();
      CarryTwins(*contest, levels_, *exact, magnitudes_);
      contest->cost.push_back({"twins", levels_.simulations() - before});
    } else {
      const Contestant* best = LeaderAt(contest->contestants, levels_, levels_.free_run());
      if (best != nullptr && LeavesNoise(problem_, *best, levels_)) CountAsNoise(*best, contest->contestants);
    }
    settled = SettledOn(*contest, contest->null().hypothesis.effects().empty());
  } else {
    result_.search_complete = false;
    settled.level = contest->first;
    settled.rule = "the search has spent its budget";
    settled.reason = "the search ended before any effect was followed to the free run";
  }
  Enter(*contest, settled, stage);
  return Answer{*std::move(contest), std::move(settled)};
}

Result<Answer> Pipeline::AskOnTop(const Contestant& base, const Contest& before) {
  Result<Answer> answer = Ask(base, before.released, "with " + base.Name());
  if (!answer.ok() || !answer->settled.exact || Spent()) return answer;
  const estimation::Hypothesis nominal = NullHypothesis(begun_, before.released, levels_, problem_.registry());
  const std::int64_t counted = levels_.simulations();
  const bool any = CarryTwinsOfBase(answer->contest, before, nominal, levels_, answer->settled.level, magnitudes_);
  answer->contest.cost = {{"twins of what it is on top of", levels_.simulations() - counted}};
  if (any) SettleAgain(*answer);
  return answer;
}

std::optional<Answer> Pipeline::SeveralNumbers(const Contest& under_priors, const Contestant& released) {
  if (!under_priors.complete) return {};
  const Contestant& null = under_priors.null();
  const std::int64_t counted = levels_.simulations();
  std::optional<Contestant> exact = ByNumbersAlone(null, released, levels_);
  if (!exact) return {};
  const auto far = FarFromPriors(*exact, null, levels_);
  if (far.empty()) return {};
  Contest contest = CompeteByChanges(under_priors, *exact, levels_, magnitudes_, problem_.registry(), kMostCauses);
  contest.cost = {{"changes of numbers", levels_.simulations() - counted}};
  Settled settled;
  if (contest.contestants.size() > 1) settled = SettledOn(contest, false);
  // Changes of which the records show ratios alone make up for each other: one set of them is as good as another.
  const bool make_up = std::ranges::any_of(
      settled.causes, [&](std::size_t i) { return !IdleEffects(contest.contestants[i], settled.level).empty(); });
  if (contest.contestants.size() == 1 || make_up) {
    settled = Settled();
    settled.rule = "the model's own numbers, let go together";
    settled.level = levels_.free_run();
    settled.exact = true;
    TellNumbers(far, settled);
    contest.released = true;
    contest.contestants = {*std::move(exact)};
  }
  result_.journal.push_back({"numbers",
                             {"nominal model"},
                             "let go together they leave nothing but noise",
                             far,
                             make_up                  ? "changes of several of them make up for each other"
                             : settled.causes.empty() ? "no three of them suffice"
                                                      : contest.contestants[settled.causes.front()].Name()});
  Enter(contest, settled, "numbers let go together");
  Answer answer{std::move(contest), std::move(settled)};
  if (std::optional<Answer> other = FromItsHalves(answer, under_priors)) return other;
  return answer;
}

void Pipeline::TellNumbers(const std::vector<std::pair<std::string, double>>& far, Settled& settled) {
  std::vector<std::string> names;
  for (const auto& [path, off] : far) names.push_back(path);
  settled.verdict = Conclusion::kUnexplained;
  settled.reason =
      fmt::format("nominal values alone, far from their priors, leave nothing but noise: {}", fmt::join(names, ", "));
}

std::optional<Answer> Pipeline::BegunOtherwise(const Answer& answer) {
  const auto& [contest, settled] = answer;
  // What leaves nothing but noise on the training data alone may stand for what these alone show.
  const std::optional<std::size_t> told = settled.causes.empty() ? settled.best : settled.causes.front();
  if (!settled.exact || !told || !contest.null().hypothesis.effects().empty() || Spent()) return {};
  const Plan begun = identification::WithStartsWritten(problem_, begun_);
  const estimation::Hypothesis hypothesis = NullHypothesis(begun, contest.released, levels_, problem_.registry());
  const std::size_t level = settled.level, numbers = hypothesis.parameters().size();
  if (numbers == contest.null().hypothesis.parameters().size()) return {};
  const Contestant& cause = contest.contestants[*told];
  const auto fit_from = [&](const Contestant& other, const estimation::EstimatorOptions& how) {
    const Eigen::VectorXd start = StartFrom(hypothesis, other.hypothesis, other.levels[level].q);
    return estimation::Fit(hypothesis, levels_[level], start, how);
  };
  // A start moves a linear run along columns that do not change: where a few steps come nowhere near the noise, none does.
  const Contestant& null = contest.null();
  estimation::Estimate fit;
  if (null.Holds(level)) {
    const estimation::KnownColumns known{&null.hypothesis, &null.levels[level]};
    fit =
        fit_from(null, {.points = policy::kRoughPoints, .of_excess = policy::kLookedAt, .near = true, .known = known});
  }
  if (!null.Holds(level) || !fit.ok() || IsNearTheNoise(fit))
    fit = fit_from(cause, {.renewals = 6, .of_excess = policy::kCarriedTo});
  if (!fit.ok()) return {};
  fit = AsLoudAs(null, level, std::move(fit));
  const double worse = LeftMore(fit, cause.levels[level], levels_.data());
  const bool exact = IsExact(fit), stands = exact && worse < policy::kAsWell;
  JournalEntry entry{"start",
                     {cause.Name(), "nominal model, its start free"},
                     "a start that no first sample shows, " + levels_.Name(level),
                     {{"leaves_more", worse}},
                     stands   ? "leaves nothing but noise, and is taken"
                     : !exact ? "leaves more than noise"
                              : "told apart"};
  for (std::size_t i = 0; i < numbers; ++i) {
    const estimation::Parameter& own = hypothesis.parameters()[i];
    if (own.name.starts_with("of_record."))
      entry.numbers.emplace_back(own.name, own.ValueAt(fit.q[static_cast<Eigen::Index>(i)]));
  }
  result_.journal.push_back(std::move(entry));
  if (!stands) return {};
  Contestant with_start = NullOf(begun, contest.released, levels_, problem_.registry());
  with_start.levels[level] = fit;
  Result<Answer> next = Ask(std::move(with_start), contest.released, "with a start of its own");
  if (!next.ok() || !next->contest.complete) return {};
  begun_ = begun;
  return *std::move(next);
}

Contestant Pipeline::ReleasedNull() const {
  Contestant null = NullOf(begun_, true, levels_, problem_.registry());
  if (!null.Holds(0) || IsNearTheNoise(null.levels[0])) return null;
  const Result<Plan> started = identification::FindStarts(problem_, null.hypothesis.At(null.levels[0].q));
  if (!started.ok()) return null;
  Eigen::VectorXd from = null.levels[0].q;
  for (std::size_t i = 0; i < null.hypothesis.parameters().size(); ++i) {
    const estimation::Parameter& own = null.hypothesis.parameters()[i];
    if (own.name.starts_with("of_record."))
      from[static_cast<Eigen::Index>(i)] = own.CoordinateOf(started->root.NumberOr(own.name, own.reference));
  }
  if (from == null.levels[0].q) return null;
  Contestant again(null.hypothesis);
  FitAlong(again, levels_, from);
  const bool far_less = again.Holds(0) && LogLeft(again.levels[0], levels_) <
                                              LogLeft(null.levels[0], levels_) - std::log(policy::kMarginBest);
  return far_less ? again : null;
}

Answer Pipeline::WithFurtherCauses(Answer answer) {
  std::optional<Answer> before;
  for (int causes = 1; causes < kMostCauses && !answer.settled.exact && answer.contest.complete; ++causes) {
    const Contest& contest = answer.contest;
    std::vector<Base> bases;
    if (!Spent() && contest.null().hypothesis.effects().empty()) {
      const Conduct conduct{[](double) {}, [&] { return Spent(); }, &saved_, "pairs, " + contest.pass()};
      const std::int64_t counted = levels_.simulations();
      bases = BasesOfPairs(contest, levels_, magnitudes_, problem_.registry(), conduct);
      result_.journal.push_back({"simulations",
                                 {},
                                 conduct.stage,
                                 {{"second look", static_cast<double>(levels_.simulations() - counted)}},
                                 ""});
    }
    const std::optional<std::size_t> base = BaseOf(contest, answer.settled, bases, levels_, result_.journal);
    if (!base || Spent()) break;
    const Contestant& null = contest.contestants[*base];
    Result<Answer> next = AskOnTop(null, contest);
    if (!next.ok()) break;
    if (!Adds(answer, *next)) {
      if (FoundLater(next->contest, *base, answer)) SettleAgain(answer);
      break;
    }
    before = std::exchange(answer, *std::move(next));
  }
  if (!before) return answer;
  if (DoesWithout(answer, *before)) {
    SettleAgain(*before);
    return *std::move(before);
  }
  if (EffectsIn(answer) == 2) {
    if (std::optional<Answer> other = FromItsHalves(answer, before->contest)) return *std::move(other);
  }
  return answer;
}

std::optional<Answer> Pipeline::FromItsHalves(const Answer& answer, const Contest& alone) {
  const auto& [contest, settled] = answer;
  if (!settled.exact || settled.causes.size() != 1) return {};
  const Contestant& all = contest.contestants[settled.causes.front()];
  double off = OffNominal(all, settled.level);
  if (off < policy::kImplausible) return {};
  if (Spent()) return Unasked(answer);
  const auto& asked = contest.null().hypothesis.effects();
  std::vector<Contestant> halves;
  for (const estimation::Hypothesis::Applied& effect : all.hypothesis.effects()) {
    if (std::ranges::count(asked, effect) == 0) halves.push_back(HalfOf(all, effect, settled.level, alone));
  }
  std::ranges::stable_sort(halves, std::ranges::greater(), &Contestant::share);
  std::optional<Answer> best;
  bool unasked = false;
  for (const Contestant& half : halves) {
    unasked = Spent();
    if (off < policy::kImplausible || unasked) break;
    Result<Answer> other = AskOnTop(half, alone);
    unasked = other.ok() && !other->contest.complete;
    if (!other.ok() || !other->settled.exact || other->settled.causes.empty()) continue;
    const double instead = OffNominal(other->contest.contestants[other->settled.causes.front()], other->settled.level);
    if (instead + policy::kImplausible <= off) best = *std::move(other), off = instead;
  }
  if (off >= policy::kImplausible && unasked) return Unasked(best ? *std::move(best) : answer);
  return best;
}

Answer Pipeline::Unasked(Answer answer) {
  result_.search_complete = false;
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

Contestant Pipeline::HalfOf(const Contestant& all, const estimation::Hypothesis::Applied& effect, std::size_t level,
                            const Contest& alone) const {
  const auto known = std::ranges::find_if(alone.contestants, [&](const Contestant& one) {
    return std::ranges::equal(one.hypothesis.effects(), std::span(&effect, 1));
  });
  if (known != alone.contestants.end()) return *known;
  Contestant half(NullHypothesis(begun_, alone.released, levels_, problem_.registry())
                      .With(*effect.effect, effect.place, magnitudes_));
  FitAlong(half, levels_, StartFrom(half.hypothesis, all.hypothesis, all.levels[level].q));
  return half;
}

bool Pipeline::DoesWithout(Answer& answer, Answer& before) {
  if (!answer.settled.exact || answer.settled.causes.empty()) return false;
  const std::size_t level = answer.settled.level;
  Contestant& all = answer.contest.contestants[answer.settled.causes.front()];
  PolishAt(level, all, answer.contest.null());
  const Contestant& null = before.contest.null();
  for (const Idle& idle : IdleEffects(all, level)) {
    estimation::Hypothesis others = NullHypothesis(begun_, answer.contest.released, levels_, problem_.registry());
    for (std::size_t i = 0; i < all.hypothesis.effects().size(); ++i) {
      const auto& [effect, place] = all.hypothesis.effects()[i];
      if (i != idle.effect) others = others.With(*effect, place, magnitudes_);
    }
    Contestant without(std::move(others));
    without.levels.resize(levels_.size());
    for (estimation::Estimate& fit : without.levels) fit.broken = "not fitted";
    without.levels[level] = all.levels[level];
    without.levels[level].q = StartFrom(without.hypothesis, all.hypothesis, idle.q);
    if (!PolishAt(level, without, null)) continue;
    const Contestant both[] = {all, without};
    if (Weights(both, levels_, level, RowsCount::kByBlock).Beats(0, 1)) continue;
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

bool Pipeline::PolishAt(std::size_t level, Contestant& one, const Contestant& null) {
  return Polish(one, null, levels_, level, problem_.plan());
}

bool Pipeline::FoundLater(const Contest& later, std::size_t model, Answer& answer) {
  const std::size_t level = levels_.free_run();
  if (!later.null().Holds(level) || !IsExact(later.null().levels[level])) return false;
  answer.contest.contestants[model].levels = later.null().levels;
  return true;
}

void Pipeline::SettleAgain(Answer& answer) {
  answer.settled = SettledOn(answer.contest, false);
  Enter(answer.contest, answer.settled, "with what was found later");
}

void Pipeline::Enter(const Contest& contest, const Settled& settled, const std::string& stage) {
  JournalEntry base{"null model", {contest.null().Name()}, "RMS over what noise alone causes, " + stage, {}, ""};
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    const estimation::Estimate& fit = contest.null().levels[level];
    if (fit.ok())
      base.numbers.emplace_back(levels_.Name(level), TimesNoise(fit));
    else
      base.outcome += levels_.Name(level) + ": " + fit.broken + "; ";
  }
  JournalEntry looked{"first look",
                      {},
                      "share of what the null leaves, " + stage,
                      {},
                      fmt::format("{} are carried", contest.contestants.size() - 1)};
  for (const auto* some : {&contest.contestants, &contest.left_behind}) {
    for (const Contestant& one : *some) {
      if (one.share > 0.0) looked.numbers.emplace_back(one.Name(), one.share);
    }
  }
  JournalEntry cost{"simulations", {}, stage, {}, ""};
  for (const Contest::Cost& one : contest.cost)
    cost.numbers.emplace_back(one.stage, static_cast<double>(one.simulations));
  Journal& journal = result_.journal;
  journal.push_back(std::move(base));
  journal.push_back(std::move(looked));
  journal.insert(journal.end(), settled.journal.begin(), settled.journal.end());
  journal.push_back(std::move(cost));
}

void Pipeline::StandBeside(const Answer& answer, const std::vector<std::string>& alike) {
  std::vector<std::string> names;
  for (const std::size_t i : answer.settled.causes) names.push_back(answer.contest.contestants[i].Name());
  names.insert(names.end(), alike.begin(), alike.end());
  const bool few = names.size() <= policy::kMostAlike;
  result_.verdict = few ? Conclusion::kAmbiguous : Conclusion::kUnexplained;
  result_.reason = fmt::format("{}: {}", few ? "these records do not separate" : "too many leave nothing but noise",
                               fmt::join(names, ", "));
}

}  // namespace dynoproof::diagnosis
