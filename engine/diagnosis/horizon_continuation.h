// What the whole of a record hides and its beginning shows. With a gap in it a line forgets within tenths of a second
// where it came from: no free run predicts more, and no slope leads from one gap to another, since how often the sides
// meet changes in between. Dry friction sticks and slips, and how often it does changes in the same way. But the first
// few impacts or slips are predictable. A fit that reaches the noise there is followed through longer and longer parts.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "diagnosis/terms.h"
#include "identification/estimator.h"

namespace dynoproof::diagnosis {

/// A hypothesis as it is fitted to the beginning of the records.
struct Follower {
  Estimate fit;
  double likelihood = 0.0;  // -2 log, at the noise that fits best by channel, with the nuisance parameters' prior
  double over = 0.0;        // RMS of what is left over the noise floor, of the worst channel
};
/// Fitted to `here` as if the noise were white, whose colour parts this short do not tell; nothing where a run breaks.
std::optional<Follower> Fitted(const EstimationProblem& here, const Hypothesis& hypothesis, int rounds);
/// The same for many effects, each alone beside the nuisance parameters as `about` has them, which follow linearly.
/// Best first.
std::vector<Follower> FittedBeside(const EstimationProblem& here, const Hypothesis& about,
                                   const std::vector<EffectInstance>& effects);
void BestFirst(std::vector<Follower>& followers);

struct Followed {
  Hypothesis hypothesis;
  std::vector<Hypothesis> alike;  // others that came as far and may still be as good, the best first
  double share = 0.0;             // of the study's records that a free run predicts to the noise; 1: all of them
  /// How far off its numbers were on shorter parts, in the effect's units: where motion is chaotic a fit comes to rest
  /// beside its place, and may be as far off itself. Empty with relatives.
  std::vector<double> drift;
};
/// Hypotheses akin to the one that leads on the beginning `here`, for where it comes short.
using Relatives = std::function<std::vector<Hypothesis>(const EstimationProblem& here, const Hypothesis& leader)>;

/// Follows `starts`, fitted to the share `first` of the study: the best of those that reach the noise farthest.
/// `study`: all of the training data, without prediction windows. With `relatives` a leader may be above the noise for
/// a while, and only the leader's own come with it; without, a part counts as long as it only sharpens what one a
/// stride shorter has told. Nothing where nobody comes twice as far, or where a longer free run would tell more than it
/// does: what it misses later must be no more than what finer substeps change, or, of signals that move slowly, the
/// nuisance parameters.
std::optional<Followed> Follow(const EstimationProblem& problem, double first, std::vector<Hypothesis> starts,
                               const std::function<void(double)>& progress, const Relatives& relatives = {});

}  // namespace dynoproof::diagnosis
