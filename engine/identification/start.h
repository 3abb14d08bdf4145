// The state that a record starts from, where that is not the scenario's: cut out of a longer one, it begins in motion.
// Each record has its own, in the numbers that the plant declares for it (PlantTraits::nuisances, `initial`).
#pragma once

#include "base/status.h"
#include "identification/estimation_problem.h"

namespace dynoproof::identification {

/// Whether a record of the problem begins otherwise than its plan does: by its first samples.
bool BeginsInMotion(const EstimationProblem& problem, std::size_t record = 0);

/// The plan with the start of each record that is `in_motion` (StartOfRecord()) by least squares, all else as it is. For
/// a linear plant this is the optimum, else one step towards it. Fails where a run breaks.
Result<Plan> FitStarts(const EstimationProblem& problem, Plan plan);

}  // namespace dynoproof::identification
