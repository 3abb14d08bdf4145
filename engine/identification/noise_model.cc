#include "identification/noise_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "score/fft.h"
#include "score/series.h"

namespace dynoproof::identification {
std::vector<double> Periodogram(const Eigen::Ref<const Eigen::VectorXd>& x) {
  const double mean = x.mean();
  std::vector<double> centred(static_cast<std::size_t>(x.size()));
  for (std::size_t i = 0; i < centred.size(); ++i) centred[i] = x[static_cast<Eigen::Index>(i)] - mean;
  const auto spectrum = score::Fft(std::span<const double>(centred));
  std::vector<double> power(centred.size() / 2 > 1 ? centred.size() / 2 - 1 : 0);
  for (std::size_t k = 0; k < power.size(); ++k) power[k] = std::norm(spectrum[k + 1]);
  return power;
}

Eigen::VectorXd WithoutTrend(const Eigen::Ref<const Eigen::VectorXd>& x) {
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(x.size(), -1.0, 1.0);
  const double slope = x.size() > 2 ? (x.array() * t).sum() / t.square().sum() : 0.0;
  return x.array() - x.mean() - slope * t;
}

ArModel FitAr(const Eigen::Ref<const Eigen::VectorXd>& residual, int order) {
  const Eigen::Index n = residual.size();
  order = static_cast<int>(std::min<Eigen::Index>(order, n / 10));
  Eigen::VectorXd forward = residual, backward = residual;
  Eigen::VectorXd a = Eigen::VectorXd::Zero(order);
  double power = n > 0 ? residual.squaredNorm() / static_cast<double>(n) : 0.0;
  for (int m = 0; m < order && power > 0.0; ++m) {
    const Eigen::Index rows = n - m - 1;
    const auto f = forward.tail(rows), b = backward.segment(m, rows);
    const double scale = f.squaredNorm() + b.squaredNorm();
    if (!(scale > 0.0)) break;
    const double k = 2.0 * f.dot(b) / scale;
    const Eigen::VectorXd before = a.head(m);
    a[m] = k;
    for (int i = 0; i < m; ++i) a[i] = before[i] - k * before[m - 1 - i];
    const Eigen::VectorXd next_f = f - k * b, next_b = b - k * f;
    forward.tail(rows) = next_f;
    backward.segment(m + 1, rows) = next_b;
    power *= std::max(1.0 - k * k, 1e-15);
  }
  return {{a.data(), a.data() + order}, std::max(std::sqrt(power), std::numeric_limits<double>::min())};
}

double RmsOf(const Eigen::Ref<const Eigen::VectorXd>& rows) {
  return rows.norm() / std::sqrt(static_cast<double>(rows.size()));
}

double HighFrequencyFloor(const Eigen::Ref<const Eigen::VectorXd>& residual) {
  // Without a window the ends of what rings on would leak up there.
  const Eigen::ArrayXd phase = Eigen::ArrayXd::LinSpaced(residual.size(), 0.0, 2.0 * std::numbers::pi);
  constexpr double kHannPower = 3.0 / 8.0;
  const Eigen::VectorXd windowed =
      (WithoutTrend(residual).array() * (0.5 - 0.5 * phase.cos())).matrix() / std::sqrt(kHannPower);
  std::vector<double> power = Periodogram(windowed);
  const auto bins = static_cast<double>(power.size());
  const std::vector<double> band(power.begin() + static_cast<std::ptrdiff_t>(0.7 * bins),
                                 power.begin() + static_cast<std::ptrdiff_t>(0.95 * bins));
  if (band.empty()) return 0.0;
  // A bin of white noise is exponentially distributed: its median is ln 2 of its mean n sigma^2.
  return std::sqrt(score::Median(band) / std::numbers::ln2 / static_cast<double>(residual.size()));
}

}  // namespace dynoproof::identification
