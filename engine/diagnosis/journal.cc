#include "diagnosis/journal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace dynoproof::diagnosis {

nlohmann::json ToJson(const Journal& journal) {
  nlohmann::json out = nlohmann::json::array();
  for (const JournalEntry& entry : journal) {
    nlohmann::json numbers = nlohmann::json::object();
    for (const auto& [name, number] : entry.numbers)
      numbers[name] = std::isfinite(number) ? nlohmann::json(number) : nlohmann::json();
    out.push_back({{"stage", entry.stage},
                   {"compared", entry.compared},
                   {"rule", entry.rule},
                   {"numbers", numbers},
                   {"outcome", entry.outcome}});
  }
  return out;
}

std::string ToText(const Journal& journal) {
  constexpr std::size_t kShown = 8;  // the JSON has all of them
  std::string text = "\n  how the verdict came about\n";
  for (const JournalEntry& entry : journal) {
    const std::size_t shown = std::min(entry.compared.size(), kShown);
    text += fmt::format(
        "    {}: {}{}\n      rule: {}\n", entry.stage,
        fmt::join(entry.compared.begin(), entry.compared.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
        shown < entry.compared.size() ? fmt::format(" and {} more", entry.compared.size() - shown) : "", entry.rule);
    std::vector<std::string> numbers;
    for (const auto& [name, number] : entry.numbers) numbers.push_back(fmt::format("{} {:.4g}", name, number));
    if (!numbers.empty()) text += fmt::format("      {}\n", fmt::join(numbers, ", "));
    text += fmt::format("      -> {}\n", entry.outcome);
  }
  return text;
}

}  // namespace dynoproof::diagnosis
