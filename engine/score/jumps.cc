#include "score/jumps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace dynoproof::score {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Range {
  double low = kInfinity, high = -kInfinity;
  void TakeIn(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool bounded() const { return std::isfinite(low) && std::isfinite(high); }
};
constexpr Range kAnything{-kInfinity, kInfinity};

Range Only(double value) { return {value, value}; }

/// The ranges of a signal's values before, at and after an instant.
struct Sides {
  std::size_t begin = 0, end = 0;  // its samples at the instant
  Range before, at, after;
  bool jumps() const { return end - begin > 1; }
};

/// Takes in where the line from sample `from` to the next sample `to` in this direction leads at `time_s`, at most a step
/// further, with `room` for how it bends.
void TakeInLine(const Series& series, std::size_t to, int step, double time_s, double room, Range& range) {
  const auto& [time, values, interpolation] = series;
  const auto sample = [&](int back) { return static_cast<std::ptrdiff_t>(to) - back * step; };
  const auto apart = [&](int back) {  // both samples exist, and at two instants
    const std::ptrdiff_t a = sample(back), b = sample(back - 1), first = std::min(a, b);
    return std::max(a, b) < static_cast<std::ptrdiff_t>(series.time_s.size()) && first >= 0 &&
           !IsJump(series.time_s, static_cast<std::size_t>(first));
  };
  if (interpolation == Interpolation::kHold || !apart(1)) return;
  const double width = time[to] - time[sample(1)], slope = (values[to] - values[sample(1)]) / width;
  const double on = step > 0 ? std::min(time_s - time[to], width) : std::max(time_s - time[to], width);
  double open = 0.0;
  if (apart(2)) {
    const double before = (values[sample(1)] - values[sample(2)]) / (time[sample(1)] - time[sample(2)]);
    open = room * std::abs((slope - before) / (time[to] - time[sample(2)]) * on * (on + width));
  }
  range.TakeIn(values[to] + slope * on - open);
  range.TakeIn(values[to] + slope * on + open);
}

/// The signal about the instant from `from_s` to `to_s`.
Sides SidesOf(const Series& series, double from_s, double to_s, double room) {
  const auto& [time, values, interpolation] = series;
  Sides event;
  event.begin = static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), from_s) - time.begin());
  event.end = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), to_s) - time.begin());
  for (std::size_t i = event.begin; i < event.end; ++i) event.at.TakeIn(values[i]);
  if (event.jumps()) {
    event.before = Only(values[event.begin]);
    event.after = Only(values[event.end - 1]);
    return event;
  }
  const bool begins = event.begin == 0, ends = event.end == time.size();
  if (!begins) {
    event.at.TakeIn(values[event.begin - 1]);
    TakeInLine(series, event.begin - 1, 1, from_s, room, event.at);
  }
  if (!ends) {
    event.at.TakeIn(values[event.end]);
    TakeInLine(series, event.end, -1, to_s, room, event.at);
  }
  event.before = begins ? kAnything : event.at;
  event.after = ends ? kAnything : event.at;
  if (begins || ends) event.at = kAnything;
  return event;
}

/// The points `first` to `last` of a tube, at one instant.
class Instant {
 public:
  Instant(TubePoints& points, std::size_t first, std::size_t last, bool in_time)
      : points_(points), first_(first), worst_(last - first + 1, -kInfinity) {
    for (std::size_t i = first; i <= last; ++i)
      in_time_.push_back(in_time ? Range{points.low[i], points.high[i]} : Range());
  }

  void Judge(const Series& reference, const Sides& wanted, const Series& test, const Sides& had) {
    const std::span<const double> time_s = std::span<const double>(points_.time_s).subspan(first_, worst_.size());
    const auto point = [&](const Series& series, std::size_t i) {  // rows behind the last point count there
      const auto it = std::lower_bound(time_s.begin(), time_s.end() - 1, series.time_s[i]);
      return static_cast<std::size_t>(it - time_s.begin());
    };
    Meet(0, had.before, wanted.before);
    Meet(worst_.size() - 1, had.after, wanted.after);
    const auto between = [](const Sides& event, std::size_t i) {
      return !event.jumps() || (i > event.begin && i + 1 < event.end);
    };
    for (std::size_t i = wanted.begin; i < wanted.end; ++i) {
      if (between(wanted, i)) Meet(point(reference, i), had.at, Only(reference.values[i]));
    }
    for (std::size_t i = had.begin; i < had.end; ++i) {
      if (between(had, i)) Meet(point(test, i), Only(test.values[i]), wanted.at);
    }
    for (std::size_t k = 0; k < worst_.size(); ++k) {
      if (worst_[k] > -kInfinity) continue;
      const std::size_t i = first_ + k;  // of this row nothing was said
      points_.low[i] = std::min(points_.low[i], points_.test[i]);
      points_.high[i] = std::max(points_.high[i], points_.test[i]);
    }
  }

 private:
  /// Keeps the value in which the two ranges meet, or where they are nearest, if nothing worse is known of the point.
  void Meet(std::size_t k, const Range& had, Range wanted) {
    if (!had.bounded() || !wanted.bounded()) return;
    const std::size_t i = first_ + k;
    wanted.low = std::min(wanted.low, in_time_[k].low);
    wanted.high = std::max(wanted.high, in_time_[k].high);
    const double value = had.high < wanted.low ? had.high : std::max(had.low, wanted.low);
    const double distance = std::max(value - wanted.high, wanted.low - value);
    if (distance <= worst_[k]) return;
    worst_[k] = distance;
    points_.test[i] = value;
    points_.low[i] = wanted.low;
    points_.high[i] = wanted.high;
  }

  TubePoints& points_;
  std::size_t first_;
  std::vector<double> worst_;   // distance of each point so far
  std::vector<Range> in_time_;  // of the reference about each point, where it may be early or late
};

bool HasJumps(const Series& series) {
  for (std::size_t i = 0; i + 1 < series.time_s.size(); ++i) {
    if (IsJump(series.time_s, i)) return true;
  }
  return false;
}

/// The last stamp of the instant that ends at `to_s` so far.
double EndOfInstant(const Series& series, double to_s) {
  const std::span<const double> time = series.time_s;
  auto next = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), to_s) - time.begin());
  while (next > 0 && next < time.size() && IsJump(time, next - 1)) to_s = time[next++];
  return to_s;
}

}  // namespace

void JudgeJumps(const Series& reference, const Series& test, double room, bool in_time, TubePoints& points) {
  if (!HasJumps(reference) && !HasJumps(test)) return;
  for (std::size_t first = 0, last = 0; first < points.time_s.size(); first = last + 1) {
    last = first;
    while (last + 1 < points.time_s.size() && IsJump(points.time_s, last)) ++last;
    const double from_s = points.time_s[first];
    const double to_s = std::max(EndOfInstant(reference, points.time_s[last]), EndOfInstant(test, points.time_s[last]));
    const Sides wanted = SidesOf(reference, from_s, to_s, room), had = SidesOf(test, from_s, to_s, room);
    if (!wanted.jumps() && !had.jumps()) continue;
    Instant(points, first, last, in_time).Judge(reference, wanted, test, had);
  }
}

}  // namespace dynoproof::score
