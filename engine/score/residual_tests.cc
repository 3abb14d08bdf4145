// Candidates of candidates.h that look at the difference alone: noise, and a divergence that starts at a moment.
#include "score/residual_tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "score/fft.h"

namespace dynoproof::score {
namespace {

// Largest correlation of two centred arrays over the lags, in standard deviations of chance (one array must be white).
double LargestCorrelation(std::span<const double> a, std::span<const double> b, std::size_t lags) {
  const double norm = RootMeanSquare(a) * RootMeanSquare(b) * std::sqrt(Num(a.size()));
  return norm > 0.0 ? Largest(CrossCorrelation(a, b, lags)) / norm : 0.0;
}

std::vector<double> Centred(std::span<const double> v) {
  std::vector<double> out(v.begin(), v.end());
  const double mean = Mean(v);
  for (double& value : out) value -= mean;
  return out;
}

std::vector<double> Squared(std::span<const double> v) {
  std::vector<double> out(v.begin(), v.end());
  for (double& value : out) value *= value;
  return out;
}

bool IsBellShaped(std::span<const double> d) {
  double m2 = 0.0, m4 = 0.0;
  for (double v : d) {
    m2 += v * v;
    m4 += v * v * v * v;
  }
  const double kurtosis = m4 * Num(d.size()) / (m2 * m2);
  // 3 for a normal distribution, with a scatter of sqrt(24/n); a uniform one (quantisation) has 1.8, spikes have more.
  return std::abs(kurtosis - 3.0) <= 0.5 + 4.0 * std::sqrt(24.0 / Num(d.size()));
}

bool IsSteady(std::span<const double> d) {
  const std::size_t block = d.size() / 8;
  const double all = RootMeanSquare(d);
  const double scatter = std::sqrt(2.0 / Num(block));  // of the logarithm of a block's variance
  for (std::size_t b = 0; b < 8; ++b) {
    const double rms = RootMeanSquare(d.subspan(b * block, block));
    if (!(std::abs(2.0 * std::log(rms / all)) <= 0.1 + 4.5 * scatter)) return false;
  }
  return true;
}

}  // namespace

// Wilson-Hilferty turns chi-square into a normal score.
double WhitenessScore(std::span<const double> centred, std::size_t lags) {
  const std::vector<double> c = CrossCorrelation(centred, centred, lags);
  const double n = Num(centred.size()), m = Num(lags);
  double q = 0.0;
  for (std::size_t l = 1; l <= lags; ++l) {
    const double rho = c[lags + l] / c[lags];
    q += rho * rho / (n - Num(l));
  }
  q *= n * (n + 2.0);
  return (std::cbrt(q / m) - (1.0 - 2.0 / (9.0 * m))) / std::sqrt(2.0 / (9.0 * m));
}

void AddNoise(const Pair& pair, const std::string& unit, Candidates& out) {
  const std::vector<double> d = Centred(pair.d), x = Centred(pair.x);
  const std::size_t lags = std::min<std::size_t>(40, d.size() / 10);
  const double sigma = RootMeanSquare(d);
  if (!(sigma > 0.0)) return;
  // Scores that chance exceeds in about one record in a thousand each.
  if (WhitenessScore(d, lags) > 3.1 || !IsBellShaped(d) || !IsSteady(d)) return;
  if (LargestCorrelation(d, x, lags) > 4.5) return;
  if (LargestCorrelation(Centred(Squared(d)), Centred(Squared(x)), 0) > 4.0)
    return;  // noise in the gain, not on the signal
  Candidate c;
  c.cause = Cause::kNoise;
  c.complexity = 10;
  c.structural = false;
  const double mean = Mean(pair.d);
  c.unexplained = mean * mean * Num(d.size()) / pair.difference_square;
  c.quantities.push_back({"sigma", sigma, unit});
  c.text = fmt::format("noise of {:.4g}{}{} RMS, white and unrelated to the reference", sigma, unit.empty() ? "" : " ",
                       unit);
  out.push_back(std::move(c));
}

void AddDivergence(const Pair& pair, Candidates& out) {
  const std::size_t n = pair.d.size();
  std::vector<double> sums(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) sums[i + 1] = sums[i] + pair.d[i] * pair.d[i];
  // The moment splits the difference into two parts of constant variance with the greatest likelihood.
  const double floor = 1e-14 * sums[n] / Num(n);
  double best = 0.0;
  std::size_t moment = 0;
  for (std::size_t i = n / 20; i <= n - n / 20; ++i) {
    const double before = sums[i] / Num(i) + floor, after = (sums[n] - sums[i]) / Num(n - i) + floor;
    const double cost = Num(i) * std::log(before) + Num(n - i) * std::log(after);
    if (moment == 0 || cost < best) {
      best = cost;
      moment = i;
    }
  }
  const double before = std::sqrt(sums[moment] / Num(moment)),
               after = std::sqrt((sums[n] - sums[moment]) / Num(n - moment));
  // Equal before: a thousandth of what follows, or a tenth if that is mere noise. And there was something to agree on.
  const std::span<const double> d(pair.d), x(pair.x);
  const std::size_t lags = std::min<std::size_t>(20, moment / 8);
  const bool silent = before <= 1e-3 * after;
  if (!silent && (before > 0.1 * after || lags < 4 || WhitenessScore(Centred(d.first(moment)), lags) > 3.1)) return;
  if (StandardDeviation(x.first(moment)) < 0.2 * StandardDeviation(x)) return;
  // Different from then on, not just now and then (a clipped signal is equal most of the time).
  const double visible = std::max(3.0 * before, 0.02 * after);
  const std::size_t blocks = 10, block = (n - moment) / blocks;
  if (block < 3) return;
  std::size_t exceeded = 0;
  for (std::size_t i = moment; i < n; ++i) exceeded += std::abs(pair.d[i]) > visible ? 1 : 0;
  if (Num(exceeded) < 0.7 * Num(n - moment)) return;
  Candidate c;
  c.cause = Cause::kDivergence;
  c.complexity = 12;
  c.structural = false;
  c.unexplained = sums[moment] / sums[n];
  const double time = pair.start_s + pair.step_s * Num(moment);
  c.quantities.push_back({"time", time, "s"});
  c.text = fmt::format("equal until {:.6g} s, different from then on", time);
  out.push_back(std::move(c));
}

}  // namespace dynoproof::score
