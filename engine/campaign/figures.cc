#include "campaign/figures.h"

#include <cmath>

namespace dynoproof::campaign {

void FigureSpec::Check(Faults& faults) const {
  if (of.empty() == from.empty()) faults.At("of", "a figure needs exactly one of \"of\" and \"from\"");
  if (of.empty() != take.empty())
    faults.At("take", of.empty() ? "belongs to \"of\"" : "is missing: what is taken of the signal?", "take = \"peak\"");
  if (!(at_least <= at_most))  // NaN: is a fault
    faults.At("at_least", "no number is at least this and at most that");
}

std::string FigureSpec::Fault(const std::string& name, double value) const {
  if (!limited()) return "";
  if (!std::isfinite(value)) return fmt::format("{} has no value", name);
  if (!(value >= at_least))  // NaN: is a fault
    return fmt::format("{} is {:.6g}, at least {:.6g} is asked for", name, value, at_least);
  if (!(value <= at_most))  // NaN: is a fault
    return fmt::format("{} is {:.6g}, at most {:.6g} is allowed", name, value, at_most);
  return "";
}

double FigureSpec::Used(double value) const {
  if (std::isfinite(at_least) && std::isfinite(at_most))
    return std::abs(value - 0.5 * (at_least + at_most)) / (0.5 * (at_most - at_least));
  // 590 of at most 600, -610 where at most -600 is allowed; for "at least" the other way round.
  if (std::isfinite(at_most)) return at_most > 0.0 ? value / at_most : at_most / value;
  return at_least > 0.0 ? at_least / value : value / at_least;
}

std::string FigureSpec::Limits(const std::string& name, double value) const {
  std::string text = fmt::format("{} is {:.6g}", name, value);
  if (std::isfinite(at_least)) text += fmt::format(", at least {:.6g} is asked for", at_least);
  if (std::isfinite(at_most)) text += fmt::format(", at most {:.6g} is allowed", at_most);
  return text;
}

double Take(const FigureSpec& figure, const score::Series& course) {
  const std::span<const double> time = course.time_s, values = course.values;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double largest = -1.0, when = kNone, most = kNone, least = kNone, sum = 0.0, squares = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (time[i] < figure.after_s) continue;
    const double value = values[i];
    if (!std::isfinite(value)) return kNone;
    if (std::abs(value) > largest) {
      largest = std::abs(value);
      when = time[i];
    }
    most = count == 0 || value > most ? value : most;
    least = count == 0 || value < least ? value : least;
    sum += value;
    squares += value * value;
    ++count;
  }
  if (count == 0) return kNone;
  const auto n = static_cast<double>(count);
  if (figure.take == "peak") return largest;
  if (figure.take == "peak_s") return when;
  if (figure.take == "max") return most;
  if (figure.take == "min") return least;
  if (figure.take == "mean") return sum / n;
  if (figure.take == "rms") return std::sqrt(squares / n);
  return values.back();
}

std::string UnitOf(const FigureSpec& figure, const std::string& unit) { return figure.take == "peak_s" ? "s" : unit; }

}  // namespace dynoproof::campaign
