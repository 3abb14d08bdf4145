// From the fits of a contest to a verdict: the rows of a table, of which the first that applies decides.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/conclusion.h"
#include "diagnosis/contest.h"
#include "diagnosis/journal.h"

namespace dynoproof::diagnosis {

/// By level: logarithm of what a model leaves beyond the noise on data that took no part, over what the plan as given leaves
/// there. Nothing: that run breaks.
struct LeftThere {
  double log_excess = 0.0;
  bool exact = false;  // nothing is left there but noise
};
using HeldOut = std::vector<std::optional<LeftThere>>;

struct Settled {
  Conclusion verdict = Conclusion::kUnexplained;
  std::vector<std::size_t> causes;  // of Contest::contestants: one, or those that cannot be told apart
  std::optional<std::size_t> best;  // that removes most, where no cause is named
  double best_explains = 0.0;       // the share of it on data that took no part
  double explains = 0.0;            // the same of a main cause, of several that stand side by side the most
  std::size_t level = 0;            // at which was compared
  bool exact = false;               // a model leaves nothing but noise there
  std::string rule, reason;
  Journal journal;
};

/// Whether this contest decides by exactness: a model leaves nothing but noise, in the free run or at the longest level
/// below that makes noise no louder. Then the weights of models against each other decide, the priors where these do not, and the
/// share of the null's excess that is removed.
std::optional<std::size_t> ExactLevel(const Contest& contest, const Levels& levels);

/// `held_out`: by contestant. `least`: the smallest over this and any other contest, by level.
Settled Settle(const Contest& contest, const Levels& levels, const std::vector<HeldOut>& held_out,
               const std::vector<double>& least);

/// The verdict where no further cause is looked for. A first of several causes may explain little; what stands at the end, alone or in
/// a set, explains half of what is wrong on data that took no part, or leaves nothing but noise with the numbers of such a machine:
/// not where each of the causes, led to its minimum, has a nominal value at the end of what its prior allows. Of right causes they lie
/// within one or two deviations.
Settled AtTheEnd(Settled settled, const Contest& contest);

}  // namespace dynoproof::diagnosis
