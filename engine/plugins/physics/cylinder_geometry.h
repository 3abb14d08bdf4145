// Geometry, valves and gases of a cylinder as scenarios state them: shared by the bank, the cylinder of the test bed and
// its exhaust pipe.
#pragma once

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "model/params.h"
#include "plugins/physics/gas_exchange.h"
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

/// Fresh air (1) and exhaust gas (2).
struct GasParams {
  double R_air_J_per_kg_K = 287.05, R_exhaust_J_per_kg_K = 290.0, chi_air = 1.39, chi_exhaust = 1.33;
  void Visit(auto& v) {
    v.Optional("R_air_J_per_kg_K", R_air_J_per_kg_K, Positive(), "R_1, fresh air");
    v.Optional("R_exhaust_J_per_kg_K", R_exhaust_J_per_kg_K, Positive(), "R_2, exhaust gas");
    v.Optional("chi_air", chi_air, Between(1.01, 1.67), "chi_1, fresh air");
    v.Optional("chi_exhaust", chi_exhaust, Between(1.01, 1.67), "chi_2, exhaust gas");
  }
  mechanics::GasPair Pair() const {
    return {.R = {R_air_J_per_kg_K, R_exhaust_J_per_kg_K}, .chi = {chi_air, chi_exhaust}};
  }
};

/// The intake or exhaust valves of a cylinder.
struct ValveParams {
  int count = 2;
  double diameter_m = 0.0, lift_m = 0.0, discharge = 0.65, opens_deg = 0.0, closes_deg = 0.0;
  void Visit(auto& v) {
    v.Optional("count", count, Between(1, 4), "valves of a cylinder");
    v.Required("diameter_m", diameter_m, Positive(), "diameter of the discs");
    v.Required("lift_m", lift_m, Positive(), "largest lift");
    v.Optional("discharge", discharge, Between(0.0, 1.0), "discharge coefficient of the curtain area");
    v.Required("opens_deg", opens_deg, Between(-360.0, 720.0, "deg"), "crank angle; 0: top dead centre, gas exchange");
    v.Required("closes_deg", closes_deg, Between(-360.0, 1080.0, "deg"), "crank angle");
  }
  void Check(Faults& faults) const;
  mechanics::ValveTrain Train() const;
};

/// [plant.valves.intake] and [plant.valves.exhaust], and nothing else, with a part of the cycle between them in which
/// all are closed: what is trapped there is fired. True when it is so; else each fault is reported.
bool CheckValves(Faults& faults, const std::vector<std::pair<std::string, ValveParams>>& valves);

}  // namespace dynoproof
