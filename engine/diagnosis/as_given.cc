#include "diagnosis/as_given.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "diagnosis/policy.h"
#include "identification/noise_model.h"

namespace dynoproof::diagnosis {
namespace {

/// RMS over the noise in the channel where that is most; infinite where the plan breaks.
double FarthestOf(const Plan& plan, const Levels& levels) {
  const Result<Eigen::VectorXd> rows = levels[levels.free_run()].Innovations(plan);
  if (!rows.ok()) return std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (const estimation::Channel& channel : levels.data().channels())
    most = std::max(most, identification::RmsOf(rows->segment(channel.begin, channel.count)) / channel.noise);
  return most;
}

}  // namespace

std::optional<Answer> AsGiven(Inquiry& inquiry) {
  const Levels& levels = inquiry.levels();
  const std::size_t free = levels.free_run();
  Contestant null(inquiry.NullModel(false));
  const Eigen::VectorXd given = null.hypothesis.start();
  const Plan plan = null.hypothesis.At(given);
  const double fitted = FarthestOf(plan, levels);
  if (!(fitted <= policy::kFarBelowNoise)) return std::nullopt;
  const double held_out = FarthestOf(inquiry.own_holdout() ? inquiry.problem().plan() : plan, inquiry.held_out());
  if (!(held_out <= policy::kFarBelowNoise)) return std::nullopt;
  null.levels.resize(levels.size());
  for (estimation::Estimate& one : null.levels) one.broken = "nothing is left to explain";
  null.levels[free] = estimation::Fit(null.hypothesis, levels[free], given, {.renewals = 1, .points = 1, .near = true});
  if (!null.Holds(free)) return std::nullopt;
  Answer answer;
  answer.contest.first = free;
  answer.contest.contestants.push_back(std::move(null));
  Settled& settled = answer.settled;
  settled.verdict = Conclusion::kNoEffect;
  settled.level = free;
  settled.exact = true;
  settled.rule = "the plan as given leaves far less than noise (" + levels.Name(free) + ")";
  settled.reason = "the model as given predicts the records far closer than they count as measured";
  inquiry.journal().push_back({"as given",
                               {answer.contest.null().Name()},
                               "RMS of the free run over the noise, in the channel where that is most",
                               {{"fitted part", fitted}, {"hold-out", held_out}, {"limit", policy::kFarBelowNoise}},
                               "nothing is left to explain"});
  return answer;
}

}  // namespace dynoproof::diagnosis
