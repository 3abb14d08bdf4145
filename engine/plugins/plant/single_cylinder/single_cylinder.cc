#include "plugins/plant/single_cylinder/single_cylinder.h"

#include <cmath>
#include <numbers>

namespace dynoproof {

using std::numbers::pi;

PluginInfo SingleCylinder::Info() {
  return {"plant",
          "single_cylinder",
          "crank-angle-resolved torque of a four-stroke single-cylinder engine, motored or fired",
          "T = (p - p_crankcase) A s' - m s' s'' w^2 - (T_f + b |w|) tanh(w / w_0), p from a polytropic cycle",
          "slider-crank mechanism and ideal cycle; thesis Sec. 4.2 (the engine's torque T_g, not printed)",
          {}};
}

void SingleCylinder::Params::Check(Faults& faults) const {
  if (rod_m <= 0.5 * stroke_m) {
    faults.At("rod_m", fmt::format("a rod of {} m cannot turn a crank of {} m", rod_m, 0.5 * stroke_m),
              "longer than half the stroke");
  }
}

SingleCylinder::SingleCylinder(const Params& params)
    : p_(params), crank_{0.5 * params.stroke_m, params.rod_m}, area_(0.25 * pi * params.bore_m * params.bore_m) {
  clearance_ = area_ * params.stroke_m / (params.compression_ratio - 1.0);
  const double usual = p_.intake_pressure_Pa * area_ * crank_.radius;
  layout_.inputs = {{"angle", "rad", "angle of the crankshaft", 1.0}, {"speed", "rad/s", "its speed", 100.0}};
  layout_.outputs = {{"torque", "N m", "torque on the crankshaft; accelerates when positive", usual},
                     {"pressure", "Pa", "pressure in the cylinder", p_.intake_pressure_Pa}};
}

double SingleCylinder::Pressure(double phi, double s) const {
  const double cycle = phi - 4.0 * pi * std::floor(phi / (4.0 * pi));
  const double volume = clearance_ + area_ * s, bottom = clearance_ + area_ * p_.stroke_m;
  if (cycle < pi) return p_.intake_pressure_Pa;
  if (cycle < 2.0 * pi) return p_.intake_pressure_Pa * std::pow(bottom / volume, p_.exponent_compression);
  if (cycle < 3.0 * pi) {
    return p_.firing_pressure_ratio * p_.intake_pressure_Pa * std::pow(p_.compression_ratio, p_.exponent_compression) *
           std::pow(clearance_ / volume, p_.exponent_expansion);
  }
  return p_.exhaust_pressure_Pa;
}

void SingleCylinder::Output(const View& view, std::span<double> outputs) const {
  const double phi = view.inputs[0] + p_.start_angle_rad, w = view.inputs[1];
  const mechanics::SliderCrank::Travel travel = crank_.At(phi);
  const double pressure = Pressure(phi, travel.s);
  outputs[0] = (pressure - p_.crankcase_pressure_Pa) * area_ * travel.first -
               p_.oscillating_mass_kg * travel.first * travel.second * w * w -
               (p_.friction_Nm + p_.friction_Nms_per_rad * std::abs(w)) * std::tanh(w / p_.friction_speed_rad_per_s);
  outputs[1] = pressure;
}

}  // namespace dynoproof
