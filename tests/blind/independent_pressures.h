// The pressure plants of thesis ch. 6 once more, from literal numbers and a textbook Runge-Kutta method, without a line
// of the engine: a sign error cannot hide on both sides. Inputs are held from one sample to the next.
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

/// One column through a first-order lag that starts settled, exact for held samples.
inline std::vector<double> Lagged(const std::vector<double>& held, double lag_s, double period_s, int substeps) {
  std::vector<double> fine;
  double state = held.front();
  const double keep = std::exp(-period_s / substeps / lag_s);
  for (const double value : held) {
    for (int i = 0; i < substeps; ++i) {
      fine.push_back(state);
      state = value + keep * (state - value);
    }
  }
  return fine;
}

/// A column between its samples: `substeps` values each, held, after a dead time.
inline std::vector<double> Delayed(const std::vector<double>& held, double delay_s, double period_s, int substeps) {
  std::vector<double> fine;
  for (std::size_t i = 0; i < held.size() * substeps; ++i) {
    const double at = std::max(0.0, static_cast<double>(i) / substeps - delay_s / period_s + 1e-9);
    fine.push_back(held[static_cast<std::size_t>(at)]);
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

/// (6.23)-(6.28): membrane, valve and volume of the fuel gas supply.
struct IndependentGas {
  static constexpr int kSubsteps = 10;
  double mass = 0.5, stiffness = 2e4, damping = 400.0, preload = 200.0, volume = 0.02;
  double area_factor = 1.0, droop = 0.0, leak = 0.0;  // 1, Pa s/kg, m^2

  /// p_g [Pa] at every sample; inputs with kSubsteps values a sample.
  std::vector<double> Run(const std::vector<double>& p_mem, const std::vector<double>& q_e, double period_s) const {
    const double RT = 518.0 * 300.0, reservoir = 10e5, membrane = 0.02;
    const double slope = area_factor * reservoir / std::sqrt(2.0 * RT) * 0.02, rest = area_factor * 0.03;
    // q = open (p_res - droop q) / p_res
    const auto inflow = [&](double x) {
      const double open = std::max(0.0, slope * x + rest);
      return open / (1.0 + droop / reservoir * open);
    };
    const auto leaking = [&](double p) { return leak * p / std::sqrt(RT) / std::sqrt(2.0); };  // choked: p > 2 bar
    double x = 0.0;
    for (int i = 0; i < 200; ++i) {  // at rest
      const double p = p_mem[0] - (preload + stiffness * x) / membrane;
      x += 0.5 * (q_e[0] + leaking(p) - inflow(x)) / slope;
    }
    const auto states =
        Integrate<3, 2>({x, 0.0, p_mem[0] - (preload + stiffness * x) / membrane}, {p_mem, q_e}, period_s, kSubsteps,
                        [&](const std::array<double, 3>& s, const std::array<double, 2>& u) -> std::array<double, 3> {
                          const double force = membrane * (u[0] - s[2]) - preload - stiffness * s[0] - damping * s[1];
                          return {s[1], force / mass, RT / volume * (inflow(s[0]) - leaking(s[2]) - u[1])};
                        });
    std::vector<double> p_g;
    for (const auto& s : states) p_g.push_back(s[2]);
    return p_g;
  }
};

/// (6.3)-(6.5): charge volume, supply volume and the flaps behind each other.
struct IndependentAir {
  static constexpr int kSubsteps = 20;
  std::array<double, 2> volume = {0.4, 1.2}, area_factor = {1.0, 1.0}, leak = {0.0, 0.0};

  /// {p_ch, p_s} [Pa] at every sample; inputs u_1, u_2 [%], q_e, q_c [kg/s] with kSubsteps values a sample.
  std::array<std::vector<double>, 2> Run(const std::array<std::vector<double>, 4>& inputs, double period_s) const {
    const double RT = 287.05 * 320.0, ambient = 101300.0;
    const std::array<double, 2> span = {9e-3, 4.5e-3};
    const auto psi = [](double ratio) {
      return ratio > 2.0 ? std::sqrt(0.5) : std::sqrt(2.0 / ratio * (1.0 - 1.0 / ratio));
    };
    const auto flow = [&](double area, double up, double down) {
      return up >= down ? area * up / std::sqrt(RT) * psi(up / down) : -area * down / std::sqrt(RT) * psi(down / up);
    };
    const auto area = [&](std::size_t flap, double u) {
      return area_factor[flap] * (1e-5 + span[flap] * (1.0 - std::cos(M_PI * std::clamp(u, 0.0, 100.0) / 200.0)));
    };
    const auto states =
        Integrate<2, 4>({3.5e5, 5.0e5}, inputs, period_s, kSubsteps,
                        [&](const std::array<double, 2>& p, const std::array<double, 4>& u) -> std::array<double, 2> {
                          const double q_1 = flow(area(0, u[0]), p[1], p[0]), q_2 = flow(area(1, u[1]), p[1], ambient);
                          return {RT / volume[0] * (q_1 - u[2] - flow(leak[0], p[0], ambient)),
                                  RT / volume[1] * (u[3] - q_2 - q_1 - flow(leak[1], p[1], ambient))};
                        });
    std::array<std::vector<double>, 2> out;
    for (const auto& p : states) {
      out[0].push_back(p[0]);
      out[1].push_back(p[1]);
    }
    return out;
  }
};

}  // namespace dynoproof::blind
