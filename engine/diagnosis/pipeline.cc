#include "diagnosis/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "diagnosis/as_given.h"
#include "diagnosis/changed_numbers.h"
#include "diagnosis/describe.h"
#include "diagnosis/detection.h"
#include "diagnosis/further_causes.h"
#include "diagnosis/own_numbers.h"
#include "diagnosis/own_start.h"
#include "diagnosis/policy.h"
#include "identification/start.h"
#include "model/kept_modes.h"

namespace dynoproof::diagnosis {
namespace {

/// Nominal values account for the records as the causes do: they stand beside these.
void StandBeside(const Answer& answer, const std::vector<std::string>& alike, Diagnosis& result) {
  std::vector<std::string> names;
  for (const std::size_t i : answer.settled.causes) names.push_back(answer.contest.contestants[i].Name());
  names.insert(names.end(), alike.begin(), alike.end());
  const bool few = names.size() <= policy::kMostAlike;
  result.verdict = few ? Conclusion::kAmbiguous : Conclusion::kUnexplained;
  result.reason = fmt::format("{}: {}", few ? "these records do not separate" : "too many leave nothing but noise",
                              fmt::join(names, ", "));
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
  if (std::optional<Answer> as_given = AsGiven(inquiry_)) return *std::move(as_given);
  Contestant nominal = inquiry_.Null(false);
  hum_ = HumBesides(nominal);
  if (!hum_.empty()) return Answer{Contest(), Settled()};
  Result<Answer> answer = inquiry_.Ask(std::move(nominal), false, Contest::Pass(false));
  if (!answer.ok()) return answer.failure();
  std::optional<Drifts> drifts;
  if (!answer->settled.exact) {
    if (!before_.read_again && !inquiry_.Spent())
      course_ = OtherCourse(inquiry_.begun(), answer->contest, inquiry_.levels(), inquiry_.registry());
    if (course_) return answer;
    drifts = DriftsBesides(answer->contest);
    if (drifts && drifts->Plainly()) {
      drifts_ = drifts;
      return answer;
    }
  }
  Answer further = WithFurtherCauses(inquiry_, *answer);
  if (further.settled.exact) {
    answer = std::move(further);
  } else if (drifts && drifts->Suffice()) {
    drifts_ = drifts;
    return answer;
  } else if (!inquiry_.Spent()) {
    released_ = ReleasedNull(inquiry_);
    if (std::optional<Answer> numbers = SeveralNumbers(inquiry_, answer->contest, *released_))
      return *std::move(numbers);
    answer = WithNumbersReleased(*std::move(answer), std::move(further));
  }
  if (std::optional<Answer> otherwise = BegunOtherwise(inquiry_, *answer)) answer = *std::move(otherwise);
  const Contestant* best = LeaderAt(answer->contest.contestants, inquiry_.levels(), inquiry_.levels().free_run());
  if (answer->settled.exact || best == nullptr || inquiry_.Spent()) return answer;
  hum_ = HumBesides(*best);
  if (hum_.empty()) drifts_ = answer->contest.released ? DriftsBesides(answer->contest) : drifts;
  return answer;
}

Answer Pipeline::WithNumbersReleased(Answer first, Answer further) {
  std::vector<Contestant> admitted;
  for (const std::size_t i : first.settled.causes) admitted.push_back(first.contest.contestants[i]);
  Result<Answer> released = inquiry_.Ask(*released_, true, Contest::Pass(true), admitted);
  if (!released.ok() || !released->contest.complete) return first;
  if (released->settled.verdict == Conclusion::kNoEffect) {
    const auto far = FarFromPriors(released->contest.null(), first.contest.null(), inquiry_.levels());
    if (!far.empty()) TellNumbers(far, released->settled);
  }
  if (!released->settled.exact && !inquiry_.SettledFirst(first.contest).causes.empty()) return further;
  return WithFurtherCauses(inquiry_, *std::move(released));
}

Result<Answer> Pipeline::DecideAsPlainlyAs(const Answer& other) {
  const auto asked = [&](const Contestant& null, bool released) {
    Result<Answer> answer = inquiry_.Ask(null, released, Contest::Pass(released));
    if (answer.ok() && EffectsIn(other) > 1) answer = WithFurtherCauses(inquiry_, *std::move(answer));
    return answer;
  };
  Result<Answer> answer = asked(inquiry_.Null(false), false);
  if (!answer.ok() || answer->settled.exact || !other.contest.released || inquiry_.Spent()) return answer;
  released_ = inquiry_.Null(true);
  return asked(*released_, true);
}

std::vector<Hum> Pipeline::HumIn(const std::vector<MappedRecord>& others) const {
  if (others.empty() || !left_by_) return {};
  return FindHum({problem_->plan(), others, inquiry_.registry()}, *left_by_);
}

std::vector<Drift> Pipeline::DriftsInHoldout() const {
  if (holdout_.empty()) return {};
  return DriftsBeside(drifts_->model.At(drifts_->q), inquiry_.held_out(), inquiry_.held_out().free_run());
}

Result<Diagnosis> Pipeline::Report(Answer answer) {
  options_.progress("what it gains", 0.97);
  auto& [contest, settled] = answer;
  const Levels& levels = inquiry_.levels();
  for (const std::size_t i : settled.causes) inquiry_.FinishAt(settled.level, contest.contestants[i], contest.null());
  if (settled.exact && settled.best)
    inquiry_.PolishAt(settled.level, contest.contestants[*settled.best], contest.null());
  settled = AtTheEnd(std::move(settled), contest);
  Diagnosis result;
  result.verdict = settled.verdict;
  result.reason = settled.reason;
  result.notes = before_.notes;
  result.own_holdout = !holdout_.empty();
  if (holdout_.empty()) result.notes.push_back("the last 30 % of the data are the hold-out");
  result.search_complete = inquiry_.complete();
  result.journal = inquiry_.journal();
  const std::vector<std::string> alike = NominalValuesAlike(*problem_, answer, levels, result.journal);
  if (!alike.empty()) StandBeside(answer, alike, result);
  if (Status failed = Describe({*problem_, inquiry_.begun(), data_, holdout_, options_}, levels, contest, settled,
                               released_, alike, result))
    return *failed;
  if (result.verdict == Conclusion::kNoEffect)
    result.would_have_seen = SmallestSeen(contest.null(), levels, inquiry_.magnitudes(), inquiry_.registry());
  result.simulations = simulations();
  if (!result.search_complete)
    result.notes.push_back(
        fmt::format("the search has spent its budget, {:.0f} simulations of the data and {:.3g} s of CPU time: this is "
                    "what was reached by then; --most-simulations and --most-cpu let it go on",
                    result.simulations, inquiry_.cpu_s()));
  std::vector<std::string> names;
  for (const std::size_t i : settled.causes) names.push_back(contest.contestants[i].Name());
  result.journal.push_back(
      {"verdict", std::move(names), settled.rule, {}, ToString(result.verdict) + ": " + result.reason});
  options_.progress("done", 1.0);
  return result;
}

Pipeline::Pipeline(std::unique_ptr<EstimationProblem> problem, Plan begun, Parts parts,
                   const std::vector<MappedRecord>& data, const std::vector<MappedRecord>& holdout,
                   const DiagnoseOptions& options, const Before& before)
    : problem_(std::move(problem)),
      data_(data),
      holdout_(holdout),
      options_(options),
      before_(before),
      inquiry_(*problem_, std::move(begun), std::move(parts), data, !holdout.empty(), options, before) {}

std::vector<Hum> Pipeline::HumBesides(const Contestant& one) {
  const std::size_t free = inquiry_.levels().free_run();
  if (before_.took_hum_off >= kMostHum || PredictionWindow(inquiry_.begun()) || !one.Holds(free) ||
      IsExact(one.levels[free]))
    return {};
  left_by_ = one.hypothesis.At(one.levels[free].q);
  return FindHum(*problem_, *left_by_);
}

std::optional<Drifts> Pipeline::DriftsBesides(const Contest& contest) {
  if (before_.took_drifts_off >= kMostDrifts || inquiry_.Spent()) return {};
  const Levels& levels = inquiry_.levels();
  std::optional<Drifts> drifts =
      FindDrifts(inquiry_.begun(), contest.contestants, levels, levels.free_run(), inquiry_.registry());
  if (!drifts) return {};
  inquiry_.Count(static_cast<double>(drifts->simulations));
  JournalEntry entry{
      "drifts of sensors",
      {drifts->beside, "the best model"},
      "left with all sensors drifting over what the best leaves, " + contest.pass(),
      {{"leaves", drifts->leaves}},
      fmt::format("{}{}", drifts->Found() ? "found" : "none", drifts->exact ? ", nothing but noise is left" : "")};
  for (const Drift& one : drifts->of_sensors) entry.numbers.emplace_back(one.signal + ", over its noise", one.of_noise);
  inquiry_.journal().push_back(std::move(entry));
  return drifts->Found() ? drifts : std::nullopt;
}

}  // namespace dynoproof::diagnosis
