// Plant `charge_air`: the air intake of a single-cylinder engine's test bed, thesis (6.3)-(6.6), Fig. 6.4.
//
//   dp_ch/dt = R theta/V_1 (q_1 - q_e - l_1)          q_1 = flow through flap 1 from p_s to p_ch
//   dp_s/dt  = R theta/V_2 (q_c - q_2 - q_1 - l_2)    q_2 = flow through flap 2 from p_s to p_amb
// Flows by mechanics/gas_flow.h, in both directions; l_i = leakage of volume i to ambient (0 nominally). Inputs u_1,
// u_2 [%] flap positions, q_e, q_c [kg/s] taken by the engine and supplied by the compressor. Outputs p_ch, p_s [Pa],
// q_1, q_2 [kg/s], mass [kg] in both volumes. A volume without gas cannot be emptied further: its pressure stays at 0.
#pragma once

#include "model/registry.h"
#include "plugins/physics/gas_flow.h"

namespace dynoproof {

/// A flap as a scenario states it; shared with the controllers that invert its area.
struct FlapParams {
  std::string law = "cosine";
  double area_offset_m2 = 1e-5, area_span_m2 = 0.0, area_factor = 1.0;
  std::vector<double> positions_percent, areas_m2;
  void Visit(auto& v) {
    v.Optional("law", law, std::vector<std::string>{"cosine", "table"}, "how the area follows from the position");
    v.Optional("area_offset_m2", area_offset_m2, NonNegative(), "cosine: area of the closed flap");
    v.Optional("area_span_m2", area_span_m2, NonNegative(), "cosine: what the open flap adds");
    v.Optional("positions_percent", positions_percent, Any(), "table: positions, rising");
    v.Optional("areas_m2", areas_m2, NonNegative(), "table: area at each position, rising");
    v.Optional("area_factor", area_factor, Positive("1"), "factor on the whole area");
  }
  void Check(Faults& faults) const;
  mechanics::FlapArea Area() const;
};

class ChargeAir : public Component {
 public:
  struct Volume {
    double volume_m3 = 0.0, start_pressure_Pa = 101300.0, leakage_area_m2 = 0.0;
    void Visit(auto& v) {
      v.Required("volume_m3", volume_m3, Positive(), "volume");
      v.Optional("start_pressure_Pa", start_pressure_Pa, NonNegative(), "pressure at t = 0");
      v.Optional("leakage_area_m2", leakage_area_m2, NonNegative(), "area of a leak to ambient");
    }
  };
  struct Params {
    double R_J_per_kg_K = 287.05, theta_K = 320.0, ambient_pressure_Pa = 101300.0, kappa = 1.4;
    std::string flow_function = "approximate";
    std::vector<std::pair<std::string, Volume>> volume;
    std::vector<std::pair<std::string, FlapParams>> flap;
    void Visit(auto& v) {
      v.Optional("R_J_per_kg_K", R_J_per_kg_K, Positive(), "specific gas constant R");
      v.Optional("theta_K", theta_K, Positive(), "temperature of the air theta");
      v.Optional("ambient_pressure_Pa", ambient_pressure_Pa, NonNegative(), "pressure p_amb outside");
      v.Optional("flow_function", flow_function, std::vector<std::string>{"approximate", "isentropic"},
                 "(6.5), or the exact one of an ideal gas");
      v.Optional("kappa", kappa, Between(1.01, 1.67, "1"), "heat capacity ratio of the isentropic flow function");
      v.Required("volume", volume, Any(),
                 "[plant.volume.V_1] before the engine, [plant.volume.V_2] behind the compressor");
      v.Required("flap", flap, Any(), "[plant.flap.1] between the volumes, [plant.flap.2] to ambient");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  static PlantTraits Traits();
  explicit ChargeAir(const Params& params);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int in, int out) const override { return (out == 2 && in == 0) || (out == 3 && in == 1); }
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;

 private:
  double Flow(double area, double from, double to) const { return mechanics::OrificeFlow(gas_, area, from, to); }

  mechanics::Gas gas_;
  double ambient_;
  Volume volume_[2];
  mechanics::FlapArea area_[2];
};

}  // namespace dynoproof
