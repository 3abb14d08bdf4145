// Flow of gas through an orifice and the effective area of a flap, thesis (6.4), (6.5), (6.15).
//
// q = A p_up / sqrt(R theta) Psi(p_up / p_down), from the higher pressure to the lower: reversed flow is mirrored. The
// approximation (6.5) is choked from a ratio of 2 on; the exact isentropic function from ((kappa + 1)/2)^(kappa/(kappa
// - 1)) on. Both have a continuous slope there and grow like the root of the pressure difference at a ratio of 1.
#pragma once

#include <vector>

namespace dynoproof::mechanics {

/// (6.5); `ratio` = p_up / p_down >= 1. At 1: 0.
double FlowFunction(double ratio);
/// The exact one of an ideal gas with the heat capacity ratio kappa > 1.
double IsentropicFlowFunction(double ratio, double kappa);
/// Largest relative deviation of (6.5) from the isentropic function over all ratios above 1: where both are choked.
double FlowFunctionDeviation(double kappa);

/// (6.5) with a finite slope at a ratio of 1, so that wide open valves between equal pressures are not infinitely
/// stiff: below 1 + delta an odd cubic of ratio - 1 that meets (6.5) there with its slope.
class LaminarFlowFunction {
 public:
  explicit LaminarFlowFunction(double delta = 0.01);  // 0 < delta < 1
  double operator()(double ratio) const {
    const double x = ratio - 1.0;
    return x < delta_ ? x * (linear_ + cubic_ * x * x) : FlowFunction(ratio);
  }

 private:
  double delta_, linear_, cubic_;
};

struct Gas {
  double R = 287.05;        // specific gas constant [J/(kg K)], > 0
  double theta = 320.0;     // temperature [K], > 0
  bool isentropic = false;  // the exact function instead of (6.5)
  double kappa = 1.4;       // heat capacity ratio, > 1; read when isentropic
};

/// Mass flow [kg/s] through an area [m^2] >= 0 from pressure `from` to `to` [Pa]; negative when to > from. A pressure
/// at or below 0 drives nothing and is a vacuum for the other side.
double OrificeFlow(const Gas& gas, double area, double from, double to);

/// Effective area of a flap over its position, strictly rising, with its inverse. Positions [%] outside of the range
/// count as its nearest end, and so do areas.
class FlapArea {
 public:
  /// A(u) = offset + span (1 - cos(pi u / 200)), u in 0 ... 100 %; offset >= 0, span > 0 [m^2].
  static FlapArea Cosine(double offset, double span);
  /// Straight lines between points: positions and areas strictly rising, areas >= 0, at least two of each.
  static FlapArea Table(std::vector<double> positions, std::vector<double> areas);
  /// The same, all areas times a factor > 0.
  FlapArea Times(double factor) const;

  double Area(double position) const;
  double Position(double area) const;

 private:
  double offset_ = 0.0, span_ = 0.0;
  std::vector<double> positions_, areas_;  // empty: the cosine
};

}  // namespace dynoproof::mechanics
