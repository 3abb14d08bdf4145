#include "reports/score_card.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dynoproof::reports {

using score::Check;

std::string Badge(score::Verdict verdict) {
  return fmt::format("<span class=\"verdict {0}\">{0}</span>", score::ToString(verdict));
}

std::string ValueText(double value, const std::string& unit) {
  if (!std::isfinite(value)) return "–";
  return Escape(fmt::format("{:.4g}{}", value, unit == "1" || unit.empty() ? "" : " " + unit));
}

std::string LimitText(const Check& check) {
  if (!check.shown.empty() && check.unit == "half-widths") return "the tube";
  return (check.at_least ? "at least " : "at most ") + ValueText(check.limit, check.unit);
}

Cell ValueCell(const Check& check) {
  if (check.shown.empty()) return {ValueText(check.value, check.unit), "number"};
  return {Escape(check.shown), "wide"};
}

std::string ScoreCard(const std::vector<Check>& all) {
  if (all.empty()) return "<p>No check was made.</p>\n";
  std::vector<const Check*> checks;
  for (const Check& check : all) checks.push_back(&check);
  std::stable_sort(checks.begin(), checks.end(), [](const Check* a, const Check* b) {
    return a->verdict != b->verdict && score::Worse(a->verdict, b->verdict) == a->verdict;
  });
  std::string rows, last, seen;  // one reason often serves many checks in a row
  for (const Check* check : checks) {
    const std::string origin = check->origin == last ? "as above" : check->origin;
    last = check->origin;
    const std::string explanation = check->explanation == seen && !seen.empty() ? "as above" : check->explanation;
    seen = check->explanation;
    rows += Row(std::vector<Cell>{{Escape(check->name)},
                                  {Escape(check->kind)},
                                  {Badge(check->verdict)},
                                  ValueCell(*check),
                                  {LimitText(*check), "number"},
                                  {Escape(origin), "wide"},
                                  {Escape(explanation), "wide"}});
  }
  return Table(std::vector<Cell>{{"check"},
                                 {"kind"},
                                 {"verdict"},
                                 {"value", "number"},
                                 {"limit", "number"},
                                 {"why this limit"},
                                 {"what was seen"}},
               rows);
}

}  // namespace dynoproof::reports
