#include "plugins/plant/engine_bank/engine_bank.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plugins/named_sections.h"
#include "plugins/plant/separating_flows.h"

namespace dynoproof {
namespace {

using mechanics::Charge;
using mechanics::ChargeAt;
using mechanics::CyclesBegun;
using mechanics::GasState;
using mechanics::kCycle;
using mechanics::Put;
using std::numbers::pi;

constexpr const char* kVolumeNames[] = {"between", "receiver", "exhaust", "middle"};
constexpr const char* kChargerNames[] = {"low", "high"};
enum Volumes { kBetween, kReceiver, kExhaust, kMiddle, kVolumes };
enum Inputs { kAngle, kSpeed, kEvoPressure, kFuel, kBlowOff };
/// States behind those of volumes and cylinders, three each.
enum Rest {
  kRotors,
  kMassIn = 2,
  kMassOut,
  kEnergyIn,
  kEnergyOut,
  kMassStart,
  kEnergyStart,
  kAirAtIvc,
  kThetaAtIvc,
  kPressureAtIvc,
  kFuelAtIvc
};

}  // namespace

void EngineBank::Params::Check(Faults& faults) const {
  geometry.Check(faults);
  CheckNames(faults, "volume", volume, kVolumeNames);
  CheckNames(faults, "turbocharger", turbocharger, kChargerNames);
  CheckValves(faults, valves);
}

PlantTraits EngineBank::Traits() {
  PlantTraits traits;
  traits.separating_experiment = kSeparatingFlows;
  return traits;
}

PluginInfo EngineBank::Info() {
  return {"plant",
          "engine_bank",
          "gas side of one bank of an engine with two-stage turbocharging, pressures taken over at exhaust opening",
          "m_j' = sum of flows, U' = sum h q + Q_w - p V' in every volume; (J w^2/2)' = eta P_T - P_C for each rotor",
          "thesis Sec. 6.1.3, (6.1), Figs. 6.2, 6.3; wall heat: Hohenberg",
          {}};
}

EngineBank::EngineBank(const Params& params)
    : p_(params),
      gases_(params.gases.Pair()),
      ambient_(StateAt(gases_, params.ambient_pressure_Pa, params.ambient_theta_K)),
      psi_(params.laminar_ratio),
      crank_(params.geometry.crank()),
      piston_area_(params.geometry.piston_area()),
      clearance_(params.geometry.clearance()),
      intake_(Named(params.valves, "intake").Train()),
      exhaust_(Named(params.valves, "exhaust").Train()),
      closed_begin_(intake_.closes()),
      closed_duration_(mechanics::WithinCycle(exhaust_.opens - closed_begin_)),
      begin_{exhaust_.opens, closed_begin_} {
  for (int i = 0; i < p_.cylinders; ++i) offset_.push_back(CrankAt(kCycle * i / p_.cylinders));
  for (int i = 0; i < kVolumes; ++i) {
    start_[i] = Named(params.volume, kVolumeNames[i]);
    volume_m3_[i] = start_[i].volume_m3;
  }
  for (int i = 0; i < 2; ++i) {
    charger_[i] = Named(params.turbocharger, kChargerNames[i]);
    compressor_[i] = {charger_[i].radius_m, charger_[i].flow_max, charger_[i].head_max,
                      charger_[i].compressor_efficiency};
    turbine_[i] = {charger_[i].turbine_area_m2, charger_[i].turbine_efficiency};
  }
  layout_.inputs = {{"angle", "rad", "angle of the crankshaft", 1.0},
                    {"speed", "rad/s", "its speed", 100.0},
                    {"p_evo", "Pa", "measured cylinder pressure as the exhaust valves open", 1e6},
                    {"fuel", "kg", "fuel gas for a cylinder and cycle", 1e-3},
                    {"blow_off", "%", "position of the blow-off valve", 100.0}};
  layout_.outputs = {{"charge_pressure", "Pa", "pressure of the receiver", 1e5},
                     {"charge_theta", "K", "temperature of the receiver", 300.0},
                     {"exhaust_pressure", "Pa", "pressure before the turbines", 1e5},
                     {"exhaust_theta", "K", "temperature before the turbines", 800.0},
                     {"speed_low", "rad/s", "speed of the low-pressure turbocharger", 1000.0},
                     {"speed_high", "rad/s", "speed of the high-pressure turbocharger", 1000.0},
                     {"torque", "N m", "torque of the gas in all banks while valves are open", 1e4},
                     {"cylinder_pressure", "Pa", "pressure in the first cylinder", 1e6},
                     {"trapped_air", "kg", "air in the cylinder whose intake closed last", 0.1},
                     {"trapped_theta", "K", "its temperature then", 300.0},
                     {"trapped_pressure", "Pa", "its pressure then", 1e5},
                     {"trapped_fuel", "kg", "fuel that it was given", 1e-3},
                     {"air_flow", "kg/s", "air into the bank", 1.0},
                     {"blow_off_flow", "kg/s", "flow through the blow-off valve", 1.0},
                     {"mass_balance", "1", "mass that is unaccounted for, of all that came in", 1.0},
                     {"energy_balance", "1", "energy that is unaccounted for, of all that came in", 1.0},
                     {"exhaust_air", "1", "share of fresh air before the turbines", 1.0}};
  const auto add = [this](const std::string& name, double mass, double energy) {
    layout_.states.push_back({name + ".air", "kg", "fresh air", mass});
    layout_.states.push_back({name + ".exhaust", "kg", "exhaust gas", mass});
    layout_.states.push_back({name + ".energy", "J", "internal energy", energy});
  };
  for (const char* name : kVolumeNames) add(name, 1.0, 1e5);
  for (int i = 0; i < p_.cylinders; ++i) add(fmt::format("cylinder_{}", i + 1), 0.1, 1e4);
  for (const char* name : kChargerNames) {
    layout_.states.push_back({std::string(name) + ".energy", "J", "kinetic energy of the rotor", 1e5});
  }
  for (const Port& port :
       {Port{"mass_in", "kg", "that came in", 1.0}, Port{"mass_out", "kg", "that left", 1.0},
        Port{"energy_in", "J", "that came in with air and combustion", 1e6},
        Port{"energy_out", "J", "that left: gas, coolers, walls, pistons, bearings", 1e6},
        Port{"mass_start", "kg", "at t = 0", 1.0}, Port{"energy_start", "J", "at t = 0", 1e6},
        Port{"air_at_ivc", "kg", "trapped last", 0.1}, Port{"theta_at_ivc", "K", "trapped last", 300.0},
        Port{"p_at_ivc", "Pa", "trapped last", 1e5}, Port{"fuel_at_ivc", "kg", "trapped last", 1e-3}}) {
    layout_.states.push_back(port);
  }
  layout_.modes = 2 * p_.cylinders;  // cycles that each cylinder has begun with its exhaust, and with its closed intake
}

EngineBank::Crank EngineBank::CrankAt(double angle) {
  return {mechanics::WithinCycle(angle), std::sin(angle), std::cos(angle)};
}

bool EngineBank::Closed(const Crank& crank) const {
  const double since = crank.phi - closed_begin_;
  return (since < 0.0 ? since + kCycle : since) < closed_duration_;
}

double EngineBank::VolumeAt(double angle) const { return clearance_ + piston_area_ * crank_.At(angle).s; }

GasState EngineBank::VolumeState(std::span<const double> states, int volume) const {
  return StateOf(gases_, ChargeAt(states, volume), volume_m3_[volume]);
}

Charge EngineBank::TotalOf(std::span<const double> states) const {
  Charge total;
  for (int i = 0; i < kVolumes + p_.cylinders; ++i) total += ChargeAt(states, i);
  for (int i = 0; i < 2; ++i) total.energy += states[3 * (kVolumes + p_.cylinders) + kRotors + i];
  return total;
}

double EngineBank::BlowOffArea(double percent) const {
  return 0.01 * p_.blow_off_area_m2 * std::clamp(percent, 0.0, 100.0);
}

bool EngineBank::FeedsThrough(int in, int out) const {
  return (in == kAngle && (out == kTorque || out == kCylinderPressure)) || (in == kBlowOff && out == kBlowOffFlow);
}

void EngineBank::Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const {
  for (int i = 0; i < kVolumes; ++i) {
    const double exhaust = i == kExhaust || i == kMiddle ? 1.0 : 0.0;
    const GasState gas = StateAt(gases_, start_[i].start_pressure_Pa, start_[i].start_theta_K, exhaust);
    Put(ChargeOf(gas, volume_m3_[i]), i, states);
  }
  const GasState receiver = VolumeState(states, kReceiver), pipe = VolumeState(states, kExhaust);
  const double trapped_volume = VolumeAt(closed_begin_);
  const Charge fresh = ChargeOf(receiver, trapped_volume);
  const Crank first = CrankAt(inputs[kAngle]);
  for (int i = 0; i < p_.cylinders; ++i) {
    const Crank crank = CrankOf(first, i);
    const double volume = VolumeAt(crank.phi);
    for (int mode = 0; mode < 2; ++mode) {
      modes[mode * p_.cylinders + i] = CyclesBegun(inputs[kAngle] + offset_[i].phi, begin_[mode]);
    }
    Charge charge = fresh;
    if (Closed(crank)) {  // compressed without losses since its intake closed
      charge.energy *= std::pow(trapped_volume / volume, gases_.chi[0] - 1.0);
    } else {
      const bool discharging = exhaust_.Area(crank.phi) > intake_.Area(crank.phi);
      charge = ChargeOf(discharging ? pipe : receiver, volume);
    }
    Put(charge, kVolumes + i, states);
  }
  const std::span<double> rest = states.subspan(3 * (kVolumes + p_.cylinders));
  for (int i = 0; i < 2; ++i) {
    rest[kRotors + i] = 0.5 * charger_[i].inertia_kg_m2 * std::pow(charger_[i].start_speed_rad_per_s, 2);
  }
  const Charge total = TotalOf(states);
  rest[kMassStart] = total.total();
  rest[kEnergyStart] = total.energy;
  rest[kAirAtIvc] = fresh.mass[0];
  rest[kThetaAtIvc] = receiver.theta;
  rest[kPressureAtIvc] = receiver.pressure;
  rest[kFuelAtIvc] = inputs[kFuel];
}

void EngineBank::Derivative(const View& view, std::span<double> rates) const {
  const int n = p_.cylinders, first_rest = 3 * (kVolumes + n);
  const std::span<const double> rest = view.states.subspan(first_rest);
  const double speed = view.inputs[kSpeed];
  GasState gas[kVolumes];
  for (int i = 0; i < kVolumes; ++i) gas[i] = VolumeState(view.states, i);
  Charge rate[kVolumes];
  Charge in, out;  // across the border

  // Compressors and coolers, one after the other; turbines the other way round.
  const GasState* const suction[2] = {&ambient_, &gas[kBetween]};
  const int filled[2] = {kBetween, kReceiver};
  const GasState* const inlet[2] = {&gas[kMiddle], &gas[kExhaust]};
  const GasState* const outlet[2] = {&ambient_, &gas[kMiddle]};
  for (int i = 0; i < 2; ++i) {
    const double rotor = mechanics::RotorSpeed(rest[kRotors + i], charger_[i].inertia_kg_m2);
    const mechanics::Compressor::Point up = compressor_[i].At(rotor, *suction[i], gas[filled[i]].pressure);
    const mechanics::Cooled cooled = Cool(*suction[i], up, charger_[i].cooler_effectiveness, p_.coolant_theta_K);
    Charge drawn = Carry(*suction[i], up.flow);
    (i == 0 ? in : rate[kBetween]) += i == 0 ? drawn : Charge{{-drawn.mass[0], -drawn.mass[1]}, -drawn.energy};
    drawn.energy += up.power - cooled.heat;
    rate[filled[i]] += drawn;

    const mechanics::Turbine::Point down = turbine_[i].At(psi_, *inlet[i], *outlet[i]);
    Charge expanded = Carry(down.flow < 0.0 ? *outlet[i] : *inlet[i], down.flow);
    rate[i == 0 ? kMiddle : kExhaust] -= expanded;
    expanded.energy -= down.power;
    (i == 0 ? out : rate[kMiddle]) += expanded;

    rates[first_rest + kRotors + i] = charger_[i].mechanical_efficiency * down.power - up.power;
    out.energy += cooled.heat + (1.0 - charger_[i].mechanical_efficiency) * down.power;
  }
  const Charge blown = Throttle(psi_, BlowOffArea(view.inputs[kBlowOff]), gas[kReceiver], ambient_);
  rate[kReceiver] -= blown;
  out += blown;

  const double speed_factor = mechanics::WallHeatSpeedFactor(std::abs(speed) * p_.geometry.stroke_m / pi);
  const double ends = 0.5 * pi * p_.geometry.bore_m * p_.geometry.bore_m;  // head and piston
  const Crank first = CrankAt(view.inputs[kAngle]);
  for (int i = 0; i < n; ++i) {
    const Crank crank = CrankOf(first, i);
    const mechanics::SliderCrank::Travel travel = crank_.At(crank.sine, crank.cosine);
    const double volume = clearance_ + piston_area_ * travel.s;
    const GasState cylinder = StateOf(gases_, ChargeAt(view.states, kVolumes + i), volume);
    Charge own;
    if (const double area = intake_.Area(crank.phi); area != 0.0) {
      const Charge drawn = Throttle(psi_, area, gas[kReceiver], cylinder);
      rate[kReceiver] -= drawn;
      own += drawn;
    }
    if (const double area = exhaust_.Area(crank.phi); area != 0.0) {
      const Charge pushed = Throttle(psi_, area, cylinder, gas[kExhaust]);
      rate[kExhaust] += pushed;
      own -= pushed;
    }
    double heat = 0.0;
    if (p_.wall_factor > 0.0) {
      heat = p_.wall_factor * (ends + 4.0 * volume / p_.geometry.bore_m) * (p_.wall_theta_K - cylinder.theta) *
             mechanics::WallHeatCoefficient(volume, cylinder.pressure, cylinder.theta, speed_factor);
    }
    const double work = cylinder.pressure * piston_area_ * travel.first * speed;
    own.energy += heat - work;
    out.energy += work - heat;
    Put(own, kVolumes + i, rates);
  }
  for (int i = 0; i < kVolumes; ++i) Put(rate[i], i, rates);
  const std::span<double> ledger = rates.subspan(first_rest);
  ledger[kMassIn] = in.total();
  ledger[kMassOut] = out.total();
  ledger[kEnergyIn] = in.energy;
  ledger[kEnergyOut] = out.energy;
  std::fill(ledger.begin() + kMassStart, ledger.end(), 0.0);
}

void EngineBank::OnEvent(const View& view, int, std::span<double> states, std::span<int> modes) const {
  const std::span<double> rest = states.subspan(3 * (kVolumes + p_.cylinders));
  for (int i = 0; i < p_.cylinders; ++i) {
    const double angle = view.inputs[kAngle] + offset_[i].phi;
    const auto begun = [&](int mode) {
      const int count = CyclesBegun(angle, begin_[mode]), was = std::exchange(modes[mode * p_.cylinders + i], count);
      return count > was;
    };
    const bool opened = begun(0), closed = begun(1);
    if (!opened && !closed) continue;
    const double volume = VolumeAt(angle);
    const Charge before = ChargeAt(states, kVolumes + i);
    if (opened) {
      const double chi = gases_.chi[1];
      const double pressure = view.inputs[kEvoPressure] * std::pow(VolumeAt(exhaust_.opens) / volume, chi);
      const double fuel = rest[kFuelAtIvc];
      const Charge fired = {{0.0, before.total() + fuel}, pressure * volume / (chi - 1.0)};
      Put(fired, kVolumes + i, states);
      rest[kMassIn] += fuel;
      rest[kEnergyIn] += fired.energy - before.energy;
    }
    if (closed && (i == 0 || p_.trapped_of == "each")) {
      const GasState gas = StateOf(gases_, before, volume);
      const double back = volume / VolumeAt(closed_begin_);
      rest[kAirAtIvc] = before.mass[0];
      rest[kThetaAtIvc] = gas.theta * std::pow(back, gas.chi - 1.0);
      rest[kPressureAtIvc] = gas.pressure * std::pow(back, gas.chi);
      rest[kFuelAtIvc] = view.inputs[kFuel];
    }
  }
}

void EngineBank::Output(const View& view, std::span<double> outputs) const {
  const int n = p_.cylinders;
  const std::span<const double> rest = view.states.subspan(3 * (kVolumes + n));
  const GasState receiver = VolumeState(view.states, kReceiver), pipe = VolumeState(view.states, kExhaust);
  outputs[kChargePressure] = receiver.pressure;
  outputs[kChargeTheta] = receiver.theta;
  outputs[kExhaustPressure] = pipe.pressure;
  outputs[kExhaustTheta] = pipe.theta;
  outputs[kExhaustAir] = pipe.portion[0];
  for (int i = 0; i < 2; ++i) {
    outputs[kSpeedLow + i] = mechanics::RotorSpeed(rest[kRotors + i], charger_[i].inertia_kg_m2);
  }
  const Crank first = CrankAt(view.inputs[kAngle]);
  double torque = 0.0;
  for (int i = 0; i < n; ++i) {
    const Crank crank = CrankOf(first, i);
    const bool open = view.modes[i] >= view.modes[n + i];  // the exhaust opened since the intake last closed
    if (!open && i > 0) continue;
    const mechanics::SliderCrank::Travel travel = crank_.At(crank.sine, crank.cosine);
    const double pressure =
        StateOf(gases_, ChargeAt(view.states, kVolumes + i), clearance_ + piston_area_ * travel.s).pressure;
    if (open) torque += (pressure - ambient_.pressure) * piston_area_ * travel.first;
    if (i == 0) outputs[kCylinderPressure] = pressure;
  }
  outputs[kTorque] = p_.banks * torque;
  for (int i = 0; i < 4; ++i) outputs[kTrappedAir + i] = rest[kAirAtIvc + i];
  const GasState between = VolumeState(view.states, kBetween);
  outputs[kAirFlow] = compressor_[0].At(outputs[kSpeedLow], ambient_, between.pressure).flow;
  outputs[kBlowOffFlow] = ThrottleFlow(psi_, BlowOffArea(view.inputs[kBlowOff]), receiver, ambient_);
  const Charge total = TotalOf(view.states);
  const double mass_in = rest[kMassStart] + rest[kMassIn], energy_in = rest[kEnergyStart] + rest[kEnergyIn];
  outputs[kMassBalance] = (total.total() + rest[kMassOut] - mass_in) / mass_in;
  outputs[kEnergyBalance] = (total.energy + rest[kEnergyOut] - energy_in) / energy_in;
}

}  // namespace dynoproof
