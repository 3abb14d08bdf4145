// What goes into a cylinder of a gas engine over its crank angle: the gas of one port injection, and the heat of one
// combustion.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dynoproof::mechanics {

/// A gas valve that is told a width: it opens over `edge`, stays open and closes as fast, so that its area integrates to
/// area * width over the angle. All angles in rad.
struct InjectionValve {
  double area = 0.0, opens = 0.0, edge = 0.0, longest = 0.0;  // [m^2]; of the cycle; `longest` from opening to closed

  /// The width that lets `fuel` [kg] pass at a speed [rad/s], where a fully open valve passes `flow` [kg/s].
  double Width(double fuel, double speed, double flow) const {
    const double wanted = fuel * speed, most = longest - edge;
    if (!(wanted > 0.0)) return 0.0 * wanted;  // a dose that is no number stays none
    return wanted >= most * flow ? most : wanted / flow;
  }
  /// Its open share, `since` behind the begin of opening.
  double Share(double since, double width) const {
    const double ramp = std::min(width, edge);
    if (!(ramp > 0.0)) return 0.0 * ramp;
    return std::clamp(std::min(since, width + ramp - since) / ramp, 0.0, 1.0);
  }
};

/// Burnt share x = y - sin(2 pi y)/(2 pi), y from 0 to 1 over `duration` [rad] around `centre`, at which half is burnt.
/// Smooth, so that steps of a degree carry it well, and all is burnt at its end.
inline double BurnRate(double phi, double centre, double duration) {
  const double y = (phi - centre) / duration + 0.5;
  return y > 0.0 && y < 1.0 ? (1.0 - std::cos(2.0 * std::numbers::pi * y)) / duration : 0.0;
}

}  // namespace dynoproof::mechanics
