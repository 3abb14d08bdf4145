#include "trace/csv_cut.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace dynoproof::trace::csv {

CutCheck::Form CutCheck::FormOf(std::string_view cell) {
  Form form;
  const std::size_t exponent = cell.find_first_of("eEdD");
  if (exponent != std::string_view::npos) form.exponent = cell.size() - exponent;
  bool after_mark = false, leading = true;
  std::size_t zeros = 0;
  for (const char c : cell.substr(0, exponent)) {
    if (c == '.' || c == ',') after_mark = true;
    if (std::isdigit(static_cast<unsigned char>(c)) == 0) continue;
    leading = leading && c == '0';
    ++(leading ? zeros : form.significant);
    if (after_mark) ++form.decimals;
  }
  if (form.significant == 0) form.significant = zeros;  // a zero is as precise as it is written
  return form;
}

void CutCheck::Take(std::string_view cell) {
  if (any_) {
    if (above_++ == 0) first_ = last_;
    same_form_ = same_form_ && last_.decimals == first_.decimals && last_.exponent == first_.exponent;
    ++with_digits_[std::min(last_.significant, with_digits_.size() - 1)];
  }
  last_ = FormOf(cell);
  any_ = true;
}

bool CutCheck::MayBeCut(std::span<const double> values) const {
  constexpr std::size_t kFewest = 3;
  if (above_ < kFewest || values.size() < 2) return false;
  if (same_form_ && (first_.decimals > 0 || first_.exponent > 0)) {
    return last_.decimals < first_.decimals || last_.exponent < first_.exponent;
  }
  std::size_t shorter = 0;  // cells above that have at most as many digits as the last
  for (std::size_t n = 0; n <= last_.significant && n < with_digits_.size(); ++n) shorter += with_digits_[n];
  if (2 * shorter < above_) return true;
  if (last_.decimals > 0 || last_.exponent > 0) return false;
  double largest = 0.0;
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double step = std::abs(values[i] - values[i - 1]);
    if (step > largest) largest = step;
  }
  return std::abs(values.back() - values[values.size() - 2]) > largest;
}

}  // namespace dynoproof::trace::csv
