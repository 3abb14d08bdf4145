// What a diagnosis compared, by which rule and with which numbers: so that a reader follows how a verdict came about.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace dynoproof::diagnosis {

struct JournalEntry {
  std::string
      stage;  // "null model", "first look", "comparison", "start", "ambiguity", "residual tests", "verdict", ...
  std::vector<std::string> compared;  // candidates, "nominal model" or signals
  std::string rule;
  std::vector<std::pair<std::string, double>> numbers;  // by name, in the order in which the rule takes them
  std::string outcome;
};
using Journal = std::vector<JournalEntry>;

/// The array "journal" of a result; a number that is not finite is null.
nlohmann::json ToJson(const Journal& journal);
/// The same as text, one entry a paragraph.
std::string ToText(const Journal& journal);

}  // namespace dynoproof::diagnosis
