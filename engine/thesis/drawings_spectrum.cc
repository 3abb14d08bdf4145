#include "thesis/drawings_spectrum.h"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "control10k/classical.h"
#include "control10k/spectrum.h"

namespace dynoproof {
namespace {

using std::numbers::pi;

/// Fig. 5.10 with the pair of suppression/classical_band_pass_pair about 600 Hz.
Result<Picture> BandPassPair(const Registry&) {
  const control10k::ClassicalConfig config;
  constexpr double kMiddle_Hz = 600.0, kReal_Hz = 640.0, kFirst_Hz = 300.0, kLast_Hz = 1000.0;
  const double low = kMiddle_Hz / config.spread, high = kMiddle_Hz * config.spread;
  Picture picture{.key = "band_pass_pair",
                  .title = "Two band-pass filters about 600 Hz",
                  .note = fmt::format("sampled at 10 kHz, damping {:g}, centres {:g} times {:g} Hz and this over {:g}",
                                      config.damping, config.spread, kMiddle_Hz, config.spread),
                  .x = {"frequency", "Hz", false, kFirst_Hz, kLast_Hz},
                  .y = {"magnitude over that at the centre", "1"}};
  picture.marks = {{low, "nu_1"}, {kMiddle_Hz, "nu_0"}, {high, "nu_2"}, {kReal_Hz, "nu_real"}};
  for (const auto& [label, centre] : {std::pair{"W_l", low}, {"W_h", high}}) {
    Curve curve{label, {}, {}};
    // 2 d g w / (g^2 - w^2 + 2 d g w j) with both frequencies bent by the tangent, as the filter's own steps bend them.
    const double g = std::tan(pi * centre * config.period_s);
    for (double f = kFirst_Hz; f <= kLast_Hz; f += 1.0) {
      const double w = std::tan(pi * f * config.period_s), damped = 2.0 * config.damping * g * w;
      curve.x.push_back(f);
      curve.y.push_back(damped / std::hypot(g * g - w * w, damped));
    }
    picture.curves.push_back(std::move(curve));
  }
  return picture;
}

/// abs(X), (5.15), of a complex tone of amplitude 1 that lies `delta` bins away, behind the window (5.23) or as it is.
double Entry(double delta, int N, bool windowed) {
  std::complex<double> sum = 0.0;
  for (int n = 0; n < N; ++n) {
    const double x = 2.0 * pi * n / N;
    const double weight = windowed ? 0.42 - 0.5 * std::cos(x) + 0.08 * std::cos(2.0 * x) : 1.0;
    sum += weight * std::polar(1.0, delta * x);
  }
  return std::abs(sum);
}

/// Figs. 5.11, 5.12: the bins of the proposed scheme, N = 128 and 24 of them, and the lobes on which they lie.
Result<Picture> ToneBetweenBins(bool windowed) {
  constexpr int N = 128, kBins = 24;
  constexpr double kTone = 10.3;
  Picture picture{.key = windowed ? "windowed_tone" : "plain_tone",
                  .title = windowed ? "A tone between two bins behind a Blackman window"
                                    : "A tone between two bins without a window",
                  .note = fmt::format("complex tone of amplitude 1, N = {}, at bin {:g}", N, kTone),
                  .x = {"bin k", "1", false, 0.0, kBins},
                  .y = {"abs(X_k)", "1"}};
  Curve lobes{"between the bins", {}, {}, Curve::Style::kDashed}, bins{"bins", {}, {}, Curve::Style::kCircles};
  for (int i = 0; i <= 50 * kBins; ++i) {
    const double k = i / 50.0, height = Entry(kTone - k, N, windowed);
    lobes.x.push_back(k);
    lobes.y.push_back(height);
    if (i % 50 != 0) continue;
    bins.x.push_back(k);
    bins.y.push_back(height);
  }
  picture.curves = {std::move(lobes), std::move(bins)};
  picture.marks = {{kTone, "k_x"}, {windowed ? 0.42 * N : N, windowed ? "0.42 eta N" : "eta N", true}};
  return picture;
}
Result<Picture> PlainTone(const Registry&) { return ToneBetweenBins(false); }
Result<Picture> WindowedTone(const Registry&) { return ToneBetweenBins(true); }

/// Fig. 5.13: the inverse of b, (5.25), drawn by its own points, and its line (5.26), through which the core goes.
Result<Picture> OffsetOfBins(const Registry&) {
  constexpr int N = 128;
  Picture picture{.key = "offset_of_bins",
                  .title = "Index error by three entries behind a Blackman window",
                  .note = "N = 128; beyond half a bin another entry would be the largest",
                  .x = {"b, (5.25)", "1"},
                  .y = {"index error", "1"}};
  Curve inverse{"exact inverse", {}, {}}, line{"0.75 b", {}, {}, Curve::Style::kDashed};
  for (int i = -100; i <= 100; ++i) {
    const double delta = i / 100.0;
    const double left = Entry(delta + 1.0, N, true), middle = Entry(delta, N, true),
                 right = Entry(delta - 1.0, N, true);
    inverse.x.push_back((right - left) / middle);
    inverse.y.push_back(delta);
    line.x.push_back(inverse.x.back());
    line.y.push_back(control10k::BlackmanOffset(left, middle, right));
  }
  const double most = inverse.x.back();
  picture.areas.push_back({"less than half a bin", {-most, most, most, -most}, {-0.5, -0.5, 0.5, 0.5}});
  picture.curves = {std::move(inverse), std::move(line)};
  return picture;
}

/// Fig. 5.14, N = 100 and amplitude 1 as printed.
Result<Picture> LobeAndGaussian(const Registry&) {
  constexpr int N = 100;
  Picture picture{.key = "lobe_and_gaussian",
                  .title = "Lobe of a tone behind a Blackman window, and its Gaussian",
                  .note = "complex tone of amplitude 1, N = 100",
                  .x = {"index error", "1", false, -3.5, 3.5},
                  .y = {"abs(X)", "1"}};
  Curve lobe{"lobe", {}, {}}, gaussian{"Gaussian, (5.28)", {}, {}, Curve::Style::kDashed};
  for (int i = -350; i <= 350; ++i) {
    const double delta = i / 100.0;
    lobe.x.push_back(delta);
    lobe.y.push_back(Entry(delta, N, true));
    gaussian.x.push_back(delta);
    gaussian.y.push_back(0.42 * N * control10k::BlackmanLobe(delta));
  }
  picture.curves = {std::move(lobe), std::move(gaussian)};
  return picture;
}

}  // namespace

DrawingTable SpectrumDrawings() {
  return {{"band_pass_pair", BandPassPair},
          {"lobe_and_gaussian", LobeAndGaussian},
          {"offset_of_bins", OffsetOfBins},
          {"plain_tone", PlainTone},
          {"windowed_tone", WindowedTone}};
}

}  // namespace dynoproof
