#include "plugins/plant/back_pressure/back_pressure.h"

#include "plugins/named_sections.h"

namespace dynoproof {

using mechanics::Charge;
using mechanics::GasState;

void BackPressure::Params::Check(Faults& faults) const {
  constexpr const char* kNames[] = {"3", "4"};
  CheckNames(faults, "flap", flap, kNames);
}

PluginInfo BackPressure::Info() {
  return {"plant",
          "back_pressure",
          "exhaust pipe of a single-cylinder test bed with two flaps side by side",
          "m_j' = q_j,in - q_j, U' = h_in - sum h q, q = (A_3(u_3) + A_4(u_4)) p/sqrt(R theta) Psi(p/p_amb)",
          "thesis Sec. 6.1.2, Fig. 6.2 (named there; not printed), flows (6.4), (6.5)",
          {}};
}

BackPressure::BackPressure(const Params& params)
    : p_(params),
      gases_(params.gases.Pair()),
      ambient_(StateAt(gases_, params.ambient_pressure_Pa, params.ambient_theta_K)),
      psi_(params.laminar_ratio),
      area_{Named(params.flap, "3").Area(), Named(params.flap, "4").Area()} {
  layout_.inputs = {{"u_3", "%", "position of the large flap", 50.0},
                    {"u_4", "%", "position of the small flap", 50.0},
                    {"air_flow", "kg/s", "fresh air that the engine pushes out", 1.0},
                    {"gas_flow", "kg/s", "exhaust gas that it pushes out", 1.0},
                    {"enthalpy", "W", "what both carry", 1e6}};
  layout_.outputs = {{"pressure", "Pa", "pressure of the pipe", 1e5}, {"theta", "K", "its temperature", 800.0},
                     {"air", "1", "share of fresh air in it", 1.0},   {"flow", "kg/s", "flow through both flaps", 1.0},
                     {"enthalpy_out", "W", "what it carries", 1e6},   {"mass", "kg", "mass in the pipe", 1.0},
                     {"energy", "J", "internal energy of it", 1e6}};
  layout_.states = {
      {"air", "kg", "fresh air", 1.0}, {"exhaust", "kg", "exhaust gas", 1.0}, {"energy", "J", "internal energy", 1e6}};
}

void BackPressure::Start(std::span<const double>, std::span<double> states, std::span<int>) const {
  Put(ChargeOf(StateAt(gases_, p_.start_pressure_Pa, p_.start_theta_K, 1.0), p_.volume_m3), 0, states);
}

GasState BackPressure::Gas(const View& view) const {
  return StateOf(gases_, mechanics::ChargeAt(view.states, 0), p_.volume_m3);
}

Charge BackPressure::Outflow(const View& view, const GasState& gas) const {
  const double area = area_[0].Area(view.inputs[kFlap3]) + area_[1].Area(view.inputs[kFlap4]);
  return Throttle(psi_, area, gas, ambient_);
}

void BackPressure::Output(const View& view, std::span<double> outputs) const {
  const GasState gas = Gas(view);
  const Charge out = Outflow(view, gas), own = mechanics::ChargeAt(view.states, 0);
  outputs[kPressure] = gas.pressure;
  outputs[kTheta] = gas.theta;
  outputs[kAir] = gas.portion[0];
  outputs[kFlow] = out.total();
  outputs[kEnthalpyOut] = out.energy;
  outputs[kMass] = own.total();
  outputs[kEnergy] = own.energy;
}

void BackPressure::Derivative(const View& view, std::span<double> rates) const {
  Charge own{{view.inputs[kAirFlow], view.inputs[kGasFlow]}, view.inputs[kEnthalpy]};
  own -= Outflow(view, Gas(view));
  Put(own, 0, rates);
}

}  // namespace dynoproof
