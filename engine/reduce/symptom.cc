#include "reduce/symptom.h"

#include <cmath>
#include <limits>

#include "score/share.h"

namespace dynoproof::reduce {

constexpr double kFarther = 10.0;  // a check that is so much further beyond its limit fails for another reason

std::string WithoutNumbers(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool digit = (c >= '0' && c <= '9') || (c == '.' && !out.empty() && out.back() == '#');
    if (!digit) out += c;
    if (digit && (out.empty() || out.back() != '#')) out += '#';
  }
  return out;
}

bool Symptom::Same(const Symptom& other) const {
  if (name != other.name || number != other.number) return false;
  return number ? other.share <= kFarther * share : words == other.words;
}

Symptom SymptomOf(const score::Check& check) {
  Symptom one{.name = WithoutNumbers(check.name), .check = check};
  one.share = score::ShareOfLimit(check);
  one.number = std::isfinite(check.value) && std::isfinite(check.limit);
  if (!std::isfinite(one.share)) one.share = std::numeric_limits<double>::infinity();
  if (!one.number) one.words = WithoutNumbers(check.explanation);
  return one;
}

}  // namespace dynoproof::reduce
