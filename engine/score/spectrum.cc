#include "score/spectrum.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "score/fft.h"

namespace dynoproof::score {
namespace {

using std::numbers::pi;

// w(n) = sum_m c_m cos(2 pi m n / N)
std::array<double, 3> Coefficients(Window window) {
  switch (window) {
    case Window::kHann:
      return {0.5, -0.5, 0.0};
    case Window::kBlackman:
      return {0.42, -0.5, 0.08};
    case Window::kRectangular:
      break;
  }
  return {1.0, 0.0, 0.0};
}

// Transform of n ones, `x` bins off, over n.
std::complex<double> Dirichlet(double x, double n) {
  const double below = n * std::sin(pi * x / n);
  const double magnitude = std::abs(x) < 1e-12 ? 1.0 : std::sin(pi * x) / below;
  return std::polar(1.0, -pi * x * (n - 1.0) / n) * magnitude;
}

// |W(x)| of the window, `x` bins off the tone; 1 at x = 0 for the rectangular one.
double WindowResponse(Window window, double x, double n) {
  const auto c = Coefficients(window);
  std::complex<double> sum = c[0] * Dirichlet(x, n);
  for (int m = 1; m < 3; ++m)
    if (c[m] != 0.0) sum += 0.5 * c[m] * (Dirichlet(x - m, n) + Dirichlet(x + m, n));
  return std::abs(sum);
}

// How far right of its bin a tone lies, from the bin's amplitude and its neighbours', in -0.5 .. 0.5.
double BinOffset(Window window, double left, double middle, double right, double n) {
  const double seen = (right - left) / middle;
  double low = -0.5;
  double high = 0.5;
  for (int i = 0; i < 60; ++i) {  // the ratio rises with the offset
    const double d = 0.5 * (low + high);
    const double ratio =
        (WindowResponse(window, 1.0 - d, n) - WindowResponse(window, -1.0 - d, n)) / WindowResponse(window, -d, n);
    (ratio < seen ? low : high) = d;
  }
  return 0.5 * (low + high);
}

}  // namespace

std::vector<double> WindowWeights(Window window, std::size_t n) {
  const auto c = Coefficients(window);
  std::vector<double> w(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2.0 * pi * Num(i) / Num(n);
    w[i] = c[0] + c[1] * std::cos(angle) + c[2] * std::cos(2.0 * angle);
  }
  return w;
}

Spectrum AmplitudeSpectrum(const Series& signal, Window window, bool remove_mean) {
  Spectrum out;
  out.window = window;
  out.reason = FaultOf(signal, "signal", 8);
  if (out.reason.empty()) out.reason = UniformFault(signal.time_s, "signal");
  if (!out.reason.empty()) return out;

  const std::size_t n = signal.values.size();
  const std::vector<double> w = WindowWeights(window, n);
  const double mean = remove_mean ? Mean(signal.values) : 0.0;
  std::vector<double> x(n);
  double sum = 0.0, sum_of_squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = (signal.values[i] - mean) * w[i];
    sum += w[i];
    sum_of_squares += w[i] * w[i];
  }
  const auto transform = Fft(x);
  out.samples = n;
  out.bin_hz = Num(n - 1) / (signal.time_s.back() - signal.time_s.front()) / Num(n);
  for (std::size_t k = 0; k <= n / 2; ++k) {
    const double magnitude = std::abs(transform[k]);
    const double sides = (k == 0 || 2 * k == n) ? 1.0 : 2.0;  // the mean and the Nyquist bin have no mirror image
    out.frequency_hz.push_back(Num(k) * out.bin_hz);
    out.amplitude.push_back(sides * magnitude / sum);
    out.power.push_back(sides * magnitude * magnitude / (Num(n) * sum_of_squares));
  }
  out.verdict = Verdict::kPass;
  return out;
}

BandRms RmsInBand(const Spectrum& spectrum, double from_hz, double to_hz) {
  BandRms out;
  if (!spectrum.ok()) {
    out.reason = spectrum.reason.empty() ? "no spectrum" : spectrum.reason;
    return out;
  }
  double sum = 0.0;
  std::size_t bins = 0;
  for (std::size_t k = 0; k < spectrum.power.size(); ++k) {
    if (!(spectrum.frequency_hz[k] >= from_hz && spectrum.frequency_hz[k] <= to_hz)) continue;
    sum += spectrum.power[k];
    ++bins;
  }
  if (bins == 0 || !std::isfinite(to_hz - from_hz)) {
    out.reason = fmt::format("the band {:.6g} to {:.6g} Hz holds no bin of {:.4g} Hz", from_hz, to_hz, spectrum.bin_hz);
    return out;
  }
  out.rms = std::sqrt(sum);
  out.verdict = Verdict::kPass;
  return out;
}

Tone DominantTone(const Spectrum& spectrum, double from_hz, double to_hz) {
  Tone tone;
  if (!spectrum.ok()) {
    tone.reason = spectrum.reason.empty() ? "no spectrum" : spectrum.reason;
    return tone;
  }
  const auto& a = spectrum.amplitude;
  std::size_t best = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const bool inside = spectrum.frequency_hz[k] >= from_hz && spectrum.frequency_hz[k] <= to_hz;
    if (inside && k > 0 && (best == 0 || a[k] > a[best])) best = k;
  }
  if (best == 0 || best + 1 >= a.size() || !(a[best] > 0.0) || a[best - 1] > a[best] || a[best + 1] > a[best]) {
    tone.reason = fmt::format("no tone between {:.6g} and {:.6g} Hz", from_hz, to_hz);
    return tone;
  }
  const double n = Num(spectrum.samples);
  const double d = BinOffset(spectrum.window, a[best - 1], a[best], a[best + 1], n);
  tone.frequency_hz = (Num(best) + d) * spectrum.bin_hz;
  tone.amplitude = a[best] * WindowResponse(spectrum.window, 0.0, n) / WindowResponse(spectrum.window, -d, n);
  tone.verdict = Verdict::kPass;
  return tone;
}

}  // namespace dynoproof::score
