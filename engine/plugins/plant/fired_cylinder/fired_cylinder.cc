#include "plugins/plant/fired_cylinder/fired_cylinder.h"

#include <algorithm>

namespace dynoproof {

PluginInfo FiredCylinder::Info() {
  return {"plant",
          "fired_cylinder",
          "synthetic single-cylinder engine: pressure at exhaust opening and work of the closed cycle",
          "isentropic to the heat release, all heat at once, isentropic to exhaust opening; W = U_1 + Q - U_4",
          "ideal cycle in place of the measurement of thesis Sec. 6.1.3, Fig. 6.3",
          {}};
}

void FiredCylinder::Params::Check(Faults& faults) const {
  geometry.Check(faults);
  if (!(exhaust_opens_deg > 360.0 + heat_at_deg && intake_closes_deg < 360.0)) {
    faults.At("exhaust_opens_deg", "the heat release at 360 + heat_at_deg lies outside of the closed part",
              "intake_closes_deg < 360 and exhaust_opens_deg > 360 + heat_at_deg");
  }
}

FiredCylinder::FiredCylinder(const Params& params)
    : p_(params),
      cycle_{params.chi_compression, params.chi_expansion, params.heating_value_J_per_kg, params.wall_share},
      volume_closed_(params.geometry.Volume(params.intake_closes_deg * kPerDegree)),
      volume_open_(params.geometry.Volume(params.exhaust_opens_deg * kPerDegree)) {
  layout_.inputs = {{"air", "kg", "trapped air", 0.1},
                    {"theta", "K", "its temperature as the intake closed", 300.0},
                    {"pressure", "Pa", "its pressure then", 1e5},
                    {"fuel", "kg", "fuel of the cycle", 1e-3},
                    {"retard", "deg", "retard of the ignition", 10.0}};
  layout_.outputs = {{"p_evo", "Pa", "pressure as the exhaust valves open", 1e6},
                     {"work", "J", "work of the closed part of the cycle, against the crankcase", 1e5},
                     {"peak_pressure", "Pa", "pressure behind the heat release", 1e7},
                     {"air_ratio", "1", "air ratio lambda, at most 10", 1.0},
                     {"knock", "1", "knock intensity, 1: the limit", 1.0},
                     {"nox", "1", "NOx over its limit", 1.0}};
}

void FiredCylinder::Output(const View& view, std::span<double> outputs) const {
  const double air = view.inputs[0], fuel = view.inputs[3], retard = view.inputs[4];
  const double at = std::min(p_.heat_at_deg + retard, p_.exhaust_opens_deg - 360.0);
  const mechanics::FiredCycle::Result cycle =
      cycle_.Run(view.inputs[2], view.inputs[1], volume_closed_, p_.geometry.Volume(at * kPerDegree), volume_open_,
                 fuel < 0.0 ? 0.0 : fuel);
  outputs[0] = cycle.pressure_end;
  outputs[1] = cycle.work - p_.crankcase_pressure_Pa * (volume_open_ - volume_closed_);
  outputs[2] = cycle.pressure_fired;
  outputs[3] = p_.indices.AirRatio(air, fuel);
  outputs[4] = p_.indices.Knock(cycle.theta_unburnt);
  outputs[5] = p_.indices.Nox(outputs[3], retard);
}

}  // namespace dynoproof
