#include "diagnosis/localisation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "identification/noise_model.h"
#include "score/fft.h"
#include "score/series.h"

namespace dynoproof::diagnosis {
namespace {

std::vector<std::pair<double, double>> Spans(const std::vector<bool>& bad, const std::vector<double>& edges) {
  std::vector<std::pair<double, double>> spans;
  for (std::size_t i = 0; i < bad.size(); ++i) {
    if (!bad[i]) continue;
    if (i > 0 && bad[i - 1] && !spans.empty()) {
      spans.back().second = edges[i + 1];
    } else {
      spans.emplace_back(edges[i], edges[i + 1]);
    }
  }
  return spans;
}

std::vector<std::pair<double, double>> Times(const Eigen::VectorXd& residual, const ComparedOutput& channel,
                                             double floor) {
  constexpr std::size_t kWindows = 40;
  std::vector<bool> bad(kWindows);
  std::vector<double> edges;
  for (std::size_t i = 0; i <= kWindows; ++i)
    edges.push_back(channel.step_s * static_cast<double>(channel.count) * static_cast<double>(i) / kWindows);
  for (std::size_t i = 0; i < kWindows; ++i) {
    const Eigen::Index begin = channel.count * static_cast<Eigen::Index>(i) / static_cast<Eigen::Index>(kWindows);
    const Eigen::Index end = channel.count * static_cast<Eigen::Index>(i + 1) / static_cast<Eigen::Index>(kWindows);
    if (end <= begin) continue;
    bad[i] =
        std::sqrt(residual.segment(begin, end - begin).squaredNorm() / static_cast<double>(end - begin)) > 2 * floor;
  }
  return Spans(bad, edges);
}

/// Third-octave bands whose power is more than four times that of white noise at the floor.
std::vector<std::pair<double, double>> Bands(const Eigen::VectorXd& residual, const ComparedOutput& channel,
                                             double floor) {
  std::vector<double> x(residual.data(), residual.data() + residual.size());
  const double mean = residual.mean();
  for (double& value : x) value -= mean;
  const auto spectrum = score::Fft(std::span<const double>(x));
  const auto n = static_cast<double>(x.size());
  const double width = 1.0 / (n * channel.step_s);
  std::vector<double> edges;
  for (double f = 4.0 * width; f < 0.5 / channel.step_s; f *= std::cbrt(2.0)) edges.push_back(f);
  if (edges.size() < 2) return {};
  std::vector<bool> bad(edges.size() - 1);
  for (std::size_t b = 0; b < bad.size(); ++b) {
    double power = 0.0;
    int bins = 0;
    for (auto k = static_cast<std::size_t>(edges[b] / width); k < static_cast<std::size_t>(edges[b + 1] / width); ++k) {
      power += std::norm(spectrum[k]);
      ++bins;
    }
    bad[b] = bins > 0 && power / bins > 4.0 * n * floor * floor;
  }
  return Spans(bad, edges);
}

/// Ratio of the residual's RMS where `x` is in its upper third to that in its lower third.
double Contrast(const Eigen::VectorXd& residual, const std::vector<double>& x) {
  std::vector<double> sorted = x;
  std::sort(sorted.begin(), sorted.end());
  const double low = sorted[sorted.size() / 3], high = sorted[2 * sorted.size() / 3];
  double sums[2] = {0.0, 0.0}, counts[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double square = residual[static_cast<Eigen::Index>(i)] * residual[static_cast<Eigen::Index>(i)];
    if (x[i] >= high) sums[1] += square, ++counts[1];
    if (x[i] <= low) sums[0] += square, ++counts[0];
  }
  return sums[0] > 0.0 && counts[0] > 0 && counts[1] > 0 ? std::sqrt(sums[1] / counts[1] / (sums[0] / counts[0])) : 1.0;
}

std::string Condition(const EstimationProblem& problem, const ComparedOutput& channel,
                      const Eigen::VectorXd& residual) {
  const MappedRecord& record = problem.records()[channel.record];
  const std::vector<double>& time = *record.outputs.at(channel.name).time;
  std::string text;
  double clearest = 1.5;  // below, nobody would see a difference
  const auto look = [&](const std::string& name, const Series& series, bool held) {
    const std::vector<double> x = score::SampleAt(
        {*series.time, *series.values, held ? score::Interpolation::kHold : score::Interpolation::kLinear}, time);
    std::vector<double> size(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) size[i] = std::abs(x[i]);
    for (const auto& [what, values] : {std::pair("", std::cref(x)), std::pair("the magnitude of ", std::cref(size))}) {
      const double ratio = Contrast(residual, values);
      const double clear = std::max(ratio, 1.0 / ratio);
      if (clear <= clearest) continue;
      clearest = clear;
      text = fmt::format("{:.1f} times larger where {}{} is {}", clear, what, name, ratio > 1.0 ? "high" : "low");
    }
  };
  for (const auto& [name, series] : record.inputs) look(name, series, true);
  for (const auto& [name, series] : record.outputs) look(name, series, false);
  return text;
}

}  // namespace

WhereWrong LocaliseIn(const EstimationProblem& problem, const Eigen::VectorXd& residual, std::size_t at, double floor) {
  constexpr double kWorth = 1.5;  // times the floor: below, nobody would see a difference
  const ComparedOutput& channel = problem.channels()[at];
  const Eigen::VectorXd rows = residual.segment(channel.begin, channel.count);
  WhereWrong where{channel.name, Times(rows, channel, floor), Bands(rows, channel, floor), ""};
  if (RmsOf(rows) > kWorth * floor) where.condition = Condition(problem, channel, rows);
  return where;
}

WhereWrong Localise(const EstimationProblem& problem, const Eigen::VectorXd& residual,
                    const std::vector<double>& floor) {
  double worst = 0.0;
  std::size_t at = 0;
  for (std::size_t c = 0; c < problem.channels().size(); ++c) {
    const ComparedOutput& channel = problem.channels()[c];
    const double rms = RmsOf(residual.segment(channel.begin, channel.count));
    if (floor[c] > 0.0 && rms / floor[c] > worst) worst = rms / floor[c], at = c;
  }
  return LocaliseIn(problem, residual, at, floor[at]);
}

}  // namespace dynoproof::diagnosis
