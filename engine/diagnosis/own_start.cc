#include "diagnosis/own_start.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/policy.h"
#include "identification/start.h"

namespace dynoproof::diagnosis {
namespace {

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

std::optional<Answer> BegunOtherwise(Inquiry& inquiry, const Answer& answer) {
  const auto& [contest, settled] = answer;
  const Levels& levels = inquiry.levels();
  // What leaves nothing but noise on the training data alone may stand for what these alone show.
  const std::optional<std::size_t> told = settled.causes.empty() ? settled.best : settled.causes.front();
  if (!settled.exact || !told || !contest.null().hypothesis.effects().empty() || inquiry.Spent()) return {};
  const Plan begun = identification::WithStartsWritten(inquiry.problem(), inquiry.begun());
  const estimation::Hypothesis hypothesis = NullHypothesis(begun, contest.released, levels, inquiry.registry());
  const std::size_t level = settled.level, numbers = hypothesis.parameters().size();
  if (numbers == contest.null().hypothesis.parameters().size()) return {};
  const Contestant& cause = contest.contestants[*told];
  const auto fit_from = [&](const Contestant& other, const estimation::EstimatorOptions& how) {
    const Eigen::VectorXd start = StartFrom(hypothesis, other.hypothesis, other.levels[level].q);
    return estimation::Fit(hypothesis, levels[level], start, how);
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
  const double worse = LeftMore(fit, cause.levels[level], levels.data());
  const bool exact = IsExact(fit), stands = exact && worse < policy::kAsWell;
  JournalEntry entry{"start",
                     {cause.Name(), "nominal model, its start free"},
                     "a start that no first sample shows, " + levels.Name(level),
                     {{"leaves_more", worse}},
                     stands   ? "leaves nothing but noise, and is taken"
                     : !exact ? "leaves more than noise"
                              : "told apart"};
  for (std::size_t i = 0; i < numbers; ++i) {
    const estimation::Parameter& own = hypothesis.parameters()[i];
    if (own.name.starts_with("of_record."))
      entry.numbers.emplace_back(own.name, own.ValueAt(fit.q[static_cast<Eigen::Index>(i)]));
  }
  inquiry.journal().push_back(std::move(entry));
  if (!stands) return {};
  Contestant with_start = NullOf(begun, contest.released, levels, inquiry.registry());
  with_start.levels[level] = fit;
  Result<Answer> next = inquiry.Ask(std::move(with_start), contest.released, "with a start of its own");
  if (!next.ok() || !next->contest.complete) return {};
  inquiry.Begin(begun);
  return *std::move(next);
}

}  // namespace dynoproof::diagnosis
