#include "trace/time_base.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "base/text.h"

namespace dynoproof::trace {
namespace {

double UlpOf(double value) {
  const double size = std::abs(value);
  return std::nextafter(size, std::numeric_limits<double>::infinity()) - size;
}

double FloatUlpOf(double value) {
  const auto size = static_cast<float>(std::abs(value));
  return static_cast<double>(std::nextafter(size, std::numeric_limits<float>::infinity())) - static_cast<double>(size);
}

/// The most significant digits that a stamp has, written as short as may be; 0 where that is all that a double holds.
int SignificantDigits(const std::vector<double>& stamps) {
  constexpr int kDouble = 15;
  int most = 0;
  for (const double t : stamps) {
    std::array<char, 32> text;
    const auto end =
        std::to_chars(text.data(), text.data() + text.size(), std::abs(t), std::chars_format::scientific).ptr;
    const auto digits = static_cast<int>(std::find(text.data(), end, 'e') - text.data());
    most = std::max(most, digits > 1 ? digits - 1 : digits);  // without the point
    if (most > kDouble) return 0;
  }
  return most;
}

/// To what the stamps are known, in their own unit: the last decimal digit that they have, or what a number of their
/// size and kind can hold.
double ResolutionOf(const std::vector<double>& stamps) {
  double largest = 0.0;
  bool single = true;  // whole numbers are, too: their last digit says more
  for (const double t : stamps) {
    largest = std::max(largest, std::abs(t));
    single = single && static_cast<double>(static_cast<float>(t)) == t;
  }
  const double held = single ? FloatUlpOf(largest) : 4.0 * UlpOf(largest);
  double scale = 1.0;
  for (int digits = 0; digits <= 12 && 1.0 > 4.0 * held * scale; ++digits, scale *= 10.0) {
    const bool all = std::all_of(stamps.begin(), stamps.end(),
                                 [&](double t) { return std::abs(t * scale - std::round(t * scale)) <= held * scale; });
    if (all) return 1.0 / scale;
  }
  if (const int digits = SignificantDigits(stamps); digits > 0)
    return std::max(held, std::pow(10.0, std::floor(std::log10(largest)) - digits + 1));
  return held;
}

/// A grid t0 + k step through all instants.
struct Grid {
  double step = 0.0;
  std::vector<double> index;  // k, rising whole numbers from 0
  double range = 0.0;         // TimeBase::step_range, plain
  bool plain = false, exact = false;
};

/// Difference between the largest and the smallest distance of the instants from a grid.
double Scatter(const std::vector<double>& t, const std::vector<double>& index, double step) {
  double low = 0.0, high = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double off = t[i] - index[i] * step;
    low = std::min(low, off), high = std::max(high, off);
  }
  return high - low;
}

/// Least squares, of the distances from a first grid: of the stamps themselves sums would lose the digits that matter.
double StepThrough(const std::vector<double>& t, const std::vector<double>& index) {
  const double first = t.back() / index.back();
  double mean_off = 0.0, mean_k = 0.0, both = 0.0, square = 0.0;
  const auto n = static_cast<double>(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) mean_off += (t[i] - index[i] * first) / n, mean_k += index[i] / n;
  for (std::size_t i = 0; i < t.size(); ++i) {
    both += (t[i] - index[i] * first - mean_off) * (index[i] - mean_k);
    square += (index[i] - mean_k) * (index[i] - mean_k);
  }
  return first + both / square;
}

double Rounded(double value, int digits) {
  const double scale = std::pow(10.0, digits - 1 - static_cast<int>(std::floor(std::log10(value))));
  return std::round(value * scale) / scale;
}

/// How far a step may be changed, as a share of it, until the instants lie within `most` of its grid no more.
double RangeOf(const std::vector<double>& t, const std::vector<double>& index, double step, double most) {
  double range = 0.0;
  for (const double way : {-1.0, 1.0}) {
    // Half a step over the whole span is more than any digit that a grid was found with.
    double inside = 0.0, outside = 0.5 / index.back();
    for (int halving = 0; halving < 40; ++halving) {
      const double middle = 0.5 * (inside + outside);
      (Scatter(t, index, step * (1.0 + way * middle)) <= most ? inside : outside) = middle;
    }
    range = std::max(range, inside);
  }
  return range;
}

struct PlainStep {
  double step = 0.0;
  int digits = 0;
};

/// The step or rate of fewest digits that goes through all instants within `most`; `step` itself where none does.
PlainStep Plain(const std::vector<double>& t, const std::vector<double>& index, double step, double most,
                double unit_s) {
  constexpr int kMostDigits = 10;
  for (int digits = 1; digits <= kMostDigits; ++digits) {
    const double by_step = Rounded(step, digits), by_rate = 1.0 / (Rounded(1.0 / (step * unit_s), digits) * unit_s);
    for (const double candidate : {by_step, by_rate}) {
      if (Scatter(t, index, candidate) <= most) return {candidate, digits};
    }
  }
  return {step, kMostDigits + 1};
}

/// The grid that `guess` leads to, if all instants lie on it within `most`. `every`: no row is missing.
std::optional<Grid> GridFrom(const std::vector<double>& t, double guess, bool every, double most) {
  Grid grid{guess, std::vector<double>(t.size(), 0.0)};
  for (int round = 0; round < 6; ++round) {
    std::vector<double> index(t.size(), 0.0);
    for (std::size_t i = 1; i < t.size(); ++i)
      index[i] = index[i - 1] + (every ? 1.0 : std::max(1.0, std::round((t[i] - t[i - 1]) / grid.step)));
    const bool same = round > 0 && index == grid.index;
    grid.index = std::move(index);
    grid.step = StepThrough(t, grid.index);
    if (same) break;
  }
  if (!(grid.step > 0.0) || Scatter(t, grid.index, grid.step) > most) return std::nullopt;
  return grid;
}

/// `most`: each stamp may be off by half of what it is known to, and by round-off. `largest`: of the stamps in the file.
std::optional<Grid> UniformGrid(const std::vector<double>& t, double resolution, double most, double largest,
                                double unit_s) {
  if (t.size() < 3) return std::nullopt;
  std::vector<double> steps(t.size() - 1);
  for (std::size_t i = 0; i + 1 < t.size(); ++i) steps[i] = t[i + 1] - t[i];
  std::vector<double> sorted = steps;
  std::sort(sorted.begin(), sorted.end());
  const auto last_row = static_cast<double>(steps.size());  // from the first row to the last, none missing
  const double mean = t.back() / last_row;
  std::optional<Grid> grid = GridFrom(t, mean, true, most);
  for (const double usual : {sorted[sorted.size() / 2], sorted.front()}) {
    if (grid) break;
    // Missing rows show where digits tell a step from its double, or where every stamp is exact.
    const double least = usual < 2.0 * resolution ? 16.0 * UlpOf(largest) : most;
    double sum = 0.0, count = 0.0;
    for (const double step : steps) {
      if (step < 1.5 * usual) sum += step, count += 1.0;
    }
    grid = GridFrom(t, sum / count, false, least);
    // A grid that is mostly holes goes through anything: stamps of three digits lie on a grid of milliseconds.
    if (grid && grid->index.back() > 10.0 * static_cast<double>(t.size())) grid.reset();
  }
  if (!grid) return grid;
  PlainStep plain = Plain(t, grid->index, grid->step, most, unit_s);
  // Stamps of few digits hide a lost row: behind it all stamps are a digit off a grid that misses none, which could as well be
  // their rounding. A step as plain that goes through every stamp exactly and misses few rows is the likelier of the two.
  constexpr double kFewMissing = 0.005;  // of the rows
  if (grid->index.back() == last_row && Scatter(t, grid->index, plain.step) > 16.0 * UlpOf(largest)) {
    const std::optional<Grid> holes = GridFrom(t, sorted[sorted.size() / 2], false, 16.0 * UlpOf(largest));
    const double missing = holes ? holes->index.back() - last_row : 0.0;
    if (missing > 0.0 && missing <= std::max(1.0, kFewMissing * last_row)) {
      const PlainStep other = Plain(t, holes->index, holes->step, 16.0 * UlpOf(largest), unit_s);
      if (other.digits <= plain.digits) grid = holes, plain = other;
    }
  }
  grid->step = plain.step;
  // Of the steps and rates of so many digits, some lie as near as that by chance.
  constexpr double kChance = 0.05;
  constexpr std::size_t kEnough = 10;  // stamps: rounded ones do not all lie on a grid by chance
  grid->range = RangeOf(t, grid->index, grid->step, most);
  grid->plain = std::pow(10.0, plain.digits) * grid->range < kChance;
  grid->exact = t.size() >= kEnough && Scatter(t, grid->index, grid->step) <= 8.0 * UlpOf(largest);
  return grid;
}

}  // namespace

std::size_t FirstFaultOf(std::span<const double> stamps) {
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (!std::isfinite(stamps[i]) || (i > 0 && stamps[i] < stamps[i - 1])) return i;
  }
  return stamps.size();
}

TimeBase TimeBaseOf(std::span<const double> stamps, double unit_s) {
  TimeBase base;
  if (stamps.empty()) return base;
  const std::vector<double> all(stamps.begin(), stamps.end());
  const double resolution = ResolutionOf(all);
  std::vector<double> every(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) every[i] = all[i] - all.front();
  // Fast rows under stamps of few digits repeat them: a grid through every row comes before events, where there are so
  // many rows that a few events could not pass for it.
  constexpr std::size_t kManyRows = 50;
  const double largest = std::max(std::abs(all.front()), std::abs(all.back()));
  // Half a digit to either side, and a quarter because least squares do not find the narrowest strip.
  const double most = 1.25 * resolution + 8.0 * UlpOf(largest);
  const bool rows_are_instants =
      std::adjacent_find(all.begin(), all.end()) == all.end() ||
      (every.size() >= kManyRows && every.back() > 0.0 &&
       GridFrom(every, every.back() / static_cast<double>(every.size() - 1), true, most).has_value());
  std::vector<double> t;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i > 0 && all[i] == all[i - 1] && !rows_are_instants) {
      base.last_row.back() = i;
      continue;
    }
    t.push_back(every[i]);
    base.first_row.push_back(i), base.last_row.push_back(i);
  }
  for (std::size_t i = 0; i < t.size(); ++i) base.events += base.last_row[i] > base.first_row[i] ? 1 : 0;
  base.start_s = all.front() * unit_s;
  base.resolution_s = resolution * unit_s;
  base.time_s.resize(t.size());
  const auto gap = [&base](std::size_t behind, double missing_s) {
    ++base.gaps;
    if (missing_s <= base.longest_gap_s) return;
    base.longest_gap_s = missing_s;
    base.longest_gap_at_s = base.time_s[behind - 1];
    base.longest_gap_row = base.first_row[behind];
  };
  if (const std::optional<Grid> grid = UniformGrid(t, resolution, most, largest, unit_s)) {
    base.step_s = base.usual_step_s = grid->step * unit_s;
    base.step_range = grid->range, base.plain = grid->plain, base.exact = grid->exact;
    for (std::size_t i = 0; i < t.size(); ++i) {
      base.time_s[i] = grid->index[i] * base.step_s;
      const double missing = i > 0 ? grid->index[i] - grid->index[i - 1] - 1.0 : 0.0;
      if (missing < 1.0) continue;
      base.dropped += static_cast<std::size_t>(missing);
      gap(i, missing * base.step_s);
    }
    return base;
  }
  for (std::size_t i = 0; i < t.size(); ++i) base.time_s[i] = t[i] * unit_s;
  if (t.size() < 2) return base;
  std::vector<double> steps(t.size() - 1);
  for (std::size_t i = 0; i + 1 < t.size(); ++i) steps[i] = base.time_s[i + 1] - base.time_s[i];
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  base.usual_step_s = steps[steps.size() / 2];
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double step = base.time_s[i] - base.time_s[i - 1];
    const double off = step - std::max(1.0, std::round(step / base.usual_step_s)) * base.usual_step_s;
    base.jitter_s = std::max(base.jitter_s, std::abs(off));
    if (step >= 1.5 * base.usual_step_s) gap(i, step - base.usual_step_s);
  }
  return base;
}

std::vector<std::string> TimeBase::Notes(const std::string& name) const {
  std::vector<std::string> notes;
  if (events > 0)
    notes.push_back(fmt::format(
        "{}: {} events: rows at one instant, the first value holds up to there, the last from there on", name, events));
  if (uniform() && dropped > 0)
    notes.push_back(
        fmt::format("{}: {} rows are missing of {} in {}, the longest gap {:.4g} s behind {:.6g} s; an input keeps "
                    "its course over them as between any two samples",
                    name, dropped, time_s.size() + dropped, Counted(gaps, "place"), longest_gap_s, longest_gap_at_s));
  if (!uniform() && time_s.size() > 2) {
    notes.push_back(fmt::format(
        "{}: its steps are not equal: usually {:.6g} s, off by up to {:.3g} s; each sample counts at its own "
        "instant",
        name, usual_step_s, jitter_s));
    if (gaps > 0)
      notes.push_back(
          fmt::format("{}: {} steps are longer than 1.5 of the usual one, the longest by {:.4g} s behind {:.6g} s",
                      name, gaps, longest_gap_s, longest_gap_at_s));
  }
  return notes;
}

}  // namespace dynoproof::trace
