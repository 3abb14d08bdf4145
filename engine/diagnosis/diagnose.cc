#include "diagnosis/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "diagnosis/follow_play.h"
#include "diagnosis/judgement.h"
#include "diagnosis/resolution.h"
#include "linear/decompositions.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kLonger = 1.5;   // from one beginning to the next
constexpr double kOpening = 0.3;  // of the time

/// A diagnosis and what it is made of.
struct Task {
  const Plan& plan;
  const std::vector<MappedRecord>& data;   // at the resolution that counts
  const std::vector<MappedRecord>& given;  // the same as given
  const std::vector<MappedRecord>& holdout;
  const Registry& registry;
  const DiagnoseOptions& options;
  identification::SearchContext context;  // of all its problems

  double training() const { return holdout.empty() ? kTrainingShare : 1.0; }
  EstimationProblem Part(const Plan& of, double until) const {
    return EstimationProblem(of, data, registry, training() * until, context);
  }
  Judgement Of(const EstimationProblem& problem, double until) const {
    return Judgement(problem, training() * until, until, data, given, holdout, options);
  }
};

/// As much of the records as `followed` predicts, with it among the candidates; nothing if it does not stand there.
std::optional<Result<Diagnosis>> DiagnoseFollowed(const Task& task, const EstimationProblem& problem,
                                                  const Followed& followed) {
  // Of motion that is known to be chaotic no more is predicted than what was followed.
  const bool all = followed.share == 1.0 && !PredictionWindow(task.plan);
  const double until = all ? 1.0 : task.training() * followed.share;
  const EstimationProblem beginning = task.Part(problem.plan(), until);
  Judgement first = task.Of(beginning, until);
  if (first.Decide("diagnose_state_beginning.json", {followed.hypothesis})) return std::nullopt;
  const std::vector<Hypothesis> causes = first.Causes();
  if (causes.empty() || !causes.front().effects.front().SameCause(followed.hypothesis.effects.front()))
    return std::nullopt;
  first.Widen(followed.drift);
  if (until < 1.0) {
    first.Note(
        fmt::format("only the first {:.3g} s of the data count: with play the motion is chaotic, and no free run "
                    "predicts more of it",
                    until * task.data.front().end_s));
  }
  return first.Report();
}

/// Of a scenario that is compared in windows, since its motion is chaotic: what explains its first milliseconds in a
/// free run, followed as far as it goes. In windows the nominal model is off by the whole signal as soon as the sides
/// meet at another time than they did, and then nothing can be seen beside it.
std::optional<Result<Diagnosis>> DiagnoseBeginning(const Task& task) {
  Plan free = task.plan;
  free.root.Erase("prediction_window_s");
  const EstimationProblem problem = task.Part(free, 1.0);
  DiagnoseOptions said = task.options;
  said.progress = [&](const std::string& what, double done) {
    task.options.progress("the beginning: " + what, kOpening * done);
  };
  const Task beginning{task.plan, task.data, task.given, task.holdout, task.registry, said, task.context};
  std::vector<Hypothesis> causes;
  double from = 0.0;
  for (double share = FirstShare(problem.records()); share < 1.0 && !problem.spent(); share *= kLonger) {
    const EstimationProblem part = task.Part(free, share);
    Judgement opening = beginning.Of(part, share);
    if (opening.Decide("diagnose_state_opening.json") || opening.LeavesStructure()) break;
    causes = opening.Causes();
    from = share;
  }
  const auto progress = [&](double done) { said.progress("following what explains it", done); };
  const std::optional<Followed> followed = Follow(problem, from, causes, progress);
  return followed ? DiagnoseFollowed(task, problem, *followed) : std::nullopt;
}

}  // namespace

std::string FoundParameter::Text(double number) const {
  const double wide = upper - lower, large = std::max(std::abs(lower), std::abs(upper));
  const double told = wide > 0.0 && std::isfinite(wide) ? std::ceil(std::log10(large / wide)) : 0.0;
  return fmt::format("{:.{}g}", number, static_cast<int>(std::clamp(told + 2.0, 4.0, 15.0)));
}

std::string KeepTo(std::size_t most, std::vector<MappedRecord>& records) {
  std::size_t samples = 0;
  for (const MappedRecord& record : records) {
    for (const auto& [name, series] : record.outputs) samples += series.values->size();
  }
  if (samples <= most) return "";
  const double share = static_cast<double>(most) / static_cast<double>(samples);
  for (MappedRecord& record : records) CutRecord(record, share);
  return fmt::format("only the first {:.3g} % of the records are looked at: of {} samples no more than {}",
                     100.0 * share, samples, most);
}

Result<Diagnosis> Diagnose(const Plan& plan, const std::vector<MappedRecord>& given,
                           const std::vector<MappedRecord>& holdout, const Registry& registry,
                           const DiagnoseOptions& options) {
  const std::vector<MappedRecord> data = AtResolution(given);
  double record_s = 0.0;
  for (const MappedRecord& record : data) record_s += record.end_s;
  const auto allowance =
      std::make_shared<identification::Allowance>(record_s, options.most_simulations, options.most_cpu_s);
  const Task task{plan, data, given, holdout, registry, options, {.allowance = allowance}};
  if (PredictionWindow(plan)) {
    if (std::optional<Result<Diagnosis>> beginning = DiagnoseBeginning(task)) return *std::move(beginning);
  }
  const EstimationProblem problem = task.Part(plan, 1.0);
  Judgement whole = task.Of(problem, 1.0);
  if (Status failed = whole.Decide("diagnose_state.json")) return *failed;
  if (!whole.LeavesStructure() || problem.spent()) return whole.Report();
  const auto progress = [&](double done) { options.progress("following play from the beginning", 0.96 + 0.01 * done); };
  if (const std::optional<Followed> followed = FollowPlay(problem, progress)) {
    if (std::optional<Result<Diagnosis>> beginning = DiagnoseFollowed(task, problem, *followed))
      return *std::move(beginning);
  }
  return whole.Report();
}

}  // namespace dynoproof::diagnosis
