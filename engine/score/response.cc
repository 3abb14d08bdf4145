#include "score/response.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "score/fft.h"

namespace dynoproof::score {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

std::vector<Complex> DifferencedFft(std::span<const double> x, std::size_t padded) {
  std::vector<Complex> d(padded, 0.0);
  for (std::size_t i = 1; i < x.size(); ++i) d[i] = x[i] - x[i - 1];
  return Fft(d);
}

}  // namespace

std::vector<double> ChirpFrequency(std::span<const double> time_s, double f0_hz, double rate_hz_per_s) {
  std::vector<double> frequency(time_s.size());
  for (std::size_t i = 0; i < time_s.size(); ++i) frequency[i] = f0_hz + rate_hz_per_s * (time_s[i] - time_s[0]);
  return frequency;
}

double TimeOfFrequency(std::span<const double> time_s, std::span<const double> frequency_hz, double hz) {
  for (std::size_t i = 1; i < std::min(time_s.size(), frequency_hz.size()); ++i) {
    const double a = frequency_hz[i - 1] - hz;
    const double b = frequency_hz[i] - hz;
    if (a * b > 0.0 || !std::isfinite(a * b)) continue;
    return a == b ? time_s[i - 1] : time_s[i - 1] + (time_s[i] - time_s[i - 1]) * a / (a - b);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> Response::Magnitude() const {
  std::vector<double> magnitude(gain.size());
  for (std::size_t i = 0; i < gain.size(); ++i) magnitude[i] = std::abs(gain[i]);
  return magnitude;
}

Response EstimateResponse(std::span<const double> time_s, std::span<const double> input, std::span<const double> output,
                          const ResponseOptions& options) {
  Response out;
  out.reason = FaultOf({time_s, input}, "input", 64);
  if (out.reason.empty()) out.reason = FaultOf({time_s, output}, "output", 64);
  if (out.reason.empty()) out.reason = UniformFault(time_s, "record");
  if (!out.reason.empty()) return out;
  const std::size_t n = time_s.size();
  const double record = time_s.back() - time_s.front();
  const double rate = Num(n - 1) / record;
  if (!(options.from_hz >= 0.0 && options.to_hz > options.from_hz && options.to_hz < 0.5 * rate) ||
      !(options.smoothing_hz >= 0.0) || !std::isfinite(options.smoothing_hz)) {
    out.reason = fmt::format("response: the band {:.6g} to {:.6g} Hz does not lie below half the rate, {:.6g} Hz",
                             options.from_hz, options.to_hz, 0.5 * rate);
    return out;
  }

  const std::size_t padded = std::bit_ceil(2 * n);
  const std::vector<Complex> u = DifferencedFft(input, padded);
  const std::vector<Complex> y = DifferencedFft(output, padded);
  const double bin = rate / Num(padded);
  const double half_width = options.smoothing_hz > 0.0 ? options.smoothing_hz : 4.0 / record;
  const auto reach = static_cast<std::ptrdiff_t>(half_width / bin);
  std::vector<double> kernel;
  for (std::ptrdiff_t d = -reach; d <= reach; ++d)
    kernel.push_back(1.0 + std::cos(pi * static_cast<double>(d) / (static_cast<double>(reach) + 1.0)));

  const auto first = static_cast<std::size_t>(std::max(1.0, std::ceil(options.from_hz / bin)));
  const auto last = std::min(padded / 2 - 1, static_cast<std::size_t>(options.to_hz / bin));
  std::vector<double> density;  // of the input itself: differencing multiplied it by (2 sin(pi k / padded))^2
  for (std::size_t k = first; k <= last; ++k) {
    double s_uu = 0.0, s_yy = 0.0;
    Complex s_yu = 0.0;
    for (std::ptrdiff_t d = -reach; d <= reach; ++d) {
      const std::size_t j = (k + padded + static_cast<std::size_t>(d)) % padded;
      const double w = kernel[d + reach];
      s_uu += w * std::norm(u[j]);
      s_yy += w * std::norm(y[j]);
      s_yu += w * y[j] * std::conj(u[j]);
    }
    const double differencing = 2.0 * std::sin(pi * Num(k) / Num(padded));
    density.push_back(s_uu / (differencing * differencing));
    out.frequency_hz.push_back(Num(k) * bin);
    out.gain.push_back(s_uu > 0.0 ? s_yu / s_uu : 0.0);
    out.coherence.push_back(s_uu > 0.0 && s_yy > 0.0 ? std::min(1.0, std::norm(s_yu) / (s_uu * s_yy)) : 0.0);
  }
  if (density.size() < 8) {
    out.reason = fmt::format("response: the band holds {} bins of {:.4g} Hz, 8 needed", density.size(), bin);
    return out;
  }
  const double floor = 1e-4 * *std::max_element(density.begin(), density.end());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < density.size(); ++i) {
    if (!(density[i] > floor)) continue;
    out.frequency_hz[kept] = out.frequency_hz[i];
    out.gain[kept] = out.gain[i];
    out.coherence[kept++] = out.coherence[i];
  }
  out.frequency_hz.resize(kept);
  out.gain.resize(kept);
  out.coherence.resize(kept);
  if (Num(kept) < 0.9 * Num(density.size())) {
    out.reason = fmt::format("response: the input excites only {:.3g} % of the band {:.6g} to {:.6g} Hz",
                             100.0 * Num(kept) / Num(density.size()), options.from_hz, options.to_hz);
    return out;
  }
  out.verdict = Verdict::kPass;
  return out;
}

}  // namespace dynoproof::score
