// Sections of a plant whose entries have fixed names: [plant.volume.between], [plant.valves.intake].
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/params.h"

namespace dynoproof {

/// True when the section has exactly these names; else each that is missing or unknown is a fault.
template <class T, std::size_t N>
bool CheckNames(Faults& faults, const char* section, const std::vector<std::pair<std::string, T>>& entries,
                const char* const (&names)[N]) {
  bool good = true;
  for (const char* name : names) {
    if (std::none_of(entries.begin(), entries.end(), [name](const auto& entry) { return entry.first == name; })) {
      faults.At(section, fmt::format("\"{}\" is missing", name), fmt::format("write [plant.{}.{}]", section, name));
      good = false;
    }
  }
  for (const auto& entry : entries) {
    if (std::none_of(std::begin(names), std::end(names), [&](const char* name) { return entry.first == name; })) {
      faults.At(section, fmt::format("there is no \"{}\" here", entry.first));
      good = false;
    }
  }
  return good;
}

/// The entry of that name, which CheckNames() has found.
template <class T>
const T& Named(const std::vector<std::pair<std::string, T>>& entries, std::string_view name) {
  return std::find_if(entries.begin(), entries.end(), [name](const auto& entry) { return entry.first == name; })
      ->second;
}

}  // namespace dynoproof
