#include "thesis/distributed.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "linear/modes.h"

namespace dynoproof::mechanics {
namespace {

using std::numbers::pi;

bool Positive(double value) { return std::isfinite(value) && value > 0.0; }
bool NotNegative(double value) { return std::isfinite(value) && value >= 0.0; }

Failure OutOfRange() {
  return {"inertias, stiffnesses and the highest frequency must be positive and finite", "", {}, 2};
}

/// The root of a function that is negative at a and positive at b.
double Root(const std::function<double(double)>& f, double a, double b) {
  const double at_a = f(a), at_b = f(b);
  if (at_a >= 0.0) return a;
  if (at_b <= 0.0) return b;
  std::uintmax_t steps = 200;
  const auto [low, high] =
      boost::math::tools::toms748_solve(f, a, b, at_a, at_b, boost::math::tools::eps_tolerance<double>(52), steps);
  return 0.5 * (low + high);
}

bool IsValid(const HybridRotor& rotor) {
  return Positive(rotor.inertia) && Positive(rotor.stiffness) && NotNegative(rotor.left_inertia) &&
         NotNegative(rotor.right_inertia) &&
         std::all_of(rotor.chain.begin(), rotor.chain.end(),
                     [](const Oscillator& o) { return Positive(o.stiffness) && Positive(o.inertia); });
}

}  // namespace

Result<std::vector<double>> SpatialEigenfrequencies(double inertia, double stiffness, double end_inertia,
                                                    double f_max_hz) {
  if (!(Positive(inertia) && Positive(stiffness) && Positive(end_inertia) && Positive(f_max_hz))) return OutOfRange();
  const double wave = std::sqrt(stiffness / inertia), ratio = inertia / end_inertia;  // nu = wave x
  std::vector<double> found;
  for (int m = 1; (m - 0.5) * pi * wave <= 2.0 * pi * f_max_hz; ++m) {
    // x cos x + ratio sin x has the same roots and no poles; the sign makes it rise through the root.
    const double sign = m % 2 == 0 ? 1.0 : -1.0;
    const auto f = [&](double x) { return sign * (x * std::cos(x) + ratio * std::sin(x)); };
    const double frequency = Root(f, (m - 0.5) * pi, m * pi) * wave / (2.0 * pi);
    if (frequency <= f_max_hz) found.push_back(frequency);
  }
  return found;
}

Result<std::vector<double>> HeuristicEigenfrequencies(double inertia, double stiffness, const Oscillator& oscillator,
                                                      double f_max_hz) {
  if (!(Positive(inertia) && Positive(stiffness) && Positive(oscillator.stiffness) && Positive(oscillator.inertia) &&
        Positive(f_max_hz))) {
    return OutOfRange();
  }
  const double wave = std::sqrt(stiffness / inertia), ratio = inertia / oscillator.inertia;
  const double x_0 = std::sqrt(oscillator.stiffness / oscillator.inertia) / wave;                          // (B.1)
  const double x_r = std::sqrt(oscillator.stiffness * (1.0 / inertia + 1.0 / oscillator.inertia)) / wave;  // (B.2)
  std::vector<double> poles{0.0, x_r};
  const double x_max = 2.0 * pi * f_max_hz / wave;
  for (int m = 1; (m - 1) * pi <= x_max; ++m) poles.push_back(m * pi);
  std::sort(poles.begin(), poles.end());
  std::vector<double> found;
  for (std::size_t i = 0; i + 1 < poles.size(); ++i) {
    const double a = poles[i], b = poles[i + 1];
    if (a == b || a > x_max) continue;
    // (left - right) sin x (x - x_r), free of poles; it keeps one sign for the factor inside the interval.
    const double middle = 0.5 * (a + b);
    const double sign = std::sin(middle) * (middle - x_r) > 0.0 ? 1.0 : -1.0;
    const auto f = [&](double x) { return sign * (-x * std::cos(x) * (x - x_r) - ratio * (x - x_0) * std::sin(x)); };
    // At x = 0 both sides meet (sin 0 = 0), but -1 < right: start just inside.
    const double frequency = Root(f, a > 0.0 ? a : 1e-9 * b, b) * wave / (2.0 * pi);
    if (frequency <= f_max_hz) found.push_back(frequency);
  }
  return found;
}

// Torques that the nodes need to swing with nu: rotor ends k x [cot x, -1/sin x; -1/sin x, cot x], springs and -nu^2 I.
// Pivots of this tridiagonal matrix from left to right.
int CountEigenfrequencies(const HybridRotor& rotor, double frequency_hz) {
  const double nu = 2.0 * pi * frequency_hz;
  if (!(nu > 0.0)) return 0;
  double x = nu * std::sqrt(rotor.inertia / rotor.stiffness);
  double sine = std::sin(x);
  if (sine == 0.0) {  // next to a pole of the cotangent: stay on its lower side
    x = std::nextafter(x, 0.0);
    sine = std::sin(x);
  }
  int count = static_cast<int>(x / pi);
  // Next to a multiple of pi the quotient may round across it while the sine, which knows pi to all its digits, does
  // not.
  const int nearest = static_cast<int>(std::lround(x / pi));
  if ((count % 2 == 0) != (sine > 0.0)) count = count == nearest ? nearest - 1 : nearest;
  const double k = rotor.stiffness * x, square = nu * nu;
  const auto pivot = [&count](double value, double size) {
    if (value == 0.0) value = -std::numeric_limits<double>::epsilon() * size;  // an eigenfrequency itself counts
    if (value < 0.0) ++count;
    return value;
  };
  const double cotangent = std::cos(x) / sine;
  double last = pivot(k * cotangent - square * rotor.left_inertia, k);
  // k cot x - (k / sin x)^2 / pivot; without left inertia this is -k tan x, which the general form loses digits on.
  double diagonal = rotor.left_inertia == 0.0 ? -k * std::tan(x) : k * cotangent - std::pow(k / sine, 2) / last;
  diagonal -= square * rotor.right_inertia;
  for (const Oscillator& o : rotor.chain) {
    last = pivot(diagonal + o.stiffness, k + o.stiffness);
    // k - k^2/(d + k) = d k/(d + k): no difference of large numbers.
    diagonal = diagonal * o.stiffness / last - square * o.inertia;
  }
  pivot(diagonal, k);
  return count - 1;
}

Result<std::vector<double>> ExactEigenfrequencies(const HybridRotor& rotor, double f_max_hz) {
  if (!IsValid(rotor) || !Positive(f_max_hz)) return OutOfRange();
  const int count = CountEigenfrequencies(rotor, f_max_hz);
  std::vector<double> found;
  double low = 0.0;
  for (int m = 1; m <= count; ++m) {
    double high = f_max_hz;
    while (true) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;  // neighbouring numbers
      (CountEigenfrequencies(rotor, middle) >= m ? high : low) = middle;
    }
    found.push_back(high);
    low = high > 0.0 ? std::nextafter(high, 0.0) : 0.0;
  }
  return found;
}

Network Sliced(const HybridRotor& rotor, int slices) {
  Network network;
  const int first = AddSoftRotor(network, {"rotor", rotor.inertia, rotor.stiffness, 0.0, slices});
  network.nodes[first].inertia += rotor.left_inertia;
  network.nodes.back().inertia += rotor.right_inertia;
  for (std::size_t i = 0; i < rotor.chain.size(); ++i) {
    const int node = network.size();
    network.nodes.push_back({"I[" + std::to_string(i) + "]", rotor.chain[i].inertia});
    network.edges.push_back({"k[" + std::to_string(i) + "]", node - 1, node, rotor.chain[i].stiffness, 0.0});
  }
  return network;
}

Result<SliceConvergence> MeasureSliceConvergence(const HybridRotor& rotor, int mode, const std::vector<int>& slices) {
  const int chain = static_cast<int>(rotor.chain.size());
  const bool rises = std::adjacent_find(slices.begin(), slices.end(), std::greater_equal<>()) == slices.end();
  if (slices.size() < 2 || !rises || slices[0] < 2 || mode < 1 || mode > slices[0] + chain - 1) {
    return Failure{"convergence needs rising numbers of slices that have the mode", "", {}, 2};
  }
  SliceConvergence result{0.0, slices, {}, {}};
  for (const int n : slices) {
    const Result<Eigen::VectorXd> frequencies = UndampedFrequencies(Sliced(rotor, n));
    if (!frequencies.ok()) return frequencies.failure();
    result.frequency_hz.push_back((*frequencies)[mode]);
  }
  // The exact mode lies near the finest one; look well beyond.
  for (double f_max = 2.0 * result.frequency_hz.back();; f_max *= 2.0) {
    const Result<std::vector<double>> exact = ExactEigenfrequencies(rotor, f_max);
    if (!exact.ok()) return exact.failure();
    if (std::ssize(*exact) < mode) continue;
    result.exact_hz = (*exact)[static_cast<std::size_t>(mode) - 1];
    break;
  }
  for (std::size_t i = 0; i + 1 < slices.size(); ++i) {
    const double coarse = std::abs(result.frequency_hz[i] - result.exact_hz);
    const double fine = std::abs(result.frequency_hz[i + 1] - result.exact_hz);
    result.order.push_back(std::log(coarse / fine) / std::log(static_cast<double>(slices[i + 1]) / slices[i]));
  }
  return result;
}

}  // namespace dynoproof::mechanics
