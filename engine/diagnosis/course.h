// What inputs do between their samples, asked once more where a first guess was made beside a model that lacks the cause.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/contest.h"
#include "diagnosis/levels.h"

namespace dynoproof::diagnosis {

struct Course {
  std::string between;  // as a map says it
  std::string beside;   // the model
  double times = 1.0;   // as much that model leaves with it (RMS beyond the noise) as with what was guessed
};

/// A guess beside the nominal model compares courses by what that leaves, which is mostly the missing cause. A model with the cause
/// tells them apart, once it is fitted with each of them: what was fitted with a wrong one has taken that up. Asked of what leads a contest
/// at its first level and in the free run. Nothing where no
/// course leaves clearly less than all models with the guess, where every input is stated, or where a run has no ticks between samples.
std::optional<Course> OtherCourse(const Plan& plan, const Contest& contest, const Levels& levels,
                                  const Registry& registry);

/// The records with those of their inputs on that course of which nobody says it.
std::vector<MappedRecord> OnCourse(std::vector<MappedRecord> records, const Plan& plan, const std::string& between);

}  // namespace dynoproof::diagnosis
