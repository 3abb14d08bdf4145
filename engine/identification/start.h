// The state that a record starts from, where that is not the scenario's: cut out of a longer one, it begins in motion.
// Each record has its own, in the numbers that the plant declares for it (PlantTraits::nuisances, `initial`).
#pragma once

#include <string>

#include "base/status.h"
#include "experiment/prepare.h"
#include "identification/estimation_problem.h"

namespace dynoproof::identification {

/// "omega_1 at 0.772 rad/s and not 0, ..." where the first record of the problem begins otherwise than its plan does, by
/// its first samples; else empty, also where a run breaks.
std::string MotionAtStart(const EstimationProblem& problem);

/// The share of a hold-out in motion that its start is fitted to, and that is not judged.
inline constexpr double kStartShare = 0.1;

/// The plan with the start of each record that is `in_motion` (StartOfRecord()) by least squares over the first share
/// `until` of the record, all else as it is. For a linear plant this is the optimum, else one step towards it. Fails
/// where a run breaks.
Result<Plan> FitStarts(const EstimationProblem& problem, Plan plan, double until = 1.0);

/// The same for any plant: over the first few samples, where friction and play still hold what they began with, and from there
/// over ever more of the first share, each time by steps while these halve what is left. Records that one step explains as well
/// are left at that.
Result<Plan> FindStarts(const EstimationProblem& problem, const Plan& plan, double until = 1.0);

/// The plan with the start that it has, written down for each record, where a hypothesis may move it.
Plan WithStartsWritten(const EstimationProblem& problem, Plan plan);

/// The start found of one record, for runs of it. Empty where the record begins as the plan does, or the plant declares no start.
Result<Start> StartOf(const Plan& plan, const MappedRecord& record, const Registry& registry);

/// "plant.shaft.k1.initial_twist_rad = 0.00123, ...", for a note.
std::string ToText(const Start& start);

}  // namespace dynoproof::identification
