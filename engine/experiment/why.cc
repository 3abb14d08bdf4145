#include "experiment/why.h"

#include <fmt/format.h>

#include <cmath>

#include "base/within.h"
#include "score/explain.h"

namespace dynoproof {

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
  std::string text =
      fmt::format("apart from t = {:.6g} s on ({:.6g} instead of {:.6g} {}), most by {:.3g} at t = {:.6g} s",
                  reference.time_s[first], aligned.test[first], reference.values[first], unit,
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
