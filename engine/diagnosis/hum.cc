#include "diagnosis/hum.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/policy.h"
#include "linear/dense.h"
#include "score/spectrum.h"

namespace dynoproof::diagnosis {
namespace {

using score::Spectrum;

/// Bins that a Hann window makes of a tone, to each side, with one more for a tone between two bins.
constexpr double kTonesBins = 3.0;

/// What counts as the tone's own place in a spectrum, to each side [Hz].
double BesideOf(const Spectrum& spectrum) { return std::max(policy::kBesideHum_hz, kTonesBins * spectrum.bin_hz); }

double LargestWhere(const Spectrum& spectrum, const auto& counts) {
  double largest = 0.0;
  for (std::size_t k = 1; k < spectrum.amplitude.size(); ++k) {
    if (counts(spectrum.frequency_hz[k])) largest = std::max(largest, spectrum.amplitude[k]);
  }
  return largest;
}

/// The tone that stands above everything further off.
std::optional<score::Tone> LoneTone(const Spectrum& spectrum) {
  const double beside = BesideOf(spectrum);
  if (!spectrum.ok() || spectrum.frequency_hz.back() <= 2.0 * beside) return std::nullopt;
  const score::Tone tone = score::DominantTone(spectrum, beside, spectrum.frequency_hz.back() - beside);
  if (!tone.ok()) return std::nullopt;
  const double others = LargestWhere(spectrum, [&](double f) { return std::abs(f - tone.frequency_hz) > beside; });
  return tone.amplitude >= policy::kHumAbove * others ? std::optional(tone) : std::nullopt;
}

/// A tone by least squares over the whole course.
Hum FittedTo(const std::vector<double>& time, const std::vector<double>& values, double frequency_hz) {
  Eigen::MatrixXd columns(std::ssize(time), 3);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const double phase = 2.0 * std::numbers::pi * frequency_hz * time[static_cast<std::size_t>(i)];
    columns.row(i) << std::sin(phase), std::cos(phase), 1.0;
  }
  const Eigen::Map<const Eigen::VectorXd> y(values.data(), std::ssize(values));
  const Eigen::VectorXd x = dense::LeastSquares(columns.transpose() * columns, columns.transpose() * y);
  Hum hum;
  hum.frequency_hz = frequency_hz;
  hum.sine = x[0];
  hum.cosine = x[1];
  return hum;
}

/// Whether a tone is the same one in both halves of a course.
bool IsSteady(const Hum& hum, const std::vector<double>& time, const std::vector<double>& values) {
  const auto half = static_cast<std::ptrdiff_t>(time.size() / 2);
  const Hum first = FittedTo({time.begin(), time.begin() + half}, {values.begin(), values.begin() + half},
                             hum.frequency_hz),
            second =
                FittedTo({time.begin() + half, time.end()}, {values.begin() + half, values.end()}, hum.frequency_hz);
  return std::hypot(first.sine - second.sine, first.cosine - second.cosine) <=
         policy::kHumUnsteady * std::hypot(hum.sine, hum.cosine);
}

/// Whether a frequency is a multiple of that of an input which is a tone itself: a bent characteristic answers with these.
bool IsOfAnInput(const MappedRecord& record, double frequency_hz) {
  return std::ranges::any_of(record.inputs, [&](const auto& input) {
    const Spectrum spectrum =
        score::AmplitudeSpectrum({*input.second.time, *input.second.values}, score::Window::kHann, true);
    const std::optional<score::Tone> tone = spectrum.ok() ? LoneTone(spectrum) : std::nullopt;
    if (!tone) return false;
    const double order = std::max(1.0, std::round(frequency_hz / tone->frequency_hz));
    return std::abs(frequency_hz - order * tone->frequency_hz) <= kTonesBins * spectrum.bin_hz;
  });
}

}  // namespace

double Hum::At(double time_s) const {
  const double phase = 2.0 * std::numbers::pi * frequency_hz * time_s;
  return sine * std::sin(phase) + cosine * std::cos(phase);
}

std::vector<Hum> FindHum(const identification::EstimationProblem& problem, const Plan& plan) {
  std::vector<Hum> all;
  const Result<Eigen::VectorXd> predicted = problem.PredictPlan(plan);
  if (!predicted.ok()) return all;
  const Eigen::VectorXd residual = problem.measured() - *predicted;
  for (const identification::ComparedOutput& channel : problem.channels()) {
    const auto begin = problem.time_s().begin() + channel.begin;
    const std::vector<double> time(begin, begin + channel.count);
    std::vector<double> left(residual.data() + channel.begin, residual.data() + channel.begin + channel.count);
    const auto spectrum_of = [&] { return score::AmplitudeSpectrum({time, left}, score::Window::kHann, true); };
    const Spectrum spectrum = spectrum_of();
    const std::optional<score::Tone> tone = LoneTone(spectrum);
    if (!tone || IsOfAnInput(problem.records()[channel.record], tone->frequency_hz)) continue;
    Hum hum = FittedTo(time, left, tone->frequency_hz);
    hum.share = std::hypot(hum.sine, hum.cosine) / std::numbers::sqrt2 / std::max(channel.spread, 1e-300);
    if (hum.share > policy::kMostHumShare || !IsSteady(hum, time, left)) continue;
    for (std::size_t i = 0; i < time.size(); ++i) left[i] -= hum.At(time[i]);
    // A resonance that is driven over some width leaves most of itself.
    const double stays =
        LargestWhere(spectrum_of(), [&](double f) { return std::abs(f - hum.frequency_hz) <= BesideOf(spectrum); });
    if (stays > policy::kHumLeaves * tone->amplitude) continue;
    hum.record = channel.record;
    hum.signal = channel.name;
    all.push_back(hum);
  }
  return all;
}

std::string ToText(const std::vector<Hum>& hum) {
  std::string text;
  for (const Hum& one : hum)
    text += fmt::format("{}{:.4g} Hz, {:.2g} % of {}", text.empty() ? "" : "; ", one.frequency_hz, 100.0 * one.share,
                        one.signal);
  return text;
}

}  // namespace dynoproof::diagnosis
