// Controls of the air path: `charge_air_control`, the proposed one of thesis Secs. 6.2.2-6.2.4, and
// `charge_air_legacy`, its predecessor as Sec. 6.4 describes it.
#pragma once

#include "plugins/control/pressure_pi/conditioned_pi.h"
#include "plugins/plant/charge_air/charge_air.h"

namespace dynoproof::controls {

/// Where the flaps may go, and where they begin.
struct FlapRanges {
  double u_1_least_percent = 0.0, u_1_largest_percent = 50.0, u_2_least_percent = 0.0, u_2_largest_percent = 100.0;
  double initial_u_1_percent = 25.0, initial_u_2_percent = 50.0;
  void Visit(auto& v) {
    v.Optional("u_1_least_percent", u_1_least_percent, Any(), "range of flap 1");
    v.Optional("u_1_largest_percent", u_1_largest_percent, Any(), "range of flap 1");
    v.Optional("u_2_least_percent", u_2_least_percent, Any(), "range of flap 2");
    v.Optional("u_2_largest_percent", u_2_largest_percent, Any(), "range of flap 2");
    v.Optional("initial_u_1_percent", initial_u_1_percent, Any(), "flap 1 at t = 0");
    v.Optional("initial_u_2_percent", initial_u_2_percent, Any(), "flap 2 at t = 0");
  }
  void Check(Faults& faults) const;
};

/// Reference planning (6.12)-(6.14), decoupling (6.15), (6.16), two conditioned PI controllers (6.18)-(6.21). Inputs
/// reference, p_ch, p_s [Pa], speed [rad/s]; outputs u_1, u_2 [%], p_s_ref [Pa], w_1, w_2 [kg/s] before their limits.
class ChargeAirControl : public Component {
 public:
  struct Params : FlapRanges {
    double R_J_per_kg_K = 287.05, theta_K = 320.0, volume_1_m3 = 0.0, volume_2_m3 = 0.0;
    double displacement_m3 = 0.0, volumetric_efficiency = 1.0, revolutions_per_cycle = 2.0;
    double bandwidth_1_Hz = 0.5, bandwidth_2_Hz = 1.0 / 6.0;
    double largest_p_s_Pa = 0.0, largest_ratio = 1.95;
    std::string anti_windup = "conditioned";
    std::vector<std::pair<std::string, FlapParams>> flap;
    void Visit(auto& v) {
      v.Optional("R_J_per_kg_K", R_J_per_kg_K, Positive(), "specific gas constant R");
      v.Optional("theta_K", theta_K, Positive(), "temperature theta");
      v.Required("volume_1_m3", volume_1_m3, Positive(), "volume V_1 before the engine");
      v.Required("volume_2_m3", volume_2_m3, Positive(), "volume V_2 behind the compressor");
      v.Required("displacement_m3", displacement_m3, Positive(), "displaced volume V_d of the engine");
      v.Optional("volumetric_efficiency", volumetric_efficiency, Positive("1"), "lambda of (6.10), taken as constant");
      v.Optional("revolutions_per_cycle", revolutions_per_cycle, Positive("1"), "N_r: 2 for four strokes");
      v.Optional("bandwidth_1_Hz", bandwidth_1_Hz, Positive(), "f_n of p_ch, v_n = 2 pi f_n in (6.21)");
      v.Optional("bandwidth_2_Hz", bandwidth_2_Hz, Positive(), "f_n of p_s");
      v.Required("largest_p_s_Pa", largest_p_s_Pa, Positive(), "what the compressor stands");
      v.Optional("largest_ratio", largest_ratio, Between(1.0, 2.0, "1"), "largest p_s over p_ch that is asked for");
      FlapRanges::Visit(v);
      v.Optional("anti_windup", anti_windup, AntiWindupNames(),
                 "(6.18) as it unwinds, without its second term, or with the printed sign");
      v.Required("flap", flap, Any(), "[control.NAME.flap.1] and 2, as in the plant");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  static std::unique_ptr<ChargeAirControl> Create(const Params& params, const Value& table, BuildContext& context);

  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  ChargeAirControl(const Params& params, double period_s);
  /// One tick: the outputs, and the integrals of the next.
  void Step(const View& view, std::span<double> outputs, double& integral_1, double& integral_2) const;

  Params p_;
  double R_theta_;
  mechanics::FlapArea area_[2];
  ConditionedPi pi_[2];
};

/// A plain PI from p_ch to u_1; while u_1 is at a limit, u_2 moves slowly the way that helps. Inputs reference, p_ch
/// [Pa]; outputs u_1, u_2 [%].
class ChargeAirLegacy : public Component {
 public:
  struct Params : FlapRanges {
    double k_P_percent_per_bar = 0.0, k_I_percent_per_bar_s = 0.0, u_2_rate_percent_per_s = 0.0;
    void Visit(auto& v) {
      v.Required("k_P_percent_per_bar", k_P_percent_per_bar, NonNegative("%/bar"), "proportional gain");
      v.Required("k_I_percent_per_bar_s", k_I_percent_per_bar_s, NonNegative("%/(bar s)"), "integral gain");
      v.Required("u_2_rate_percent_per_s", u_2_rate_percent_per_s, Positive("%/s"), "how fast flap 2 moves");
      FlapRanges::Visit(v);
    }
  };
  static PluginInfo Info();
  static std::unique_ptr<ChargeAirLegacy> Create(const Params& params, const Value& table, BuildContext& context);

  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  ChargeAirLegacy(const Params& params, double period_s);

  Params p_;
  double period_s_;
};

}  // namespace dynoproof::controls
