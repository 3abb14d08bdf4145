#include "plugins/plant/breathing_cylinder/breathing_cylinder.h"

#include <algorithm>
#include <cmath>

#include "plugins/named_sections.h"

namespace dynoproof {
namespace {

using mechanics::Charge;
using mechanics::ChargeAt;
using mechanics::CyclesBegun;
using mechanics::GasState;
using mechanics::kCycle;
using mechanics::WithinCycle;
using std::numbers::pi;

/// States behind the charge.
enum Rest {
  kFuelMass = 3,
  kPistonWork,
  kAirAtIvc,
  kThetaAtIvc,
  kPressureAtIvc,
  kFuelAtIvc,
  kWorkAtIvc,
  kRetardAtIvc,
  kPeak,
  kMeasuredPressure,
  kMeasuredWork,
  kMeasuredRatio,
  kMeasuredKnock,
  kMeasuredNox
};

}  // namespace

void BreathingCylinder::Params::Check(Faults& faults) const {
  geometry.Check(faults);
  if (!CheckValves(faults, valves)) return;
  if (heat_at_deg - 0.5 * burn_deg < Named(valves, "intake").closes_deg - 360.0 ||
      heat_at_deg + 0.5 * burn_deg > Named(valves, "exhaust").opens_deg - 360.0) {
    faults.At("burn_deg", "it burns while valves are open", "a shorter burn_deg, around 360 + heat_at_deg");
  }
  if (injection_opens_deg + 2.0 * injection_edge_deg > Named(valves, "intake").closes_deg) {
    faults.At("injection_opens_deg", "the gas valve cannot open and close before the intake does",
              "injection_opens_deg + 2 injection_edge_deg below closes_deg of the intake");
  }
}

PluginInfo BreathingCylinder::Info() {
  return {"plant",
          "breathing_cylinder",
          "single-cylinder engine of the test bed over its crank angle: breathing, gas injection, combustion",
          "m_j' = flows, U' = sum h q + Q_w + H_u m_fuel x'(phi) w - p V', x = y - sin(2 pi y)/(2 pi)",
          "thesis Secs. 6.1.2, 6.1.3, (6.1), Fig. 6.2; wall heat: Hohenberg; the combustion is synthetic",
          {}};
}

BreathingCylinder::BreathingCylinder(const Params& params)
    : p_(params),
      gases_(params.gases.Pair()),
      psi_(params.laminar_ratio),
      crank_(params.geometry.crank()),
      piston_area_(params.geometry.piston_area()),
      clearance_(params.geometry.clearance()),
      intake_(Named(params.valves, "intake").Train()),
      exhaust_(Named(params.valves, "exhaust").Train()),
      injection_{params.injection_area_m2, params.injection_opens_deg * kPerDegree,
                 params.injection_edge_deg * kPerDegree,
                 WithinCycle(intake_.closes() - params.injection_opens_deg * kPerDegree)},
      fuel_gas_{params.fuel_R_J_per_kg_K, params.fuel_theta_K},
      closes_(intake_.closes()),
      opens_(exhaust_.opens),
      volume_closed_(VolumeAt(closes_)),
      volume_open_(VolumeAt(opens_)) {
  layout_.inputs = {{"angle", "rad", "angle of the crankshaft", 1.0},
                    {"speed", "rad/s", "its speed", 100.0},
                    {"charge_pressure", "Pa", "pressure of the charge pipe", 1e5},
                    {"charge_theta", "K", "its temperature", 300.0},
                    {"exhaust_pressure", "Pa", "pressure of the exhaust pipe", 1e5},
                    {"exhaust_theta", "K", "its temperature", 800.0},
                    {"exhaust_air", "1", "share of fresh air in it", 1.0},
                    {"gas_pressure", "Pa", "pressure before the gas valve", 1e5},
                    {"charge_reference", "Pa", "charge pressure for which the gas valve is timed", 1e5},
                    {"gas_reference", "Pa", "gas pressure for which it is timed", 1e5},
                    {"fuel", "kg", "fuel gas that is wanted of a cycle", 1e-3},
                    {"retard", "deg", "retard of the ignition", 10.0}};
  layout_.outputs = {{"pressure", "Pa", "pressure in the cylinder", 1e6},
                     {"torque", "N m", "torque of the gas on the crankshaft", 1e4},
                     {"air_flow", "kg/s", "flow out of the charge pipe", 1.0},
                     {"fuel_flow", "kg/s", "flow through the gas valve", 0.1},
                     {"exhaust_air_flow", "kg/s", "fresh air into the exhaust pipe", 1.0},
                     {"exhaust_gas_flow", "kg/s", "exhaust gas into it", 1.0},
                     {"exhaust_enthalpy", "W", "what both carry", 1e6},
                     {"mass", "kg", "of all that is in the cylinder", 0.1},
                     {"energy", "J", "internal energy of it", 1e5},
                     {"energy_in", "W", "charge, combustion and walls less the piston's power", 1e6},
                     {"trapped_air", "kg", "air as the intake closed last", 0.1},
                     {"trapped_theta", "K", "temperature then", 300.0},
                     {"trapped_pressure", "Pa", "pressure then", 1e5},
                     {"trapped_fuel", "kg", "fuel then", 1e-3},
                     {"p_evo", "Pa", "pressure as the exhaust opened last", 1e6},
                     {"work", "J", "work of the closed part before that, against the crankcase", 1e5},
                     {"air_ratio", "1", "its air ratio lambda, at most 10", 1.0},
                     {"knock", "1", "its knock intensity, 1: the limit", 1.0},
                     {"nox", "1", "its NOx over the limit", 1.0},
                     {"prechamber_flow", "kg/s", "gas that scavenges the pre-chamber", 0.01}};
  layout_.states = {{"air", "kg", "fresh air", 0.1},
                    {"exhaust", "kg", "exhaust gas", 0.1},
                    {"energy", "J", "internal energy", 1e4},
                    {"fuel", "kg", "fuel", 1e-3},
                    {"piston_work", "J", "work on the piston against the crankcase since the start", 1e5},
                    {"air_at_ivc", "kg", "trapped last", 0.1},
                    {"theta_at_ivc", "K", "trapped last", 300.0},
                    {"p_at_ivc", "Pa", "trapped last", 1e5},
                    {"fuel_at_ivc", "kg", "trapped last", 1e-3},
                    {"work_at_ivc", "J", "work as the intake closed last", 1e5},
                    {"retard_at_ivc", "deg", "retard of this combustion", 10.0},
                    {"peak", "Pa", "largest pressure since the intake closed", 1e7},
                    {"p_evo", "Pa", "measured last", 1e6},
                    {"work", "J", "measured last", 1e5},
                    {"air_ratio", "1", "measured last", 1.0},
                    {"knock", "1", "measured last", 1.0},
                    {"nox", "1", "measured last", 1.0}};
  layout_.modes = 2;  // cycles begun: 0 with opening exhaust, 1 with closed intake
}

void BreathingCylinder::Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const {
  modes[0] = CyclesBegun(inputs[kAngle], opens_);
  modes[1] = CyclesBegun(inputs[kAngle], closes_);
  const double phi = WithinCycle(inputs[kAngle]), volume = VolumeAt(phi);
  const GasState charge = StateAt(gases_, inputs[kChargePressure], inputs[kChargeTheta]);
  const GasState pipe = StateAt(gases_, inputs[kExhaustPressure], inputs[kExhaustTheta], 1.0 - inputs[kExhaustAir]);
  const Charge fresh = ChargeOf(charge, volume_closed_);
  const bool closed = modes[1] > modes[0];
  Charge own = fresh;
  if (closed) {  // compressed without losses since its intake closed
    own.energy *= std::pow(volume_closed_ / volume, gases_.chi[0] - 1.0);
  } else {
    own = ChargeOf(exhaust_.Area(phi) > intake_.Area(phi) ? pipe : charge, volume);
  }
  Put(own, 0, states);
  states[kFuelMass] = closed ? inputs[kFuel] : 0.0;
  states[kAirAtIvc] = fresh.mass[0];
  states[kThetaAtIvc] = charge.theta;
  states[kPressureAtIvc] = charge.pressure;
  states[kFuelAtIvc] = inputs[kFuel];
  states[kRetardAtIvc] = inputs[kRetard];
  states[kMeasuredPressure] = p_.start_p_evo_Pa;
  states[kMeasuredWork] = p_.start_work_J;
  states[kMeasuredRatio] = p_.indices.nox_air_ratio;
  states[kMeasuredNox] = 1.0;
}

double BreathingCylinder::FuelFlow(const View& view, double phi) const {
  const std::span<const double> u = view.inputs;
  const double since = WithinCycle(phi - injection_.opens);
  if (since > injection_.longest) return 0.0;
  const double timed = mechanics::OrificeFlow(fuel_gas_, injection_.area, u[kGasReference], u[kChargeReference]);
  const double share =
      injection_.Share(since, injection_.Width((1.0 - p_.prechamber_share) * u[kFuel], u[kSpeed], timed));
  return mechanics::OrificeFlow(fuel_gas_, injection_.area * share, u[kGasPressure], u[kChargePressure]);
}

/// Smoothly over the same part of the cycle as the gas valve has: the dose alone is given.
double BreathingCylinder::PrechamberFlow(const View& view) const {
  if (p_.prechamber_share == 0.0) return 0.0;
  const double speed = view.inputs[kSpeed], centre = injection_.opens + 0.5 * injection_.longest;
  const double rate = mechanics::BurnRate(WithinCycle(view.inputs[kAngle]), centre, injection_.longest);
  return speed > 0.0 ? p_.prechamber_share * view.inputs[kFuel] * speed * rate : 0.0 * speed;
}

BreathingCylinder::Exchange BreathingCylinder::At(const View& view) const {
  const std::span<const double> u = view.inputs, s = view.states;
  const double phi = WithinCycle(u[kAngle]), speed = u[kSpeed];
  const mechanics::SliderCrank::Travel travel = crank_.At(phi);
  const double volume = clearance_ + piston_area_ * travel.s;
  Exchange at{
      StateOf(gases_, ChargeAt(s, 0), volume), {}, {}, FuelFlow(view, phi), 0.0, 0.0, 0.0, piston_area_ * travel.first};
  if (const double area = intake_.Area(phi); area != 0.0) {
    at.intake = Throttle(psi_, area, StateAt(gases_, u[kChargePressure], u[kChargeTheta]), at.gas);
  }
  if (const double area = exhaust_.Area(phi); area != 0.0) {
    at.exhaust =
        Throttle(psi_, area, at.gas, StateAt(gases_, u[kExhaustPressure], u[kExhaustTheta], 1.0 - u[kExhaustAir]));
  }
  const double centre = (360.0 + p_.heat_at_deg + s[kRetardAtIvc]) * kPerDegree;
  at.burn = speed > 0.0 ? speed * mechanics::BurnRate(phi, centre, p_.burn_deg * kPerDegree) : 0.0 * speed;
  at.heat = p_.heating_value_J_per_kg * p_.heat_share * s[kFuelAtIvc] * at.burn;
  if (p_.wall_factor > 0.0) {
    const double ends = 0.5 * pi * p_.geometry.bore_m * p_.geometry.bore_m;  // head and piston
    const double factor = mechanics::WallHeatSpeedFactor(std::abs(speed) * p_.geometry.stroke_m / pi);
    at.heat += p_.wall_factor * (ends + 4.0 * volume / p_.geometry.bore_m) * (p_.wall_theta_K - at.gas.theta) *
               mechanics::WallHeatCoefficient(volume, at.gas.pressure, at.gas.theta, factor);
  }
  at.power = at.gas.pressure * at.lever * speed;
  return at;
}

void BreathingCylinder::Derivative(const View& view, std::span<double> rates) const {
  const Exchange at = At(view);
  const double air = view.states[kAirAtIvc], fuel = view.states[kFuelAtIvc];
  Charge own = at.intake;
  own -= at.exhaust;
  own += Charge{{-air * at.burn, (air + fuel) * at.burn}, at.heat - at.power};
  std::fill(rates.begin(), rates.end(), 0.0);
  Put(own, 0, rates);
  rates[kFuelMass] = at.fuel + PrechamberFlow(view) - fuel * at.burn;
  rates[kPistonWork] = at.power - p_.crankcase_pressure_Pa * at.lever * view.inputs[kSpeed];
}

void BreathingCylinder::Output(const View& view, std::span<double> outputs) const {
  const Exchange at = At(view);
  const Charge own = ChargeAt(view.states, 0);
  outputs[kPressure] = at.gas.pressure;
  outputs[kTorque] = (at.gas.pressure - p_.crankcase_pressure_Pa) * at.lever;
  outputs[kAirFlow] = at.intake.total();
  outputs[kFuelFlow] = at.fuel;
  outputs[kExhaustAirFlow] = at.exhaust.mass[0];
  outputs[kExhaustGasFlow] = at.exhaust.mass[1];
  outputs[kExhaustEnthalpy] = at.exhaust.energy;
  outputs[kMass] = own.total() + view.states[kFuelMass];
  outputs[kEnergy] = own.energy;
  outputs[kEnergyIn] = at.intake.energy + at.heat - at.power;
  for (int i = 0; i < 4; ++i) outputs[kTrappedAir + i] = view.states[kAirAtIvc + i];
  for (int i = 0; i < 5; ++i) outputs[kEvoPressure + i] = view.states[kMeasuredPressure + i];
  outputs[kPrechamberFlow] = PrechamberFlow(view);
}

void BreathingCylinder::Trap(const View& view, std::span<double> states) const {
  const double volume = VolumeAt(view.inputs[kAngle]), back = volume / volume_closed_;
  const GasState gas = StateOf(gases_, ChargeAt(states, 0), volume);
  states[kAirAtIvc] = states[0];
  states[kThetaAtIvc] = gas.theta * std::pow(back, gas.chi - 1.0);
  states[kPressureAtIvc] = gas.pressure * std::pow(back, gas.chi);
  states[kFuelAtIvc] = states[kFuelMass];
  states[kRetardAtIvc] =
      std::clamp(view.inputs[kRetard], 0.0, opens_ / kPerDegree - 360.0 - p_.heat_at_deg - 0.5 * p_.burn_deg);
  const double mean = 0.5 * (gas.pressure + states[kPressureAtIvc]) - p_.crankcase_pressure_Pa;
  states[kWorkAtIvc] = states[kPistonWork] - mean * (volume - volume_closed_);
  states[kPeak] = gas.pressure;
}

void BreathingCylinder::Measure(const View& view, std::span<double> states) const {
  const double volume = VolumeAt(view.inputs[kAngle]);
  // The last of the charge, which round-off of the burnt share has left, becomes exhaust gas with the rest.
  Charge own = ChargeAt(states, 0);
  own = {{0.0, own.total() + states[kFuelMass]}, own.energy};
  Put(own, 0, states);
  states[kFuelMass] = 0.0;
  const GasState gas = StateOf(gases_, own, volume);
  states[kMeasuredPressure] = gas.pressure * std::pow(volume / volume_open_, gas.chi);
  const double mean = 0.5 * (gas.pressure + states[kMeasuredPressure]) - p_.crankcase_pressure_Pa;
  states[kMeasuredWork] = states[kPistonWork] - mean * (volume - volume_open_) - states[kWorkAtIvc];
  const double chi = gases_.chi[0], raised = states[kPeak] / states[kPressureAtIvc];
  states[kMeasuredRatio] = p_.indices.AirRatio(states[kAirAtIvc], states[kFuelAtIvc]);
  states[kMeasuredKnock] = p_.indices.Knock(states[kThetaAtIvc] * std::pow(raised, (chi - 1.0) / chi));
  states[kMeasuredNox] = p_.indices.Nox(states[kMeasuredRatio], states[kRetardAtIvc]);
}

void BreathingCylinder::OnEvent(const View& view, int, std::span<double> states, std::span<int> modes) const {
  const double angle = view.inputs[kAngle];
  const int opened = CyclesBegun(angle, opens_), closed = CyclesBegun(angle, closes_);
  if (closed > modes[1]) Trap(view, states);
  if (opened > modes[0]) Measure(view, states);
  modes[0] = opened;
  modes[1] = closed;
  states[kPeak] = std::max(states[kPeak], StateOf(gases_, ChargeAt(states, 0), VolumeAt(angle)).pressure);
}

}  // namespace dynoproof
