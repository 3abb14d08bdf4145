// What a record that a scenario does not account for may be instead: in another unit, or with columns exchanged. Each
// guess is tried: it is named where the scenario accounts for the record with it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "experiment/records.h"
#include "identification/estimation_problem.h"

namespace dynoproof::identification {

/// The usual cause of a factor, e.g. "about 1000: a prefix: kilo or milli?"; nothing where it is none of the known ones.
/// `unit`: what the signal should be in, "1" where nobody says. A pressure knows no turns.
std::optional<std::string> CauseOfFactor(double factor, const std::string& unit);

struct Suspect {
  std::string text;  // "T_shaft and omega_1 exchanged"
  double nrmse = 0.0;
  /// An exchange or a known factor, with which the scenario leaves a hundredth of the squares: no model is wrong so.
  bool certain = false;
  std::vector<MappedRecord> records = {};  // as they were meant then
  std::string kind = {}, column = {};      // "sign", "swapped" or "unit", and the first signal of it
};

/// What leaves less than half of the distance from the prediction of `plan` when records are read otherwise, least
/// distance first: inputs larger or smaller, an output in another unit or with another sign, two signals exchanged. Empty
/// where that distance is no reason to ask. Fails where a run breaks.
Result<std::vector<Suspect>> SuspectsOf(const EstimationProblem& problem, const Plan& plan);

/// The readings of a record under which a run that it corrects with a short memory leaves less than a third, least distance first
/// (those that leave the same in the order in which signals come near their nominal values): an output or the inputs with the other
/// sign, two signals exchanged, an output, the inputs or all signals of a unit in another one. Such a run shows the forces, which
/// a model that is some per cent off has right to some per cent: a free run of it is soon out of step with any reading. Empty
/// where nothing is compared, or the record as it is is near.
std::vector<Suspect> MisreadingsOf(const Plan& plan, const MappedRecord& record, const Registry& registry);

/// Whether a scenario that leaves `nrmse` accounts for what it is asked.
bool AccountsFor(double nrmse);

/// The largest correlation of an output with the prediction of `plan`; 0 where a run breaks.
double LargestCorrelation(const EstimationProblem& problem, const Plan& plan);

}  // namespace dynoproof::identification
