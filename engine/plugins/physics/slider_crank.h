// Slider-crank mechanism: travel of the piston from top dead centre over the crank angle.
#pragma once

#include <cmath>

namespace dynoproof::mechanics {

struct SliderCrank {
  double radius = 0.0, rod = 0.0;  // crank radius r, length L > r of the connecting rod [m]

  struct Travel {
    double s, first, second;  // [m], [m/rad], [m/rad^2]
  };
  /// s = r (1 - cos phi) + L - sqrt(L^2 - r^2 sin^2 phi) with its first two derivatives; phi = 0: top dead centre.
  Travel At(double phi) const { return At(std::sin(phi), std::cos(phi)); }
  Travel At(double sine, double cosine) const {
    const double root = std::sqrt(rod * rod - radius * radius * sine * sine);
    const double lean = radius * radius * sine * cosine / root;  // root' = -lean
    return {radius * (1.0 - cosine) + rod - root, radius * sine + lean,
            radius * cosine + (radius * radius * (cosine * cosine - sine * sine) + lean * lean) / root};
  }
};

}  // namespace dynoproof::mechanics
