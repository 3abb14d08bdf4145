// What a nonlinear law does within one substep of the solver `realtime`, without the solver around it: its torque as
// straight pieces, the share of the substep at which a motion stops, its own states carried on.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

namespace dynoproof::substep {

inline constexpr double kLeastShare = 1e-9;      // of a substep: a shorter part of it is none
inline constexpr std::size_t kMostOfAPart = 16;  // inputs or states of a part that is carried ahead

/// Carries states by one step of Runge-Kutta 4 over `length` [s]; `slope(share, x, rates)` at a share of it.
template <class Slope>
void RungeKutta4(std::span<double> own, double length, const Slope& slope) {
  static constexpr double kNone[kMostOfAPart] = {}, kShare[4] = {0.0, 0.5, 0.5, 1.0};
  const std::size_t n = own.size();
  assert(n <= kMostOfAPart);
  double k[4][kMostOfAPart], x[kMostOfAPart];
  for (int stage = 0; stage < 4; ++stage) {
    const double* const last = stage == 0 ? kNone : k[stage - 1];
    const double reach = kShare[stage] * length;
    for (std::size_t i = 0; i < n; ++i) x[i] = own[i] + reach * last[i];
    slope(kShare[stage], std::span<const double>(x, n), std::span<double>(k[stage], n));
  }
  const double sixth = length / 6.0;
  for (std::size_t i = 0; i < n; ++i) own[i] += sixth * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
}

/// The torque of a law along a piece of a substep: at its beginning, middle and end.
struct Course {
  double begin, middle, end;
  double mean() const { return (begin + 4.0 * middle + end) / 6.0; }  // Simpson
  static Course Straight(double begin, double end) { return {begin, 0.5 * (begin + end), end}; }
  static Course Flat(double torque) { return {torque, torque, torque}; }
};
/// A torque over a substep: the straight line held + ramp s that acts as it does, and its own value at the end.
struct Line {
  double held, ramp, end;
};
/// Of a straight course over the whole substep.
inline Line LineOf(double begin, double end) { return {begin, end - begin, end}; }
/// Of `before` until share `at` of the substep and `after` from there on: the same mean, and the same first moment
/// about the middle of the substep, which is each one's at its own middle plus that of its slope.
inline Line LineOf(const Course& before, const Course& after, double at) {
  const double rest = 1.0 - at, mean = at * before.mean() + rest * after.mean();
  const double ramp = 6.0 * at * rest * (after.mean() - before.mean()) + at * at * (before.end - before.begin) +
                      rest * rest * (after.end - after.begin);
  return {mean - 0.5 * ramp, ramp, after.end};
}

/// What a torque begin + change s of a channel over a substep does to its own rate or twist at the end.
struct Reach {
  double without, held, ramp;  // at the end without any; change by `begin`, by `change`
  double At(double begin, double change) const { return without + held * begin + ramp * change; }
};

/// Both above or both below 0. Not by their product: of two speeds that round-off has left it may be 0.
inline bool SameSign(double a, double b) { return (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0); }

/// The share of a substep at which a speed is zero that goes from `begin` to `end` with the mean `mean`: that of the
/// parabola. 0 or 1 where it is next to either, or does not change its sign.
inline double StopOf(double begin, double end, double mean) {
  if (SameSign(begin, end)) return 0.0;
  double at = begin / (begin - end);
  const double slope = 6.0 * mean - 4.0 * begin - 2.0 * end, bend = 3.0 * (begin + end) - 6.0 * mean;
  for (int i = 0; i < 3; ++i) {  // Newton's steps from the straight line
    const double falls = slope + 2.0 * bend * at;
    if (falls * begin >= 0.0) break;
    at = std::clamp(at - (begin + (slope + bend * at) * at) / falls, 0.0, 1.0);
  }
  return at < kLeastShare ? 0.0 : at > 1.0 - kLeastShare ? 1.0 : at;
}

/// Solves matrix x = right (n equations, row by row; both are spoilt) as far as it says anything: by elimination with the
/// largest pivot of all that is left, x = 0 where only round-off is left. `order` is scratch memory.
inline void SolveWhatIsSure(std::span<double> matrix, std::span<double> right, std::span<double> x,
                            std::span<std::size_t> order) {
  constexpr double kRoundOff = 1e-10;
  const std::size_t n = right.size();
  for (std::size_t i = 0; i < n; ++i) order[i] = i, x[i] = 0.0;
  double largest = 0.0;
  std::size_t rank = 0;
  for (; rank < n; ++rank) {
    std::size_t row = rank, column = rank;
    for (std::size_t i = rank; i < n; ++i) {
      for (std::size_t j = rank; j < n; ++j) {
        if (std::abs(matrix[i * n + j]) > std::abs(matrix[row * n + column])) row = i, column = j;
      }
    }
    const double pivot = std::abs(matrix[row * n + column]);
    largest = std::max(largest, pivot);
    if (!(pivot > kRoundOff * largest)) break;
    for (std::size_t j = 0; j < n; ++j) std::swap(matrix[rank * n + j], matrix[row * n + j]);
    std::swap(right[rank], right[row]);
    for (std::size_t i = 0; i < n; ++i) std::swap(matrix[i * n + rank], matrix[i * n + column]);
    std::swap(order[rank], order[column]);
    for (std::size_t i = rank + 1; i < n; ++i) {
      const double factor = matrix[i * n + rank] / matrix[rank * n + rank];
      for (std::size_t j = rank; j < n; ++j) matrix[i * n + j] -= factor * matrix[rank * n + j];
      right[i] -= factor * right[rank];
    }
  }
  for (std::size_t i = rank; i-- > 0;) {
    double sum = right[i];
    for (std::size_t j = i + 1; j < rank; ++j) sum -= matrix[i * n + j] * x[order[j]];
    x[order[i]] = sum / matrix[i * n + i];
  }
}

}  // namespace dynoproof::substep
