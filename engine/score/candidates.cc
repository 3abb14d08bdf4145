#include "score/candidates.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "score/align.h"
#include "score/nrmse.h"

namespace dynoproof::score {
namespace {

std::string WithUnit(double value, const std::string& unit) {
  return unit.empty() ? fmt::format("{:.4g}", value) : fmt::format("{:.4g} {}", value, unit);
}

std::string ShiftText(double shift_s) {
  return fmt::format("{} by {:.4g} ms", shift_s > 0.0 ? "late" : "early", 1e3 * std::abs(shift_s));
}

Candidate Fixed(const Pair& pair, Cause cause, double sign, bool magnitude_only, std::string text) {
  Candidate c;
  c.cause = cause;
  c.residual.resize(pair.x.size());
  for (std::size_t i = 0; i < pair.x.size(); ++i)
    c.residual[i] = pair.y[i] - sign * (magnitude_only ? std::abs(pair.x[i]) : pair.x[i]);
  c.unexplained = SumOfSquares(c.residual) / pair.difference_square;
  c.text = std::move(text);
  return c;
}

// gain x explains y only if it is really in there: a small signal of its own also leaves little of y - x behind gain 0.
bool IsPresent(const Pair& pair, const AlignmentFit& fit) {
  if (fit.unexplained <= 1e-6) return true;
  const double spread = StandardDeviation(pair.x) * fit.gain;
  const double left = RootMeanSquare(fit.residual);
  return spread * spread > 3.0 * left * left;
}

void AddFit(const Pair& pair, const std::string& unit, const FitFreedom& freedom, Cause cause, Candidates& out) {
  const AlignmentFit fit = FitArrays(pair.x, pair.y, pair.step_s, freedom);
  if (!fit.ok() || (freedom.gain && !IsPresent(pair, fit))) return;
  if (freedom.shift && std::abs(fit.shift_s) < 1e-6 * pair.step_s) return;  // the candidate without shift says the same
  Candidate c;
  c.cause = cause;
  c.complexity = (freedom.gain ? 1 : 0) + (freedom.offset ? 1 : 0) + (freedom.shift ? 1 : 0);
  c.unexplained = fit.unexplained;
  c.residual = fit.residual;
  c.first = fit.first;
  const auto add = [&](const char* name, double value, std::string its_unit, std::string text) {
    c.quantities.push_back({name, value, std::move(its_unit)});
    c.text += (c.text.empty() ? "" : ", ") + std::move(text);
  };
  if (freedom.shift) add("shift", fit.shift_s, "s", ShiftText(fit.shift_s));
  if (freedom.gain) {
    add("gain", fit.gain, "1", fmt::format("gain {:.4g}{}", fit.gain, fit.gain < 0.0 ? " (sign flipped)" : ""));
  }
  if (freedom.offset) add("offset", fit.offset, unit, "offset " + WithUnit(fit.offset, unit));
  out.push_back(std::move(c));
}

void AddDrift(const Pair& pair, const std::string& unit, bool offset, Candidates& out) {
  const std::size_t n = pair.d.size();
  double t1 = 0.0, t2 = 0.0, d1 = 0.0, td = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = Num(i) * pair.step_s;
    t1 += t;
    t2 += t * t;
    d1 += pair.d[i];
    td += t * pair.d[i];
  }
  const double slope = offset ? (td - t1 * d1 / Num(n)) / (t2 - t1 * t1 / Num(n)) : td / t2;
  const double level = offset ? (d1 - slope * t1) / Num(n) : 0.0;
  Candidate c;
  c.cause = offset ? Cause::kDriftAndOffset : Cause::kDrift;
  c.complexity = offset ? 2 : 1;
  c.residual.resize(n);
  for (std::size_t i = 0; i < n; ++i) c.residual[i] = pair.d[i] - level - slope * Num(i) * pair.step_s;
  c.unexplained = SumOfSquares(c.residual) / pair.difference_square;
  const std::string per_second = unit.empty() ? "1/s" : unit + "/s";
  c.quantities.push_back({"slope", slope, per_second});
  c.text = "drifts by " + WithUnit(slope, per_second);
  if (offset) {
    c.quantities.push_back({"offset", level, unit});
    c.text += ", offset " + WithUnit(level, unit);
  }
  out.push_back(std::move(c));
}

}  // namespace

double SumOfSquares(std::span<const double> v) {
  double sum = 0.0;
  for (double value : v) sum += value * value;
  return sum;
}

void AddScalings(const Pair& pair, const std::string& unit, Candidates& out) {
  AddFit(pair, unit, {.gain = false, .offset = true, .shift = false}, Cause::kOffset, out);
  AddDrift(pair, unit, false, out);
  AddDrift(pair, unit, true, out);
  const double spread = StandardDeviation(pair.x);
  if (!(spread > 1e-12 * Largest(pair.x))) return;  // a constant can be neither scaled nor shifted visibly

  out.push_back(Fixed(pair, Cause::kSignFlip, -1.0, false, "sign flipped"));
  const bool both_signs = *std::min_element(pair.x.begin(), pair.x.end()) < 0.0;
  if (both_signs) {
    out.push_back(Fixed(pair, Cause::kSignLost, 1.0, true, "sign lost: the test is the magnitude of the reference"));
    out.push_back(
        Fixed(pair, Cause::kSignLost, -1.0, true, "sign lost: the test is minus the magnitude of the reference"));
  }
  AddFit(pair, unit, {.gain = true, .offset = false, .shift = false}, Cause::kGain, out);
  AddFit(pair, unit, {.gain = true, .offset = true, .shift = false}, Cause::kGainAndOffset, out);
  AddFit(pair, unit, {.gain = false, .offset = false, .shift = true}, Cause::kShift, out);
  AddFit(pair, unit, {.gain = true, .offset = false, .shift = true}, Cause::kShiftAndGain, out);
  AddFit(pair, unit, {.gain = false, .offset = true, .shift = true}, Cause::kShiftAndOffset, out);
  AddFit(pair, unit, {.gain = true, .offset = true, .shift = true}, Cause::kShiftGainAndOffset, out);

  Candidate mirrored = Fixed(pair, Cause::kMirrored, -1.0, false, "");
  const double level = Mean(mirrored.residual);
  for (double& r : mirrored.residual) r -= level;
  mirrored.unexplained = SumOfSquares(mirrored.residual) / pair.difference_square;
  mirrored.complexity = 1;
  mirrored.quantities.push_back({"offset", level, unit});
  mirrored.text = "sign flipped about " + WithUnit(0.5 * level, unit);
  out.push_back(std::move(mirrored));
}

void AddFineShift(const Pair& pair, const Series& test, Candidates& out) {
  const double fine = MedianStep(test.time_s);
  if (!(fine < 0.5 * pair.step_s)) return;
  constexpr std::size_t kReach = 2;  // samples of the reference, kept free at both ends
  if (pair.x.size() < 8 * kReach) return;
  const std::size_t count = pair.x.size() - 2 * kReach;
  const std::span<const double> x = std::span(pair.x).subspan(kReach, count);
  const double unshifted = SumOfSquares(std::span(pair.d).subspan(kReach, count));
  // A millionth of a step later, so that a held value is not taken from before its sample by round-off.
  const auto residual = [&](double shift_s) {
    std::vector<double> times(count);
    for (std::size_t i = 0; i < count; ++i)
      times[i] = pair.start_s + pair.step_s * Num(kReach + i) + shift_s + 1e-6 * fine;
    std::vector<double> left = SampleAt(test, times);
    for (std::size_t i = 0; i < count; ++i) left[i] -= x[i];
    return left;
  };
  const int reach = static_cast<int>(kReach * pair.step_s / fine) - 1;
  std::vector<double> squares;
  for (int j = -reach; j <= reach; ++j) squares.push_back(SumOfSquares(residual(j * fine)));
  const auto best = std::min_element(squares.begin(), squares.end()) - squares.begin();
  if (best == 0 || best == std::ssize(squares) - 1 || !(squares[best] < unshifted)) return;
  // Between two of the test's samples: the vertex of the parabola through the least three.
  const double before = squares[best - 1], after = squares[best + 1], bend = before - 2.0 * squares[best] + after;
  double shift = fine * static_cast<double>(best - reach);
  Candidate c;
  c.residual = residual(shift);
  const double between = shift + (bend > 0.0 ? 0.5 * fine * (before - after) / bend : 0.0);
  if (std::vector<double> left = residual(between); SumOfSquares(left) < squares[best]) {
    c.residual = std::move(left);
    shift = between;
  }
  c.cause = Cause::kShift;
  c.complexity = 1;
  c.unexplained = SumOfSquares(c.residual) / unshifted;
  c.first = kReach;
  c.quantities = {{"shift", shift, "s"}};
  c.text = ShiftText(shift);
  out.push_back(std::move(c));
}

double RelationToReference(const Pair& pair, std::span<const double> residual, std::size_t first) {
  const std::size_t n = residual.size();
  if (n < 64 || first + n > pair.x.size()) return 1.0;
  const double level = Mean(pair.x);
  const double scale = std::max(StandardDeviation(pair.x), 1e-300);
  const auto last = static_cast<std::ptrdiff_t>(pair.x.size()) - 1;
  const auto u = [&](std::ptrdiff_t i) { return (pair.x[std::clamp<std::ptrdiff_t>(i, 0, last)] - level) / scale; };
  constexpr std::array<std::ptrdiff_t, 6> kLags = {1, 3, 7, 15, 31, 63};
  constexpr int kColumns = 7 + 2 * static_cast<int>(kLags.size());
  Eigen::MatrixXd columns(n, kColumns);
  Eigen::VectorXd target(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto j = static_cast<std::ptrdiff_t>(i + first);
    const double value = u(j), t = 2.0 * Num(i) / Num(n) - 1.0;
    columns.row(i).head<7>() << 1.0, value, value * std::abs(value), value * value * value, t * value,
        t * (u(j + 1) - u(j - 1)), t;
    for (std::size_t k = 0; k < kLags.size(); ++k) {
      columns(i, 7 + 2 * k) = u(j - kLags[k]);
      columns(i, 8 + 2 * k) = u(j + kLags[k]);
    }
    target(i) = residual[i];
  }
  const double total = target.squaredNorm();
  if (!(total > 0.0)) return 0.0;
  for (int k = 0; k < kColumns; ++k) {
    const double norm = columns.col(k).norm();
    if (norm > 0.0) columns.col(k) /= norm;
  }
  // Normal equations with a whisper of ridge: columns of norm one, nearly collinear for a smooth reference.
  const Eigen::MatrixXd normal = columns.transpose() * columns + 1e-9 * Eigen::MatrixXd::Identity(kColumns, kColumns);
  const Eigen::VectorXd projected = columns.transpose() * target;
  const Eigen::VectorXd weights = normal.ldlt().solve(projected);
  return 1.0 - (target - columns * weights).squaredNorm() / total;
}

namespace {

// The instant of the reference that belongs to test time t: events of one list map to events of the other.
double Warp(double t, std::span<const Event> from, std::span<const Event> to) {
  if (t <= from.front().time_s) return t + to.front().time_s - from.front().time_s;
  for (std::size_t k = 1; k < from.size(); ++k) {
    if (t > from[k].time_s) continue;
    const double length = from[k].time_s - from[k - 1].time_s;
    const double part = length > 0.0 ? (t - from[k - 1].time_s) / length : 1.0;
    return to[k - 1].time_s + part * (to[k].time_s - to[k - 1].time_s);
  }
  return t + to.back().time_s - from.back().time_s;
}

Candidate ShiftedEvents(const Pair& pair, std::span<const Event> reference, std::span<const Event> test) {
  Candidate c;
  c.cause = Cause::kEventsShifted;
  c.complexity = 4;  // above a shift of everything with gain and offset: that is the simpler statement
  std::vector<double> times(pair.x.size()), warped(pair.x.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    times[i] = pair.start_s + pair.step_s * Num(i);
    warped[i] = Warp(times[i], test, reference);
    if (i > 0) warped[i] = std::max(warped[i], warped[i - 1]);
  }
  const std::vector<double> moved = SampleAt({times, pair.x}, warped);
  c.residual.resize(moved.size());
  for (std::size_t i = 0; i < moved.size(); ++i) c.residual[i] = pair.y[i] - moved[i];
  c.unexplained = SumOfSquares(c.residual) / pair.difference_square;
  c.structural = false;  // between the events the warp is a guess, and what is left follows the reference's slope
  std::size_t worst = 0;
  const auto shift = [&](std::size_t k) { return test[k].time_s - reference[k].time_s; };
  for (std::size_t k = 1; k < test.size(); ++k)
    if (std::abs(shift(k)) > std::abs(shift(worst))) worst = k;
  c.quantities.push_back({"shift", shift(worst), "s"});
  c.text = fmt::format("events shifted, most of all \"{}\" at {:.6g} s, {} by {:.4g} ms", reference[worst].name,
                       reference[worst].time_s, shift(worst) > 0 ? "late" : "early", 1e3 * std::abs(shift(worst)));
  return c;
}

}  // namespace

void AddEvents(const Pair& pair, const ExplainOptions& options, Candidates& out) {
  const auto reference = options.reference_events, test = options.test_events;
  std::size_t k = 0;  // first event that differs
  while (k < reference.size() && k < test.size() && reference[k].name == test[k].name) ++k;
  if (k == reference.size() && k == test.size()) {
    if (!reference.empty()) out.push_back(ShiftedEvents(pair, reference, test));
    return;
  }
  double moment = pair.start_s + pair.Duration();
  if (k < reference.size()) moment = std::min(moment, reference[k].time_s);
  if (k < test.size()) moment = std::min(moment, test[k].time_s);
  // At the very start everything lies behind the moment, which would explain any difference.
  const double lead = moment - pair.start_s;
  if (!(lead > 0.05 * pair.Duration())) return;
  const auto before = static_cast<std::size_t>(std::clamp(lead / pair.step_s - 1.0, 0.0, Num(pair.d.size())));
  std::vector<std::string> names_a, names_b;
  for (const Event& e : reference) names_a.push_back(e.name);
  for (const Event& e : test) names_b.push_back(e.name);
  std::sort(names_a.begin(), names_a.end());
  std::sort(names_b.begin(), names_b.end());
  Candidate c;
  c.cause = names_a == names_b ? Cause::kEventsReordered : Cause::kEventsMissing;
  c.complexity = 6;
  c.structural = false;
  c.unexplained = SumOfSquares(std::span<const double>(pair.d).first(before)) / pair.difference_square;
  if (c.unexplained > 0.02) return;  // they differed before, so the event is not where it began
  c.quantities.push_back({"time", moment, "s"});
  const auto name = [](std::span<const Event> events, std::size_t i) {
    return i < events.size() ? "\"" + events[i].name + "\"" : std::string("none");
  };
  c.text = fmt::format("{} from {:.6g} s on: {} where the reference has {}",
                       c.cause == Cause::kEventsReordered ? "events in another order" : "other events", moment,
                       name(test, k), name(reference, k));
  out.push_back(std::move(c));
}

}  // namespace dynoproof::score
