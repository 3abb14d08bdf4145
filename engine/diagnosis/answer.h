// An answer is a contest with its verdict; here is how two answers compare, and which nominal values would answer as well.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/contest.h"
#include "diagnosis/journal.h"
#include "diagnosis/settle.h"
#include "identification/estimation_problem.h"

namespace dynoproof::diagnosis {

/// Which effect on top of a null explains what that leaves.
struct Answer {
  Contest contest;
  Settled settled;
};

/// How many effects the first of an answer's causes has.
std::size_t EffectsIn(const Answer& answer);

/// Whether a cause, or one of several that stand side by side, leaves nothing but noise.
bool IsExactCause(const Answer& answer);

/// Whether an answer with a cause in the model says more than the one before. Where several causes stood side by side, only
/// one of these, or a model that leaves nothing, tells that two of them are needed.
bool Adds(const Answer& before, const Answer& next);

/// Nominal values that no effect stands for, and which alone, let go, account for the records as the causes do.
std::vector<std::string> NominalValuesAlike(const identification::EstimationProblem& problem, const Answer& answer,
                                            const Levels& levels, Journal& journal);

}  // namespace dynoproof::diagnosis
