// The heavy-duty chain of five inertias once more, from literal numbers and a textbook Runge-Kutta method, without a
// line of the engine: a sign error cannot hide on both sides. Held torque at 10 kHz on the first inertia.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tests/blind/independent_tools.h"

namespace dynoproof::blind {

struct IndependentLine {
  // Table A.1, first setup.
  std::array<double, 5> inertia = {25.082, 6.352, 1.572, 0.159, 0.140};
  std::array<double, 4> stiffness = {60.99e6, 17.99e6, 3.36e6, 6.28e6};
  std::array<double, 4> damping = {850.4, 800.0, 0.0, 0.0};
  double start_speed = 0.0;
  /// Torque added on an inertia, from its speed; empty: none.
  std::array<std::function<double(double speed)>, 5> load = {};
  /// Torque added to a shaft's own, from its twist [rad] and rate; empty: none.
  std::array<std::function<double(double twist, double rate)>, 4> shaft = {};
  /// What becomes of the held input.
  std::function<double(double)> actuator = {};

  struct Output {
    std::vector<double> T_shaft, omega_1;
  };

  /// One row a sample of `input`; `substeps` Runge-Kutta steps of fourth order between two. The undamped mode at 1560
  /// Hz loses (omega h)^6 / 144 of its amplitude a step: 1e-6 in 1.4 s; with 10 substeps it is 9e-4, which is found.
  Output Run(const std::vector<double>& input, double period_s = 1e-4, int substeps = 40) const {
    using State = std::array<double, 10>;  // angles, speeds
    State x = {};
    for (std::size_t i = 0; i < 5; ++i) x[5 + i] = start_speed;
    const auto twist_torque = [this](const State& s, std::size_t k) {
      const double twist = s[k] - s[k + 1], rate = s[5 + k] - s[6 + k];
      const double linear = stiffness[k] * twist + damping[k] * rate;
      return shaft[k] ? linear + shaft[k](twist, rate) : linear;
    };
    const auto rates = [&](const State& s, const std::array<double, 1>& u) {
      State d;
      std::array<double, 5> sum = {u[0], 0.0, 0.0, 0.0, 0.0};
      for (std::size_t k = 0; k < 4; ++k) {
        const double t = twist_torque(s, k);
        sum[k] -= t;
        sum[k + 1] += t;
      }
      for (std::size_t i = 0; i < 5; ++i) {
        if (load[i]) sum[i] += load[i](s[5 + i]);
        d[i] = s[5 + i];
        d[5 + i] = sum[i] / inertia[i];
      }
      return d;
    };
    std::vector<double> torque;
    for (const double command : input)
      torque.insert(torque.end(), static_cast<std::size_t>(substeps), actuator ? actuator(command) : command);
    Output output;
    for (const State& s : Integrate<10, 1>(x, {std::move(torque)}, period_s, substeps, rates)) {
      output.T_shaft.push_back(twist_torque(s, 3));
      output.omega_1.push_back(s[5]);
    }
    return output;
  }
};

/// A hundred sines between `low` and `high` Hz with seeded phases, and a slow swing: an excitation of its own.
inline std::vector<double> IndependentTorque(std::size_t samples, unsigned seed, double rms = 300.0,
                                             double swing = 400.0) {
  std::vector<double> torque = IndependentSines(samples, 1e-4, seed, rms, 1.3, 1700.0, 100);
  for (std::size_t i = 0; i < samples; ++i)
    torque[i] += swing * std::sin(2.0 * M_PI * 0.45 * 1e-4 * static_cast<double>(i));
  return torque;
}

}  // namespace dynoproof::blind
