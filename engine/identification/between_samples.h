// What the inputs of a record do between their samples, told by its own outputs: a held signal taken as an analogue one,
// or the reverse, is half a sample out of step, which looks like a gain, a lag or a delay.
#pragma once

#include <string>
#include <vector>

#include "experiment/records.h"
#include "model/plan.h"
#include "model/registry.h"

namespace dynoproof::identification {

struct BetweenFit {
  std::string between;  // as a map says it
  double nrmse = 0.0;   // of all outputs, geometric mean
};

/// The distance of the record from what `plan` predicts, by what the inputs of which nobody says it do between their
/// samples; "held" is first. The run is corrected by the record with a short memory: an input that is half a sample late is an error
/// of force, which innovations show at once, while a free run accumulates whatever else the model lacks. Empty where every input is stated, or
/// nothing can be compared.
std::vector<BetweenFit> CompareBetween(const Plan& plan, const Registry& registry, const MappedRecord& record);

/// Whether one of them leaves no doubt: less than half of what any other leaves.
bool IsClear(const std::vector<BetweenFit>& fits, const std::string& between);

/// Lets those inputs do what leaves the least distance, or to be held where that is hardly less (a guess, as the record then says),
/// and notes the comparison where it makes a difference.
void ChooseBetween(const Plan& plan, const Registry& registry, MappedRecord& record);

/// The record with all inputs of which nobody says it doing this.
MappedRecord WithBetween(MappedRecord record, const Plan& plan, const std::string& between);

/// What those inputs may do: to go band-limited takes equal steps.
std::vector<std::string> PossibleBetween(const Plan& plan, const MappedRecord& record);

/// Inputs of which neither map nor scenario says what they do between their samples.
std::vector<std::string> UnstatedInputs(const Plan& plan, const MappedRecord& record);

}  // namespace dynoproof::identification
