// Whether a law is linear for good, asked over many decades of its arguments.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "model/law.h"

namespace dynoproof::testing {

/// Where a law departs from what Law::is_linear() promises; empty when it does not. Twist [rad], rate [rad/s] and
/// states (over their usual magnitudes) are asked at 0 and at each power of ten from 1e-9 to 1e6, of either sign and
/// each beside each other, at several times: a bend at any size between is seen from beyond or from below it.
inline std::string WhereItBends(const Law& law) {
  const Layout& own = law.layout();
  if (own.modes > 0 || own.guards > 0 || law.sticks()) return "it has modes, has guards or sticks";
  const std::size_t n = own.states.size();
  const std::size_t count = n + 2;  // arguments: states, twist, rate
  struct Answer {
    std::vector<double> values;  // rates of the states, torque
  };
  const auto ask = [&](double time, const std::vector<double>& x) {
    Answer answer{std::vector<double>(n + 1, 0.0)};
    const LawView view{time, x[n], x[n + 1], 0.0, {x.data(), n}, {}};
    law.Derivative(view, {answer.values.data(), n});
    answer.values[n] = law.Torque(view);
    return answer;
  };
  std::vector<Answer> columns;
  for (std::size_t j = 0; j < count; ++j) {
    std::vector<double> unit(count, 0.0);
    unit[j] = 1.0;
    columns.push_back(ask(0.0, unit));
  }
  if (n == 0) columns = {{{law.linear().stiffness}}, {{law.linear().damping}}};
  std::vector<double> sizes = {0.0};
  for (int e = -9; e <= 6; ++e) {
    const double size = std::pow(10.0, e);
    sizes.insert(sizes.end(), {size, -size});
  }
  for (const double time : {0.0, 1e-3, 5.0, 1e4}) {
    for (const double twist : sizes) {
      for (const double rate : sizes) {
        for (const double state : n > 0 ? sizes : std::vector<double>{0.0}) {
          std::vector<double> x(count);
          for (std::size_t j = 0; j < n; ++j) x[j] = state * own.states[j].nominal * (j % 2 == 0 ? 1.0 : -0.7);
          x[n] = twist;
          x[n + 1] = rate;
          const Answer answer = ask(time, x);
          for (std::size_t i = 0; i <= n; ++i) {
            double expected = 0.0, terms = 0.0;
            for (std::size_t j = 0; j < count; ++j) {
              expected += columns[j].values[i] * x[j];
              terms += std::abs(columns[j].values[i] * x[j]);
            }
            // Each term and each sum rounds once, here and in the law: a dozen roundings of 1.1e-16 are far below.
            if (std::abs(answer.values[i] - expected) <= 1e-12 * terms) continue;
            return fmt::format("{} is {} instead of {} at t = {} s, twist {} rad, rate {} rad/s, states {} of usual",
                               i == n ? "torque" : "rate of " + own.states[i].name, answer.values[i], expected, time,
                               twist, rate, state);
          }
        }
      }
    }
  }
  return "";
}

}  // namespace dynoproof::testing
