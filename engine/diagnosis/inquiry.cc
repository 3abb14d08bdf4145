#include "diagnosis/inquiry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/twins.h"
#include "identification/residual_tests.h"

namespace dynoproof::diagnosis {
namespace {

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

}  // namespace

Inquiry::Inquiry(const EstimationProblem& problem, Plan begun, Parts parts, const std::vector<MappedRecord>& data,
                 bool own_holdout, const DiagnoseOptions& options, const Before& before)
    : problem_(problem),
      begun_(std::move(begun)),
      parts_(std::move(parts)),
      own_holdout_(own_holdout),
      options_(options),
      magnitudes_(MagnitudesOf(problem_)),
      saved_(options.out + "/diagnose_state.json", options.resume, problem_.plan(), data),
      given_(LeftOf(own_holdout ? problem_.plan() : begun_, held_out())),
      begun_at_(before.begun_at),
      simulations_before_(before.simulations),
      journal_(before.journal) {}

Result<Answer> Inquiry::Ask(Contestant null, bool released, const std::string& stage,
                            std::span<const Contestant> admitted) {
  const double from = 1.0 - std::pow(0.5, asked_++);
  if (!null.Holds(levels().free_run()) || !IsExact(null.levels[levels().free_run()])) {
    if (LeavesNoise(problem_, null, levels())) CountAsNoise(null, {&null, 1});
  }
  const Conduct conduct =
      ConductOf(stage, [&](double share) { options_.progress(stage, from + 0.5 * (1.0 - from) * share); });
  Result<Contest> contest = Compete(std::move(null), released, levels(), magnitudes_, registry(), conduct, admitted);
  if (!contest.ok()) return contest.failure();
  const bool first_cause = contest->null().hypothesis.effects().empty();
  Settled settled;
  if (contest->complete) {
    if (const std::optional<std::size_t> exact = ExactLevel(*contest, levels())) {
      const std::int64_t before = levels().simulations();
      CarryTwins(*contest, levels(), *exact, magnitudes_);
      contest->cost.push_back({"twins", levels().simulations() - before});
    } else {
      const Contestant* best = LeaderAt(contest->contestants, levels(), levels().free_run());
      if (best != nullptr && LeavesNoise(problem_, *best, levels())) CountAsNoise(*best, contest->contestants);
    }
    const std::vector<HeldOut> own = OnHeldOut(*contest);
    std::vector<std::vector<HeldOut>> beside = {own};
    if (first_cause) passes_.push_back(own), beside = passes_;
    settled = Settle(*contest, levels(), own, LeastOf(beside, levels().size()));
  } else {
    Cut();
    settled.level = contest->first;
    settled.rule = "the search has spent its budget";
    settled.reason = "the search ended before any effect was followed to the free run";
  }
  Enter(*contest, settled, stage);
  return Answer{*std::move(contest), std::move(settled)};
}

Result<Answer> Inquiry::AskOnTop(const Contestant& base, const Contest& before) {
  Result<Answer> answer = Ask(base, before.released, "with " + base.Name());
  if (!answer.ok() || !answer->settled.exact || Spent()) return answer;
  const estimation::Hypothesis nominal = NullModel(before.released);
  const std::int64_t counted = levels().simulations();
  const bool any = CarryTwinsOfBase(answer->contest, before, nominal, levels(), answer->settled.level, magnitudes_);
  answer->contest.cost = {{"twins of what it is on top of", levels().simulations() - counted}};
  if (any) SettleAgain(*answer);
  return answer;
}

Settled Inquiry::SettledAlone(const Contest& contest) const {
  const std::vector<HeldOut> own = OnHeldOut(contest);
  return Settle(contest, levels(), own, LeastOf({own}, levels().size()));
}

Settled Inquiry::SettledFirst(const Contest& contest) const {
  return Settle(contest, levels(), passes_.front(), LeastOf(passes_, levels().size()));
}

void Inquiry::SettleAgain(Answer& answer) {
  answer.settled = SettledAlone(answer.contest);
  Enter(answer.contest, answer.settled, "with what was found later");
}

void Inquiry::FinishAt(std::size_t level, Contestant& one, const Contestant& null) {
  if (one.Holds(level) && IsExact(one.levels[level])) PolishAt(level, one, null);
  if (!Spent()) Count(FitToAll(one, levels(), level, parts_.fitted, begun_, registry()));
}

Conduct Inquiry::ConductOf(const std::string& stage, std::function<void(double)> progress) {
  return {std::move(progress), [this] { return Spent(); }, &saved_, stage};
}

bool Inquiry::Spent() const {
  return simulations_before_ + static_cast<double>(levels().simulations()) >= options_.most_simulations ||
         cpu_s() >= options_.most_cpu_s;
}

double Inquiry::simulations() const {
  return simulations_before_ + static_cast<double>(levels().simulations() + held_out().simulations());
}

void Inquiry::Enter(const Contest& contest, const Settled& settled, const std::string& stage) {
  JournalEntry base{"null model", {contest.null().Name()}, "RMS over what noise alone causes, " + stage, {}, ""};
  for (std::size_t level = 0; level < levels().size(); ++level) {
    const estimation::Estimate& fit = contest.null().levels[level];
    if (fit.ok())
      base.numbers.emplace_back(levels().Name(level), TimesNoise(fit));
    else
      base.outcome += levels().Name(level) + ": " + fit.broken + "; ";
  }
  JournalEntry looked{"first look", {}, "share of what the null leaves, " + stage, {}, ""};
  std::size_t not_fitted = 0;
  for (const auto* some : {&contest.contestants, &contest.left_behind}) {
    for (const Contestant& one : *some) {
      const bool fitted = one.Holds(contest.first) || one.Holds(contest.first + 1);
      if (fitted && one.share > 0.0) looked.numbers.emplace_back(one.Name(), one.share);
      if (!fitted && some == &contest.left_behind) ++not_fitted;
    }
  }
  looked.outcome = fmt::format("{} are carried", contest.contestants.size() - 1);
  if (not_fitted > 0)
    looked.outcome +=
        fmt::format(", {} are not fitted, for the best leaves nothing but noise in the free run", not_fitted);
  JournalEntry cost{"simulations", {}, stage, {}, ""};
  for (const Contest::Cost& one : contest.cost)
    cost.numbers.emplace_back(one.stage, static_cast<double>(one.simulations));
  journal_.push_back(std::move(base));
  journal_.push_back(std::move(looked));
  journal_.insert(journal_.end(), settled.journal.begin(), settled.journal.end());
  journal_.push_back(std::move(cost));
}

std::vector<HeldOut> Inquiry::OnHeldOut(const Contest& contest) const {
  return HeldOutOf(contest, held_out(), given_, own_holdout_);
}

}  // namespace dynoproof::diagnosis
