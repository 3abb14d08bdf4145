// Plant `fuel_gas`: the fuel gas supply of a single-cylinder engine's test bed, thesis (6.23)-(6.29), Fig. 6.5. A
// membrane compares the commanded pressure with that of the gas and moves the valve against a spring.
//
//   m x'' = A (p_mem - p_g) - F_s0 - k_s x - c_s x' - F      F: Coulomb friction (0 nominally), sticking when it can
//   hold dp_g/dt = R theta/V (q_g - q_e - leak) q_g = max(0, A_v(x)) p/sqrt(2 R theta)                    choked
//   throughout; linear: = max(0, k_q x + d_q) p = p_res - droop q_g                                     q_g never flows
//   back
// Inputs p_mem [Pa], q_e [kg/s] taken by the engine; outputs p_g [Pa], q_g [kg/s], x [m], mass [kg]. It starts at rest in the
// equilibrium of the first inputs.
//
// The plant is linear but for the flow's kink (and leak, droop, friction): `realtime` carries it exactly, with preload,
// flow, leak and friction as channels; while the valve stays open the only steps left are constants.
#pragma once

#include "model/linear_part.h"
#include "model/registry.h"
#include "plugins/law/dry_friction/dry_friction.h"
#include "plugins/physics/gas_flow.h"

namespace dynoproof {

class FuelGas : public Component {
 public:
  struct Valve {
    std::string law = "linear";
    double area_slope_m = 0.0, flow_at_rest_kg_per_s = 0.0, area_factor = 1.0, friction_N = 0.0;
    std::vector<double> positions_m, areas_m2;
    void Visit(auto& v) {
      v.Optional("law", law, std::vector<std::string>{"linear", "table"}, "how the area follows from the position");
      v.Optional("area_slope_m", area_slope_m, NonNegative(), "linear: slope dA_v/dx of the effective area");
      v.Optional("flow_at_rest_kg_per_s", flow_at_rest_kg_per_s, Any(), "linear: flow d_q at x = 0, at full pressure");
      v.Optional("positions_m", positions_m, Any(), "table: positions, rising");
      v.Optional("areas_m2", areas_m2, NonNegative(), "table: effective area at each position, rising");
      v.Optional("area_factor", area_factor, Positive("1"), "factor on the whole area");
      v.Optional("friction_N", friction_N, NonNegative(), "Coulomb friction of membrane and rod");
    }
    void Check(Faults& faults) const;
  };
  struct Reservoir {
    double pressure_Pa = 0.0, droop_Pas_per_kg = 0.0;
    void Visit(auto& v) {
      v.Required("pressure_Pa", pressure_Pa, Positive(), "pressure p_res without flow");
      v.Optional("droop_Pas_per_kg", droop_Pas_per_kg, NonNegative(), "what it loses for each kg/s");
    }
  };
  struct Volume {
    double volume_m3 = 0.0, leakage_area_m2 = 0.0;
    void Visit(auto& v) {
      v.Required("volume_m3", volume_m3, Positive(), "volume V");
      v.Optional("leakage_area_m2", leakage_area_m2, NonNegative(), "area of a leak to ambient");
    }
  };
  struct Params {
    double R_J_per_kg_K = 518.0, theta_K = 300.0, ambient_pressure_Pa = 101300.0, mass_kg = 0.0, membrane_area_m2 = 0.0,
           preload_N = 0.0, stiffness_N_per_m = 0.0, damping_Ns_per_m = 0.0, start_p_mem_Pa = 0.0;
    std::string carried = "exactly";
    std::vector<std::pair<std::string, Valve>> valve;
    std::vector<std::pair<std::string, Reservoir>> reservoir;
    std::vector<std::pair<std::string, Volume>> volume;
    void Visit(auto& v) {
      v.Optional("R_J_per_kg_K", R_J_per_kg_K, Positive(), "specific gas constant R");
      v.Optional("theta_K", theta_K, Positive(), "temperature of the gas theta");
      v.Optional("ambient_pressure_Pa", ambient_pressure_Pa, NonNegative(), "pressure outside");
      v.Required("mass_kg", mass_kg, Positive(), "mass m of membrane, rod and valve");
      v.Required("membrane_area_m2", membrane_area_m2, Positive(), "membrane area A");
      v.Optional("preload_N", preload_N, Any(), "pre-load F_s0 of the spring");
      v.Required("stiffness_N_per_m", stiffness_N_per_m, Positive(), "stiffness k_s of the spring");
      v.Optional("damping_Ns_per_m", damping_Ns_per_m, NonNegative(), "damping c_s");
      v.Optional("start_p_mem_Pa", start_p_mem_Pa, NonNegative(),
                 "command whose equilibrium it starts in, where a controller gives none before its first tick; 0: the "
                 "first one");
      v.Optional("carried", carried, std::vector<std::string>{"exactly", "stepped"},
                 "how `realtime` carries it; stepped: along with an engine that takes gas in pulses, so that what the "
                 "pipe loses the engine gains to the last digit");
      v.Required("valve", valve, Any(), "[plant.valve.v_g]: the valve that the membrane moves");
      v.Required("reservoir", reservoir, Any(), "[plant.reservoir.res]: what supplies the gas");
      v.Required("volume", volume, Any(), "[plant.volume.V]: the pipe before the engine");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  static PlantTraits Traits();
  explicit FuelGas(const Params& params);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;
  void Guards(const View& view, std::span<double> values) const override;
  void OnEvent(const View& view, int guard, std::span<double> states, std::span<int> modes) const override;
  const LinearPart* linear_part() const override { return stepped_ ? nullptr : &linear_part_; }

 private:
  /// q_g at a position of the valve; never negative.
  double Flow(double x) const;
  /// Through the leak, from p_g to ambient.
  double Leak(double p_g) const { return mechanics::OrificeFlow(gas_, leak_area_, p_g, ambient_); }
  /// Force on the membrane without friction.
  double Force(const View& view) const;
  LawView FrictionView(const View& view) const;
  void BuildLinearPart();

  mechanics::Gas gas_;
  double ambient_, mass_, membrane_area_, preload_, stiffness_, damping_, start_p_mem_;
  double flow_slope_, flow_at_rest_;       // linear valve: k_q, d_q; 0 with a table
  double droop_;                           // share of p_res that 1 kg/s takes [s/kg]
  double leak_area_, pressure_rate_;       // pressure_rate_: R theta/V [Pa/kg]
  std::vector<double> positions_, flows_;  // table valve: flow at full pressure
  bool stepped_;                           // no linear part is offered
  std::unique_ptr<Law> friction_;          // null without
  std::vector<std::unique_ptr<Law>> channel_laws_;
  LinearPart linear_part_;
};

}  // namespace dynoproof
