// The pressure plants of thesis ch. 6 once more, from literal numbers and a textbook Runge-Kutta method, without a line
// of the engine: a sign error cannot hide on both sides. Inputs are held from one sample to the next.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/blind/independent_tools.h"

namespace dynoproof::blind {

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
