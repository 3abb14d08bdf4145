// Every setting of a scenario: what was given, where, and what was taken in place of what was not.
#pragma once

#include <string>
#include <vector>

#include "model/plan.h"
#include "model/registry.h"

namespace dynoproof {

struct Setting {
  std::string path;               // as for --set: "plant.inertia.I5"
  std::string value;              // as TOML has it
  std::string from;               // "scenarios/_chirp.toml:6", "--set"; "default" where nobody wrote it
  std::string unit, description;  // of a default; given ones carry the unit in their name
  std::string type = {};          // of a default: "number", "integer", ...
  static constexpr const char* kDefault = "default";
};

/// The settings in the order of writing, each plugin's defaults behind what was given; checks are left out.
std::vector<Setting> SettingsOf(const Plan& plan, const Registry& registry);

}  // namespace dynoproof
