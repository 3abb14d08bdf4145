// FitGainOffsetShift of nrmse.h: least squares over gain, offset and shift.
#include "score/align.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "score/fft.h"
#include "score/nrmse.h"

namespace dynoproof::score {
namespace {

constexpr int kHalfTaps = 16;

// Modified Bessel function I0 by its series; arguments here stay below 9.
double BesselI0(double x) {
  double term = 1.0, sum = 1.0;
  for (int k = 1; k < 60 && term > 1e-17 * sum; ++k) {
    term *= 0.25 * x * x / (k * k);
    sum += term;
  }
  return sum;
}

// Sums of a pair (u, v) of equally long pieces, enough for any gain-and-offset fit.
struct Sums {
  double n = 0.0, u = 0.0, v = 0.0, uu = 0.0, uv = 0.0, vv = 0.0;
};

struct Line {
  double gain = 1.0, offset = 0.0, mean_square = 0.0;
};

// v = gain u + offset with the parameters that are free.
Line FitLine(const Sums& s, const FitFreedom& freedom) {
  Line line;
  if (freedom.gain && freedom.offset) {
    const double spread = s.uu - s.u * s.u / s.n;
    line.gain = spread > 1e-14 * s.uu ? (s.uv - s.u * s.v / s.n) / spread : 0.0;
  } else if (freedom.gain) {
    line.gain = s.uu > 0.0 ? s.uv / s.uu : 0.0;
  }
  if (freedom.offset) line.offset = (s.v - line.gain * s.u) / s.n;
  const double g = line.gain, o = line.offset;
  line.mean_square =
      std::max(0.0, s.vv + g * g * s.uu + s.n * o * o - 2.0 * g * s.uv - 2.0 * o * s.v + 2.0 * g * o * s.u) / s.n;
  return line;
}

Sums SumsOf(std::span<const double> u, std::span<const double> v) {
  Sums s;
  s.n = Num(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    s.u += u[i];
    s.v += v[i];
    s.uu += u[i] * u[i];
    s.uv += u[i] * v[i];
    s.vv += v[i] * v[i];
  }
  return s;
}

std::vector<double> PrefixSum(std::span<const double> x, bool square) {
  std::vector<double> sums(x.size() + 1, 0.0);
  for (std::size_t i = 0; i < x.size(); ++i) sums[i + 1] = sums[i] + (square ? x[i] * x[i] : x[i]);
  return sums;
}

// Mean square of the best fit for each whole shift -max .. max, from correlation and prefix sums: O(n log n) for all.
std::vector<double> CostByLag(std::span<const double> x, std::span<const double> y, std::size_t max,
                              const FitFreedom& freedom) {
  const std::vector<double> cross = CrossCorrelation(x, y, max);
  const auto x1 = PrefixSum(x, false), x2 = PrefixSum(x, true), y1 = PrefixSum(y, false), y2 = PrefixSum(y, true);
  const std::size_t n = x.size();
  std::vector<double> cost(2 * max + 1);
  for (std::size_t i = 0; i < cost.size(); ++i) {
    const std::size_t late = i > max ? i - max : 0;   // y[j] pairs with x[j - late]
    const std::size_t early = i < max ? max - i : 0;  // y[j] pairs with x[j + early]
    const std::size_t count = n - late - early;
    Sums s;
    s.n = Num(count);
    s.u = x1[early + count] - x1[early];
    s.uu = x2[early + count] - x2[early];
    s.v = y1[late + count] - y1[late];
    s.vv = y2[late + count] - y2[late];
    s.uv = cross[i];
    cost[i] = FitLine(s, freedom).mean_square;
  }
  return cost;
}

// x(j - shift) for j = first .. last - 1 by a Kaiser-windowed sinc; whole shifts are exact copies.
std::vector<double> Delayed(std::span<const double> x, double shift, std::size_t first, std::size_t last) {
  const double whole = std::floor(shift);
  const double part = shift - whole;
  std::vector<double> taps(2 * kHalfTaps);
  double sum = 0.0;
  for (int k = 0; k < 2 * kHalfTaps; ++k) {
    const double distance = (k - kHalfTaps + 1) - part;  // of the tap x[j - whole - (k - kHalfTaps + 1)]
    const double edge = distance / kHalfTaps;
    const double sinc =
        std::abs(distance) < 1e-12 ? 1.0 : std::sin(std::numbers::pi * distance) / (std::numbers::pi * distance);
    taps[k] = std::abs(edge) >= 1.0 ? 0.0 : sinc * BesselI0(8.0 * std::sqrt(1.0 - edge * edge)) / BesselI0(8.0);
    sum += taps[k];
  }
  for (double& tap : taps) tap /= sum;  // a constant stays what it is
  std::vector<double> out(last - first, 0.0);
  const auto count = static_cast<Eigen::Index>(out.size());
  const auto newest = static_cast<std::ptrdiff_t>(first) - static_cast<std::ptrdiff_t>(whole) + kHalfTaps - 1;
  Eigen::Map<Eigen::VectorXd> sums(out.data(), count);
  for (int k = 0; k < 2 * kHalfTaps; ++k)
    sums += taps[k] * Eigen::Map<const Eigen::VectorXd>(x.data() + newest - k, count);
  return out;
}

struct Trial {
  Line line;
  std::vector<double> fit;  // gain * delayed + offset on first .. last - 1
  std::size_t first = 0;
};

Trial TryShift(std::span<const double> x, std::span<const double> y, double shift, const FitFreedom& freedom) {
  Trial trial;
  const std::size_t margin = static_cast<std::size_t>(std::ceil(std::abs(shift))) + kHalfTaps;
  const bool whole = shift == std::floor(shift);
  const std::size_t first = whole ? static_cast<std::size_t>(std::max(0.0, shift)) : margin;
  const std::size_t last = y.size() - (whole ? static_cast<std::size_t>(std::max(0.0, -shift)) : margin);
  std::vector<double> u;
  if (whole) {
    const auto from = x.begin() + static_cast<std::ptrdiff_t>(first) - static_cast<std::ptrdiff_t>(shift);
    u.assign(from, from + static_cast<std::ptrdiff_t>(last - first));
  } else {
    u = Delayed(x, shift, first, last);
  }
  trial.line = FitLine(SumsOf(u, y.subspan(first, last - first)), freedom);
  trial.first = first;
  for (double& value : u) value = trial.line.gain * value + trial.line.offset;
  trial.fit = std::move(u);
  return trial;
}

// The best whole-sample shift; of several that are about as good the one nearest to zero.
double WholeShift(std::span<const double> x, std::span<const double> y, const FitFreedom& freedom) {
  const std::size_t max = x.size() / 4;
  const std::vector<double> cost = CostByLag(x, y, max, freedom);
  const double best = *std::min_element(cost.begin(), cost.end());
  const double about = 1.02 * best + 1e-3 * cost[max];
  std::ptrdiff_t chosen = std::min_element(cost.begin(), cost.end()) - cost.begin() - static_cast<std::ptrdiff_t>(max);
  for (std::size_t i = 0; i < cost.size(); ++i) {
    const auto lag = static_cast<std::ptrdiff_t>(i) - static_cast<std::ptrdiff_t>(max);
    const bool valley = (i == 0 || cost[i] <= cost[i - 1]) && (i + 1 == cost.size() || cost[i] <= cost[i + 1]);
    if (valley && cost[i] <= about && std::abs(lag) < std::abs(chosen)) chosen = lag;
  }
  return static_cast<double>(chosen);
}

// Golden section over one sample to either side, a parabola at its end, and the whole shift itself, which is free of
// interpolation.
double FineShift(std::span<const double> x, std::span<const double> y, double whole, const FitFreedom& freedom) {
  const auto cost = [&](double shift) { return TryShift(x, y, shift, freedom).line.mean_square; };
  const double ratio = 1.0 / std::numbers::phi;
  double low = whole - 1.0, high = whole + 1.0;
  double a = high - ratio * (high - low), b = low + ratio * (high - low);
  double cost_a = cost(a), cost_b = cost(b);
  for (int i = 0; i < 13; ++i) {  // the bracket ends at 4e-3 of a sample
    if (cost_a < cost_b) {
      high = b;
      b = a;
      cost_b = cost_a;
      a = high - ratio * (high - low);
      cost_a = cost(a);
    } else {
      low = a;
      a = b;
      cost_a = cost_b;
      b = low + ratio * (high - low);
      cost_b = cost(b);
    }
  }
  double fine = cost_a < cost_b ? a : b;
  double least = std::min(cost_a, cost_b);
  const double reach = 0.01;
  const double before = cost(fine - reach), after = cost(fine + reach);
  const double curvature = before + after - 2.0 * least;
  if (curvature > 0.0) {
    const double vertex = fine + 0.5 * reach * (before - after) / curvature;
    const double at_vertex = cost(vertex);
    if (at_vertex < least) {
      fine = vertex;
      least = at_vertex;
    }
  }
  return cost(whole) <= least ? whole : fine;
}

}  // namespace

AlignmentFit FitArrays(std::span<const double> reference, std::span<const double> test, double step_s,
                       const FitFreedom& freedom) {
  AlignmentFit fit;
  const std::size_t n = reference.size();
  if (n < 4 * kHalfTaps / 2 || n != test.size()) {
    fit.reason = "a fit needs two arrays of one length of at least 32";
    return fit;
  }
  double shift = 0.0;
  // The mean is taken off both before shifting: sums of squares around a large offset would lose the digits that
  // matter.
  const double level = Mean(reference);
  std::vector<double> x(reference.begin(), reference.end()), y(test.begin(), test.end());
  // gain * (reference - level) + offset' only equals the model when the offset is free or the gain is one.
  const bool centre = freedom.offset || !freedom.gain;
  if (centre) {
    for (double& value : x) value -= level;
    for (double& value : y) value -= level;
  }
  if (freedom.shift) {
    shift = WholeShift(x, y, freedom);
    if (static_cast<std::size_t>(std::abs(shift)) + 2 * kHalfTaps + 4 < n / 2) shift = FineShift(x, y, shift, freedom);
  }
  const Trial trial = TryShift(x, y, shift, freedom);
  fit.gain = trial.line.gain;
  fit.offset = centre ? trial.line.offset + level * (1.0 - trial.line.gain) : trial.line.offset;
  fit.shift_s = shift * step_s;
  fit.first = trial.first;
  double difference = 0.0, left = 0.0;
  fit.residual.resize(trial.fit.size());
  for (std::size_t i = 0; i < trial.fit.size(); ++i) {
    const std::size_t j = i + trial.first;
    fit.residual[i] = y[j] - trial.fit[i];
    left += fit.residual[i] * fit.residual[i];
    difference += (y[j] - x[j]) * (y[j] - x[j]);
  }
  fit.unexplained = difference > 0.0 ? left / difference : (left > 0.0 ? 1.0 : 0.0);
  fit.verdict = Verdict::kPass;
  return fit;
}

AlignmentFit FitGainOffsetShift(const Series& reference, const Series& test, const FitFreedom& freedom) {
  AlignmentFit fit;
  const Aligned aligned = AlignTo(reference, test, 0.0, 2 * kHalfTaps);
  fit.reason = aligned.reason;
  if (fit.reason.empty()) fit.reason = UniformFault(reference.time_s, "reference");
  if (!fit.reason.empty()) return fit;
  if (freedom.gain && RootMeanSquare(reference.values) == 0.0) {
    fit.reason = "the reference is zero throughout: no gain can be fitted";
    return fit;
  }
  const double step_s = (reference.time_s.back() - reference.time_s.front()) / Num(reference.time_s.size() - 1);
  return FitArrays(reference.values, aligned.test, step_s, freedom);
}

}  // namespace dynoproof::score
