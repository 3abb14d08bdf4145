#include "plugins/plant/power_train/power_train.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dynoproof {
namespace {

enum State { kAngleState, kSpeedState, kWorkIn, kWorkOut, kIndicatedState, kConsumerState };

}  // namespace

PluginInfo ResistorLoad::Info() {
  return {"plant",
          "resistor_load",
          "resistors at the terminals of a generator",
          "P = U^2 (G + r (G - y)), y' = (G - y)/tau, T = P/(eta w)",
          "thesis Sec. 6.4.3: a resistor is connected in parallel; its temperature shows",
          {}};
}

ResistorLoad::ResistorLoad(const Params& params) : p_(params) {
  layout_.inputs = {{"voltage", "V", "voltage U", 1e4},
                    {"conductance", "1/Ohm", "conductance G of all resistors", 0.01},
                    {"speed", "rad/s", "speed w of the shaft", 100.0}};
  layout_.outputs = {{"power", "W", "electrical power", 1e6}, {"torque", "N m", "torque on the shaft", 1e4}};
  if (p_.cold_share > 0.0) layout_.states = {{"warm", "1/Ohm", "conductance of the warm resistors", 0.01}};
}

void ResistorLoad::Start(std::span<const double> inputs, std::span<double> states, std::span<int>) const {
  if (p_.cold_share > 0.0) states[0] = inputs[1];
}

void ResistorLoad::Derivative(const View& view, std::span<double> rates) const {
  if (p_.cold_share > 0.0) rates[0] = (view.inputs[1] - view.states[0]) / p_.warming_s;
}

void ResistorLoad::Output(const View& view, std::span<double> outputs) const {
  const double cold = p_.cold_share > 0.0 ? p_.cold_share * (view.inputs[1] - view.states[0]) : 0.0;
  const double power = view.inputs[0] * view.inputs[0] * (view.inputs[1] + cold), speed = view.inputs[2];
  const double least = p_.least_speed_rad_per_s, share = std::abs(speed) < least ? speed / least : 1.0;
  outputs[0] = power * share * share;
  outputs[1] =
      std::abs(speed) < least ? power * speed / (least * least * p_.efficiency) : power / (speed * p_.efficiency);
}

PluginInfo PowerTrain::Info() {
  return {"plant",
          "power_train",
          "crankshaft and generator of an engine, island or grid operation",
          "I w' = T_indicated - T_friction - T_consumer; in the grid w' = 0",
          "thesis (6.2) and its footnote",
          {}};
}

PowerTrain::PowerTrain(const Params& params) : p_(params), grid_(params.operation == "grid") {
  layout_.inputs = {{"torque", "N m", "torque of the gas while valves are open", 1e4},
                    {"work", "J", "work of the closed part of a cycle of one cylinder", 1e5},
                    {"load", "N m", "torque of the consumer; not read in the grid", 1e4}};
  layout_.outputs = {{"angle", "rad", "angle of the crankshaft", 1.0},
                     {"speed", "rad/s", "its speed", 100.0},
                     {"indicated_power", "W", "power of the gas on the pistons, lagged", 1e6},
                     {"consumer_power", "W", "power that the shaft gives to the generator, lagged", 1e6},
                     {"energy_balance", "1", "energy that is unaccounted for, of all that came in", 1.0}};
  layout_.states = {{"angle", "rad", "angle of the crankshaft", 1.0},
                    {"speed", "rad/s", "its speed", 100.0},
                    {"work_in", "J", "indicated work", 1e6},
                    {"work_out", "J", "work to friction and consumer", 1e6},
                    {"indicated_power", "W", "of the gas, lagged", 1e6},
                    {"consumer_power", "W", "to the generator, lagged", 1e6}};
}

PowerTrain::Torques PowerTrain::At(const View& view) const {
  const double speed = view.states[kSpeedState];
  const double turning = std::tanh(speed / p_.friction_speed_rad_per_s);
  const double indicated = view.inputs[0] + p_.cylinders * view.inputs[1] / (4.0 * std::numbers::pi) * turning;
  const double friction = (p_.friction_Nm + p_.friction_Nms_per_rad * std::abs(speed)) * turning;
  return {indicated, friction, grid_ ? indicated - friction : view.inputs[2]};
}

void PowerTrain::Start(std::span<const double> inputs, std::span<double> states, std::span<int>) const {
  states[kSpeedState] = p_.start_speed_rad_per_s;
  const Torques torque = At({0.0, inputs, states, {}});
  states[kIndicatedState] = torque.indicated * p_.start_speed_rad_per_s;
  states[kConsumerState] = torque.consumer * p_.start_speed_rad_per_s;
}

void PowerTrain::Derivative(const View& view, std::span<double> rates) const {
  const Torques torque = At(view);
  const double speed = view.states[kSpeedState];
  rates[kAngleState] = speed;
  rates[kSpeedState] = (torque.indicated - torque.friction - torque.consumer) / p_.inertia_kg_m2;
  rates[kWorkIn] = torque.indicated * speed;
  rates[kWorkOut] = (torque.friction + torque.consumer) * speed;
  rates[kIndicatedState] = (torque.indicated * speed - view.states[kIndicatedState]) / p_.power_lag_s;
  rates[kConsumerState] = (torque.consumer * speed - view.states[kConsumerState]) / p_.power_lag_s;
}

void PowerTrain::Output(const View& view, std::span<double> outputs) const {
  const double speed = view.states[kSpeedState], start = p_.start_speed_rad_per_s;
  outputs[kAngle] = view.states[kAngleState];
  outputs[kSpeed] = speed;
  outputs[kIndicatedPower] = view.states[kIndicatedState];
  outputs[kConsumerPower] = view.states[kConsumerState];
  const double stored = 0.5 * p_.inertia_kg_m2 * (speed * speed - start * start);
  const double in = 0.5 * p_.inertia_kg_m2 * start * start + std::abs(view.states[kWorkIn]);
  outputs[kEnergyBalance] = in > 0.0 ? (stored + view.states[kWorkOut] - view.states[kWorkIn]) / in : 0.0 * in;
}

}  // namespace dynoproof
