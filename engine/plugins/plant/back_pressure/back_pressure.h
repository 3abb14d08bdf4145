// Part `back_pressure`: the exhaust pipe of the single-cylinder test bed with the two flaps behind it, side by side, which
// hold the pressure that turbines would: thesis Sec. 6.1.2, Fig. 6.2.
//
//   m_j' = q_j,in - q_j      U' = h_in - sum h q      q = (A_3(u_3) + A_4(u_4)) p/sqrt(R theta) Psi(p/p_amb)
//
// States: masses of fresh air and exhaust gas, internal energy. Inputs u_3, u_4 [%], air_flow, gas_flow [kg/s] and
// enthalpy [W] of what the engine pushes out; outputs pressure [Pa], theta [K], air (share of fresh air), flow [kg/s]
// and enthalpy_out [W] through both flaps, mass [kg], energy [J].
#pragma once

#include "model/registry.h"
#include "plugins/physics/cylinder_geometry.h"
#include "plugins/physics/gas_exchange.h"
#include "plugins/plant/charge_air/charge_air.h"

namespace dynoproof {

class BackPressure : public Component {
 public:
  struct Params {
    double volume_m3 = 0.0, start_pressure_Pa = 101300.0, start_theta_K = 700.0, ambient_pressure_Pa = 101300.0,
           ambient_theta_K = 298.0, laminar_ratio = 0.01;
    GasParams gases;
    std::vector<std::pair<std::string, FlapParams>> flap;
    void Visit(auto& v) {
      v.Required("volume_m3", volume_m3, Positive(), "volume of the pipe");
      v.Optional("start_pressure_Pa", start_pressure_Pa, Positive(), "pressure at t = 0");
      v.Optional("start_theta_K", start_theta_K, Positive(), "temperature at t = 0");
      v.Optional("ambient_pressure_Pa", ambient_pressure_Pa, Positive(), "pressure outside");
      v.Optional("ambient_theta_K", ambient_theta_K, Positive(), "temperature outside");
      v.Optional("laminar_ratio", laminar_ratio, Between(1e-6, 0.5), "as in engine_bank");
      gases.Visit(v);
      v.Required("flap", flap, Any(), "3, the large one, and 4, side by side");
    }
    void Check(Faults& faults) const;
  };
  enum Input_ { kFlap3, kFlap4, kAirFlow, kGasFlow, kEnthalpy };
  enum Output_ { kPressure, kTheta, kAir, kFlow, kEnthalpyOut, kMass, kEnergy };
  static PluginInfo Info();
  explicit BackPressure(const Params& params);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int in, int out) const override { return in <= kFlap4 && (out == kFlow || out == kEnthalpyOut); }
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;

 private:
  mechanics::GasState Gas(const View& view) const;
  /// What leaves through both flaps.
  mechanics::Charge Outflow(const View& view, const mechanics::GasState& gas) const;

  Params p_;
  mechanics::GasPair gases_;
  mechanics::GasState ambient_;
  mechanics::LaminarFlowFunction psi_;
  mechanics::FlapArea area_[2];
};

}  // namespace dynoproof
