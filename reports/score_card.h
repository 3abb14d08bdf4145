// Checks as every page shows them: verdict, value, limit, and why.
#pragma once

#include <string>
#include <vector>

#include "reports/html.h"
#include "score/verdict.h"

namespace dynoproof::reports {

/// The verdict as a coloured word.
std::string Badge(score::Verdict verdict);

/// "12.3 N m", escaped; a dash for what is no number.
std::string ValueText(double value, const std::string& unit);
/// "at most 5 us", escaped.
std::string LimitText(const score::Check& check);
/// The value of a check: a number in one line, or the sentence that a person reads, which may take several.
Cell ValueCell(const score::Check& check);

/// The checks as a table, the worst first.
std::string ScoreCard(const std::vector<score::Check>& checks);

}  // namespace dynoproof::reports
