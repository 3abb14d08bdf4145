// Geometry of one cylinder as scenarios state it: shared by the bank and by the cylinder whose pressure is measured.
#pragma once

#include <numbers>

#include "model/params.h"
#include "plugins/physics/slider_crank.h"

namespace dynoproof {

inline constexpr double kPerDegree = std::numbers::pi / 180.0;

struct CylinderGeometry {
  double bore_m = 0.0, stroke_m = 0.0, rod_m = 0.0, compression_ratio = 0.0;
  void Visit(auto& v) {
    v.Required("bore_m", bore_m, Positive(), "bore D");
    v.Required("stroke_m", stroke_m, Positive(), "stroke 2 r");
    v.Required("rod_m", rod_m, Positive(), "length of the connecting rod");
    v.Required("compression_ratio", compression_ratio, Between(1.1, 50.0), "compression ratio eps");
  }
  void Check(Faults& faults) const {
    if (rod_m <= 0.5 * stroke_m) {
      faults.At("rod_m", fmt::format("a rod of {} m cannot turn a crank of {} m", rod_m, 0.5 * stroke_m),
                "longer than half the stroke");
    }
  }
  double piston_area() const { return 0.25 * std::numbers::pi * bore_m * bore_m; }
  double clearance() const { return piston_area() * stroke_m / (compression_ratio - 1.0); }
  mechanics::SliderCrank crank() const { return {0.5 * stroke_m, rod_m}; }
  /// Volume [m^3] at a crank angle [rad] from top dead centre.
  double Volume(double phi) const { return clearance() + piston_area() * crank().At(phi).s; }
};

}  // namespace dynoproof
