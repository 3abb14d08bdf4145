// What the generators that share no code with the engine share among themselves: excitation, held inputs with lags and
// dead times, and a textbook Runge-Kutta method.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace dynoproof::blind {

/// Sum of sines with logarithmically spaced frequencies and seeded phases.
inline std::vector<double> IndependentSines(std::size_t samples, double period_s, unsigned seed, double rms,
                                            double low_Hz, double high_Hz, int lines) {
  std::vector<double> sum(samples);
  unsigned long long state = seed * 2654435761ULL + 12345ULL;
  for (int line = 0; line < lines; ++line) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    const double phase = 2.0 * M_PI * static_cast<double>(state >> 11) / 9007199254740992.0;
    const double frequency = low_Hz * std::pow(high_Hz / low_Hz, line / (lines - 1.0));
    for (std::size_t i = 0; i < samples; ++i)
      sum[i] +=
          rms * std::sqrt(2.0 / lines) * std::sin(2.0 * M_PI * frequency * period_s * static_cast<double>(i) + phase);
  }
  return sum;
}

/// One column through a first-order lag that starts settled, exact for held samples in the middle of each substep: its
/// first value instead, held, would be half a substep late, which an interval of 0.1 % sees.
inline std::vector<double> Lagged(const std::vector<double>& held, double lag_s, double period_s, int substeps) {
  std::vector<double> fine;
  double state = held.front();
  const double keep = std::exp(-period_s / substeps / lag_s);
  for (const double value : held) {
    for (int i = 0; i < substeps; ++i) {
      fine.push_back(value + std::sqrt(keep) * (state - value));
      state = value + keep * (state - value);
    }
  }
  return fine;
}

/// A column between its samples: `substeps` values each, held, after a dead time. Where it changes within a substep,
/// the mean over that: a dead time need not be a number of substeps.
inline std::vector<double> Delayed(const std::vector<double>& held, double delay_s, double period_s, int substeps) {
  const auto last = static_cast<double>(held.size() - 1);
  const auto sample = [&](double at) { return static_cast<std::size_t>(std::clamp(std::floor(at + 1e-9), 0.0, last)); };
  std::vector<double> fine;
  for (std::size_t i = 0; i < held.size() * substeps; ++i) {
    const double begin = static_cast<double>(i) / substeps - delay_s / period_s, end = begin + 1.0 / substeps;
    const double later = std::clamp((end - std::floor(end + 1e-9)) * substeps, 0.0, 1.0);  // share after the change
    fine.push_back((1.0 - later) * held[sample(begin)] + later * held[sample(end)]);
  }
  return fine;
}

/// x' = f(x, u) by Runge-Kutta 4 with inputs that stand at `substeps` values a sample; the state at every sample.
template <std::size_t N, std::size_t M>
std::vector<std::array<double, N>> Integrate(
    std::array<double, N> x, const std::array<std::vector<double>, M>& inputs, double period_s, int substeps,
    const std::function<std::array<double, N>(const std::array<double, N>&, const std::array<double, M>&)>& f) {
  std::vector<std::array<double, N>> states;
  const double h = period_s / substeps;
  const auto moved = [](const std::array<double, N>& s, const std::array<double, N>& d, double step) {
    std::array<double, N> out;
    for (std::size_t i = 0; i < N; ++i) out[i] = s[i] + step * d[i];
    return out;
  };
  for (std::size_t k = 0; k < inputs[0].size(); ++k) {
    if (k % substeps == 0) states.push_back(x);
    std::array<double, M> u;
    for (std::size_t i = 0; i < M; ++i) u[i] = inputs[i][k];
    const auto a = f(x, u), b = f(moved(x, a, h / 2), u), c = f(moved(x, b, h / 2), u), d = f(moved(x, c, h), u);
    for (std::size_t i = 0; i < N; ++i) x[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
  }
  return states;
}

}  // namespace dynoproof::blind
