#include "thesis/suppression_subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace dynoproof::campaign {

const std::vector<FigureInfo>& SuppressionStudy::Figures() {
  static const std::vector<FigureInfo> figures = {
      {"unstable_modes", "1"}, {"found", "1"},           {"placements", "1"},    {"false_placements", "1"},
      {"with_false", "1"},     {"unstable_at_end", "1"}, {"first_found_s", "s"}, {"peak", "N m"}};
  return figures;
}

void SuppressionStudy::Fill(const Parameters& parameters, std::uint64_t seed, Row& row) {
  const Result<SuppressionRun> result = RunCase(parameters, seed);
  if (!result.ok()) {
    row.why = result.failure().ToString();
    return;
  }
  const auto wrong = static_cast<double>(
      std::ranges::count_if(result->placements, [](const auto& placement) { return !placement.right; }));
  const auto unstable = static_cast<double>(result->unstable_Hz.size());
  row.figures = {unstable,
                 static_cast<double>(result->found),
                 static_cast<double>(result->placements.size()),
                 wrong,
                 wrong > 0.0 ? 1.0 : 0.0,
                 result->stable_at_end ? 0.0 : 1.0,
                 result->times.empty() ? std::numeric_limits<double>::quiet_NaN() : result->times.front(),
                 result->peak_Nm};
  row.verdict = result->stable_at_end && wrong == 0.0 ? score::Verdict::kPass : score::Verdict::kFail;
  if (!result->stable_at_end) row.why = "the loop is unstable at the end";
  if (wrong > 0.0) row.why += fmt::format("{}{} false placements", row.why.empty() ? "" : ", ", wrong);
}

}  // namespace dynoproof::campaign
