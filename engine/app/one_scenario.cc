#include "app/one_scenario.h"

#include <vector>

#include "scenario/find.h"

namespace dynoproof::app {

std::optional<std::string> OneScenario(const std::string& name, Diagnostics& diagnostics) {
  const std::vector<std::string> files = FindScenarios(name, diagnostics);
  if (files.size() > 1) diagnostics.Error({name}, "is a folder", "name one scenario");
  return files.size() == 1 ? std::optional(files.front()) : std::nullopt;
}

}  // namespace dynoproof::app
