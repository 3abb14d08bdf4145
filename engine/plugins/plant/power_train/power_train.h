// Part `power_train`: crankshaft with generator, thesis (6.2), in island or grid operation.
//
//   phi' = w      island: w' = (T_indicated - T_friction - T_consumer)/I      grid: w' = 0, the grid takes what is left
//   T_indicated = torque + cylinders work/(4 pi) tanh(w/w_0)     T_friction = (T_f + b |w|) tanh(w/w_0)
//
// `torque` is that of the gas while valves are open, `work` [J] the measured work of the closed part of a cycle, spread
// over its two turns: none is done at rest. Inputs torque, work, load [N m]; outputs angle, speed, indicated_power and
// consumer_power as a transducer with the lag power_lag_s shows them (gas torque pulsates; and no output may feed
// through, since the gas side reads angle and speed), energy_balance.
#pragma once

#include "model/registry.h"

namespace dynoproof {

/// Consumer: resistors at the generator's terminals.
///   P = U^2 (G + r (G - y))     T = P/(eta w), below w_0 falling to 0 with w     y' = (G - y)/tau     (power factor 1)
/// What is connected is cold and conducts 1 + r times as much; y is what is warm already, all of it at the start. With
/// r = 0 it has no state.
class ResistorLoad : public Component {
 public:
  struct Params {
    double efficiency = 1.0, least_speed_rad_per_s = 1.0, cold_share = 0.0, warming_s = 1.0;
    void Visit(auto& v) {
      v.Optional("efficiency", efficiency, Between(0.1, 1.0), "of the generator");
      v.Optional("least_speed_rad_per_s", least_speed_rad_per_s, Positive(), "speed w_0 that carries the full voltage");
      v.Optional("cold_share", cold_share, NonNegative("1"),
                 "r, by which a cold resistor conducts more than a warm one");
      v.Optional("warming_s", warming_s, Positive(), "tau, in which it gets warm");
    }
  };
  static PluginInfo Info();
  explicit ResistorLoad(const Params& params);
  bool FeedsThrough(int, int) const override { return true; }
  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;

 private:
  Params p_;
};

class PowerTrain : public Component {
 public:
  struct Params {
    std::string operation = "island";
    int cylinders = 20;
    double inertia_kg_m2 = 0.0, friction_Nm = 0.0, friction_Nms_per_rad = 0.0, friction_speed_rad_per_s = 1.0,
           start_speed_rad_per_s = 0.0, power_lag_s = 0.1;
    void Visit(auto& v) {
      v.Optional("operation", operation, std::vector<std::string>{"island", "grid"}, "grid: the speed stands");
      v.Optional("cylinders", cylinders, Between(1, 48), "of the whole engine");
      v.Required("inertia_kg_m2", inertia_kg_m2, Positive(), "crankshaft and generator I");
      v.Optional("friction_Nm", friction_Nm, NonNegative(), "dry friction T_f");
      v.Optional("friction_Nms_per_rad", friction_Nms_per_rad, NonNegative(), "viscous friction b");
      v.Optional("friction_speed_rad_per_s", friction_speed_rad_per_s, Positive(),
                 "w_0, below which T_f and the work of cycles go to 0");
      v.Optional("start_speed_rad_per_s", start_speed_rad_per_s, Any(), "speed at t = 0; the grid's");
      v.Optional("power_lag_s", power_lag_s, Positive(), "lag of the power transducers");
    }
  };
  enum Output_ { kAngle, kSpeed, kIndicatedPower, kConsumerPower, kEnergyBalance };
  static PluginInfo Info();
  explicit PowerTrain(const Params& params);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;

 private:
  struct Torques {
    double indicated, friction, consumer;
  };
  Torques At(const View& view) const;

  Params p_;
  bool grid_;
};

}  // namespace dynoproof
