#include "plugins/plant/firing_order/firing_order.h"

#include <cmath>

namespace dynoproof {

using mechanics::CyclesBegun;
using mechanics::kCycle;
using mechanics::WithinCycle;
using std::numbers::pi;

PluginInfo FiringOrder::Info() {
  return {
      "plant",
      "firing_order",
      "torque of an engine over the crank angles of its cylinders, which do the work that was measured",
      "T = sum (p - p_crankcase) A s', p = p_1 (V_1/V)^n_c, then p_3 (V_c/V)^n_e, p_3 from W = closed integral of p dV",
      "thesis (6.2); the course of the torque is not printed",
      {}};
}

FiringOrder::FiringOrder(const Params& params)
    : p_(params),
      crank_(params.geometry.crank()),
      piston_area_(params.geometry.piston_area()),
      clearance_(params.geometry.clearance()),
      volume_1_(params.geometry.Volume(params.intake_closes_deg * kPerDegree)),
      volume_4_(params.geometry.Volume(params.exhaust_opens_deg * kPerDegree)),
      opens_(params.exhaust_opens_deg * kPerDegree),
      closes_(params.intake_closes_deg * kPerDegree) {
  for (int bank = 0; bank < p_.banks; ++bank) {
    for (int i = 0; i < p_.cylinders; ++i) {
      const double phi = WithinCycle(kCycle * i / p_.cylinders - bank * p_.bank_offset_deg * kPerDegree);
      offset_.push_back({phi, std::sin(phi), std::cos(phi)});
    }
  }
  layout_.inputs = {{"angle", "rad", "angle of the crankshaft", 1.0},
                    {"work", "J", "work of the closed strokes of a cylinder and cycle", 1e5},
                    {"pressure", "Pa", "pressure as the intake closed", 1e5},
                    {"open_torque", "N m", "torque of the gas while valves are open", 1e4}};
  layout_.outputs = {{"torque", "N m", "torque of the gas on the crankshaft", 1e5},
                     {"closed_torque", "N m", "torque of the closed strokes", 1e5}};
  layout_.modes = 2 * static_cast<int>(offset_.size());
}

void FiringOrder::Count(double angle, std::span<int> modes) const {
  for (std::size_t i = 0; i < offset_.size(); ++i) {
    modes[i] = CyclesBegun(angle + offset_[i].phi, opens_);
    modes[offset_.size() + i] = CyclesBegun(angle + offset_[i].phi, closes_);
  }
}

void FiringOrder::Start(std::span<const double> inputs, std::span<double>, std::span<int> modes) const {
  Count(inputs[kAngle], modes);
}

void FiringOrder::OnEvent(const View& view, int, std::span<double>, std::span<int> modes) const {
  Count(view.inputs[kAngle], modes);
}

void FiringOrder::Output(const View& view, std::span<double> outputs) const {
  const double n_c = p_.exponent_compression, n_e = p_.exponent_expansion, p_1 = view.inputs[kPressure];
  const double compressed = p_1 * volume_1_ / (n_c - 1.0) * (std::pow(volume_1_ / clearance_, n_c - 1.0) - 1.0);
  const double expanded = view.inputs[kWork] + compressed + p_.crankcase_pressure_Pa * (volume_4_ - volume_1_);
  const double p_3 = expanded * (n_e - 1.0) / (clearance_ * (1.0 - std::pow(clearance_ / volume_4_, n_e - 1.0)));
  const double angle = view.inputs[kAngle], first = WithinCycle(angle), sine = std::sin(angle),
               cosine = std::cos(angle);
  double torque = 0.0;
  for (std::size_t i = 0; i < offset_.size(); ++i) {
    if (view.modes[i] >= view.modes[offset_.size() + i]) continue;  // the exhaust opened since the intake last closed
    const Offset& by = offset_[i];
    const mechanics::SliderCrank::Travel travel =
        crank_.At(sine * by.cosine + cosine * by.sine, cosine * by.cosine - sine * by.sine);
    const double volume = clearance_ + piston_area_ * travel.s, phi = WithinCycle(first + by.phi);
    const double pressure =
        phi < 2.0 * pi ? p_1 * std::pow(volume_1_ / volume, n_c) : p_3 * std::pow(clearance_ / volume, n_e);
    torque += (pressure - p_.crankcase_pressure_Pa) * piston_area_ * travel.first;
  }
  outputs[kTorque] = view.inputs[kOpenTorque] + torque;
  outputs[kClosedTorque] = torque;
}

}  // namespace dynoproof
