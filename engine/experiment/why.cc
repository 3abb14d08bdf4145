#include "experiment/why.h"

#include <fmt/format.h>

#include <cmath>

#include "base/within.h"
#include "score/explain.h"

namespace dynoproof {
namespace {

/// "3.4 instead of 3.1", with as many digits as it takes to tell them apart.
std::string InsteadOf(double test, double reference) {
  constexpr int kUsual = 6, kAll = 17;
  for (int digits = kUsual;; ++digits) {
    const std::string had = fmt::format("{:.{}g}", test, digits), wanted = fmt::format("{:.{}g}", reference, digits);
    if (had != wanted || digits == kAll) return had + " instead of " + wanted;
  }
}

}  // namespace

Reason Why(const score::Series& reference, const score::Series& test, double threshold, const std::string& unit,
           double from_s) {
  const score::Aligned aligned = score::AlignTo(reference, test);
  if (!aligned.ok()) return {aligned.reason, ""};
  std::size_t first = aligned.test.size(), worst = 0;
  for (std::size_t i = 0; i < aligned.test.size(); ++i) {
    const double error = std::abs(aligned.test[i] - reference.values[i]);
    if (!Within(error, threshold) && first == aligned.test.size() && reference.time_s[i] >= from_s) first = i;
    if (error > std::abs(aligned.test[worst] - reference.values[worst])) worst = i;
  }
  if (first == aligned.test.size()) first = worst;
  std::string text = fmt::format("apart from t = {:.6g} s on ({} {}), most by {:.3g} at t = {:.6g} s",
                                 reference.time_s[first], InsteadOf(aligned.test[first], reference.values[first]), unit,
                                 std::abs(aligned.test[worst] - reference.values[worst]), reference.time_s[worst]);
  score::ExplainOptions options;
  options.unit = unit;
  const score::Explanation cause = score::Explain(reference, test, options);
  if (!cause.ok()) return {text, ""};
  // How much it explains, and what else would, stands in the text.
  const std::string named = cause.text.substr(0, cause.text.find(" (explains"));
  if (cause.cause == score::Cause::kNone) return {text + "; " + cause.text, ""};
  return {text + "; likely cause: " + cause.text, named};
}

}  // namespace dynoproof
