// Controls of a multi-cylinder engine's control unit, as simplified replicas: thesis Sec. 6.1.3 names knock, engine
// speed and NOx, Sec. 6.4.3 the voltage of the generator; it prints none of them. All are sampled, begin without a bump
// at `initial_*` and stop their integrals at limits.
//
//   engine_governor   fuel = clamp(k_P e + s, 0, min(largest, air/(L lambda_least))), s+ = s + k_I T e within the
//   limits;
//                     0 for good once the speed was beyond `trip`
//   nox_control       blow_off = clamp(k_P e + s, 0, 100), e = 1 - NOx/limit: too much NOx closes it, the mixture gets
//                     leaner
//   knock_control     retard+ = retard + step while knock > 1, else retard - rate T; within 0 ... largest
//   voltage_control   U = U_n clamp(1 - slope (w_knee - w)/w_n, least, 1): under-speed takes load off the engine;
//                     it follows with the lag of the excitation
//   gas_reference     p_g* = p_ch* + difference: the gas valve in the port needs a pressure drop
#pragma once

#include "model/registry.h"

namespace dynoproof::controls {

class EngineGovernor : public Component {
 public:
  struct Params {
    double k_P_kgs_per_rad = 0.0, k_I_kg_per_rad = 0.0, largest_kg = 0.0, air_need = 16.8, least_air_ratio = 1.0,
           trip_rad_per_s = 0.0, initial_kg = 0.0;
    void Visit(auto& v) {
      v.Required("k_P_kgs_per_rad", k_P_kgs_per_rad, NonNegative("kg s/rad"), "proportional gain");
      v.Required("k_I_kg_per_rad", k_I_kg_per_rad, NonNegative("kg/rad"), "integral gain");
      v.Required("largest_kg", largest_kg, Positive(), "largest fuel for a cylinder and cycle");
      v.Optional("air_need", air_need, Positive("1"), "stoichiometric air L, kg per kg of fuel");
      v.Optional("least_air_ratio", least_air_ratio, Positive("1"), "richest mixture that does not knock");
      v.Required("trip_rad_per_s", trip_rad_per_s, Positive(), "overspeed that shuts the engine down");
      v.Required("initial_kg", initial_kg, NonNegative(), "fuel at t = 0");
    }
  };
  static PluginInfo Info();
  static std::unique_ptr<EngineGovernor> Create(const Params& params, const Value& table, BuildContext& context);
  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  EngineGovernor(const Params& params, double period_s);
  Params p_;
  double period_s_;
};

class NoxControl : public Component {
 public:
  struct Params {
    double k_P_percent = 0.0, k_I_percent_per_s = 0.0, initial_percent = 0.0;
    void Visit(auto& v) {
      v.Required("k_P_percent", k_P_percent, NonNegative(), "proportional gain");
      v.Required("k_I_percent_per_s", k_I_percent_per_s, NonNegative("%/s"), "integral gain");
      v.Required("initial_percent", initial_percent, Between(0.0, 100.0), "position at t = 0");
    }
  };
  static PluginInfo Info();
  static std::unique_ptr<NoxControl> Create(const Params& params, const Value& table, BuildContext& context);
  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  NoxControl(const Params& params, double period_s);
  Params p_;
  double period_s_;
};

class KnockControl : public Component {
 public:
  struct Params {
    double step_deg = 0.5, recovery_deg_per_s = 1.0, largest_deg = 10.0;
    void Visit(auto& v) {
      v.Optional("step_deg", step_deg, Positive("deg"), "later by this at each tick that knocks");
      v.Optional("recovery_deg_per_s", recovery_deg_per_s, NonNegative("deg/s"), "earlier again at this rate");
      v.Optional("largest_deg", largest_deg, Positive("deg"), "largest retard");
    }
  };
  static PluginInfo Info();
  static std::unique_ptr<KnockControl> Create(const Params& params, const Value& table, BuildContext& context);
  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  KnockControl(const Params& params, double period_s);
  Params p_;
  double period_s_;
};

class VoltageControl : public Component {
 public:
  struct Params {
    double rated_V = 0.0, rated_rad_per_s = 0.0, knee_rad_per_s = 0.0, slope = 2.0, least = 0.5, lag_s = 0.0;
    void Visit(auto& v) {
      v.Required("rated_V", rated_V, Positive(), "voltage U_n");
      v.Required("rated_rad_per_s", rated_rad_per_s, Positive(), "speed w_n");
      v.Required("knee_rad_per_s", knee_rad_per_s, Positive(), "speed below which the voltage falls");
      v.Optional("slope", slope, NonNegative("1"), "relative voltage over relative speed");
      v.Optional("least", least, Between(0.0, 1.0), "lowest relative voltage");
      v.Optional("lag_s", lag_s, NonNegative(), "lag of the excitation");
    }
  };
  static PluginInfo Info();
  static std::unique_ptr<VoltageControl> Create(const Params& params, const Value& table, BuildContext& context);
  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  VoltageControl(const Params& params, double period_s);
  Params p_;
  double step_;  // share of the distance that the excitation goes in a tick
};

class GasReference : public Component {
 public:
  struct Params {
    double difference_Pa = 0.0;
    void Visit(auto& v) { v.Required("difference_Pa", difference_Pa, Any(), "of the gas to the charge pressure"); }
  };
  static PluginInfo Info();
  explicit GasReference(const Params& params);
  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  double difference_;
};

}  // namespace dynoproof::controls
