// [plant.parameter]: numbers of a plant by name, places of `parameter_change`.
#pragma once

#include <string>
#include <vector>

#include "model/plant_traits.h"

namespace dynoproof {

/// The numbers of a plan's section, each known as a data sheet knows it.
inline std::vector<NuisanceParameter> ParametersInSection(const Plan& plan) {
  constexpr double kOfADataSheet = 0.02;  // assumed; [prior] states it of each number
  std::vector<NuisanceParameter> numbers;
  const Value* section = plan.root.FindPath("plant.parameter");
  for (const std::string& name : section != nullptr ? KeysOf(*section) : std::vector<std::string>())
    numbers.push_back({"plant.parameter." + name, true, kOfADataSheet, "a number of a data sheet"});
  return numbers;
}

/// The value of a state at t = 0, which a record that begins in motion shows.
inline NuisanceParameter StartInMotion(const std::string& path, double nominal) {
  NuisanceParameter start{path, false, nominal, "a state begins within its usual magnitude", true};
  start.only_in_motion = true;
  return start;
}

}  // namespace dynoproof
