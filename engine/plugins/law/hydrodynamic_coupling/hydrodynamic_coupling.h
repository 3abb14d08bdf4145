// Laws of hydrodynamic couplings (thesis chapter 4): `kelvin_voigt`, `oil_coupling`, `oil_coupling_geometry`.
#pragma once

#include "model/registry.h"
#include "plugins/law/hydrodynamic_coupling/oil_coupling.h"

namespace dynoproof::laws {

/// T = k d + c(t) w, (4.2). With `drift` the oil warms up and thins: c(t) = c (1 - drift (1 - exp(-t / drift_time))).
/// Without it a plain spring and damper, which the network takes up; its name marks the shaft as a coupling.
class KelvinVoigt : public Law {
 public:
  struct Params {
    double stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0, drift = 0.0, drift_time_s = 600.0;
    void Visit(auto& v) {
      v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, Positive(), "stiffness k_KV");
      v.Required("damping_Nms_per_rad", damping_Nms_per_rad, NonNegative(), "damping c_KV at the start");
      v.Optional("drift", drift, Between(0.0, 1.0), "share of the damping that is lost in the end");
      v.Optional("drift_time_s", drift_time_s, Positive(), "time constant of that");
    }
  };
  static PluginInfo Info();
  explicit KelvinVoigt(const Params& params) : p_(params) {}

  SpringDamper linear() const override { return {p_.stiffness_Nm_per_rad, p_.damping_Nms_per_rad}; }
  bool is_linear() const override { return p_.drift == 0.0; }
  double Torque(const LawView& view) const override;

 private:
  Params p_;
};

/// T = k_s d + k_p Dp, dDp/dt = -kappa_p Dp + kappa_w w, (4.20); one state Dp [Pa] that starts at 0. Energy
/// k_s d^2 / 2 + k_p Dp^2 / (2 kappa_w), loss k_p kappa_p / kappa_w Dp^2. Linear with a state: `realtime` carries it
/// exactly. Linear analysis sees it at low frequency: k_s and c(0) = k_p kappa_w / kappa_p.
class OilCoupling : public Law {
 public:
  struct Params {
    double stiffness_Nm_per_rad = 0.0, k_p_m3 = 0.0, kappa_p_per_s = 0.0, kappa_w_Pa_per_rad = 0.0;
    void Visit(auto& v) {
      v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, Positive(), "stiffness k_s of the spring packs");
      v.Required("k_p_m3", k_p_m3, Positive(), "torque per pressure drop, (4.4)");
      v.Required("kappa_p_per_s", kappa_p_per_s, Positive(), "decay of the pressure drop");
      v.Required("kappa_w_Pa_per_rad", kappa_w_Pa_per_rad, Positive(), "pressure drop per twist of closed-in oil");
    }
  };
  static PluginInfo Info();
  OilCoupling(const Params& params, const BuildContext& context);

  SpringDamper linear() const override { return {m_.k_s, 0.0}; }
  SpringDamper linearised() const override { return {m_.k_s, m_.At(0.0).damping}; }
  bool is_linear() const override { return true; }
  double Torque(const LawView& view) const override { return m_.k_s * view.twist + m_.k_p * view.states[0]; }
  void Derivative(const LawView& view, std::span<double> rates) const override {
    rates[0] = m_.kappa_w * view.rate - m_.kappa_p * view.states[0];
  }

 protected:
  OilCoupling(const mechanics::OilCoupling& model, double nominal_torque);

 private:
  mechanics::OilCoupling m_;
};

/// The same law, its numbers from the geometry and the oil by the chain (4.3)-(4.19). Warns where an assumption of that
/// chain does not hold in the stated range.
class OilCouplingGeometry : public OilCoupling {
 public:
  struct Params {
    double stiffness_Nm_per_rad = 0.0;
    int segments = 1;
    double width_m = 0.0, length_m = 0.0, inner_radius_m = 0.0, chamber_volume_m3 = 0.0, gap_height_m = 0.0,
           gap_length_m = 0.0, bulk_modulus_Pa = 3.5e9, density_kg_per_m3 = 870.0, viscosity_m2_per_s = 50e-6,
           largest_twist_rad = 0.0, largest_rate_rad_per_s = 0.0;
    void Visit(auto& v) {
      v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, Positive(), "stiffness k_s of the spring packs");
      v.Required("segments", segments, Between(1, 1000), "number N of segments, each a pair of chambers");
      v.Required("width_m", width_m, Positive(), "width w of a segment, along the axis");
      v.Required("length_m", length_m, Positive(), "length l of a segment, along the radius");
      v.Required("inner_radius_m", inner_radius_m, Positive(), "inner radius r");
      v.Required("chamber_volume_m3", chamber_volume_m3, Positive(), "volume V_0 of a chamber without twist");
      v.Required("gap_height_m", gap_height_m, Positive(), "height D of the gap");
      v.Required("gap_length_m", gap_length_m, Positive(), "length of the gap in the direction of the flow");
      v.Optional("bulk_modulus_Pa", bulk_modulus_Pa, Positive(), "bulk modulus beta of the oil as it acts");
      v.Optional("density_kg_per_m3", density_kg_per_m3, Positive(), "density rho_0 of the oil");
      v.Optional("viscosity_m2_per_s", viscosity_m2_per_s, Positive(), "kinematic viscosity of the oil");
      v.Required("largest_twist_rad", largest_twist_rad, Positive(), "for the warnings: largest twist in use");
      v.Required("largest_rate_rad_per_s", largest_rate_rad_per_s, Positive(), "for the warnings: its largest rate");
    }
    void Check(Faults& faults) const;
    mechanics::OilCouplingGeometry Geometry() const;
  };
  static PluginInfo Info();
  static std::unique_ptr<OilCouplingGeometry> Create(const Params& params, const Value& table, BuildContext& context);

 private:
  using OilCoupling::OilCoupling;
};

}  // namespace dynoproof::laws
