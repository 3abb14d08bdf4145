#include "plugins/law/hydrodynamic_coupling/hydrodynamic_coupling.h"

#include <cmath>

namespace dynoproof::laws {

PluginInfo KelvinVoigt::Info() {
  return {"law",
          "kelvin_voigt",
          "hydrodynamic coupling as spring and damper, if wanted with damping that falls as the oil warms up",
          "T = k d + c w; drifting: c (1 - drift (1 - exp(-t / drift_time)))",
          "thesis (4.2)",
          {}};
}

PluginInfo OilCoupling::Info() {
  return {"law",
          "oil_coupling",
          "hydrodynamic coupling with the dynamics of its oil",
          "T = k_s d + k_p Dp, dDp/dt = -kappa_p Dp + kappa_w w",
          "thesis (4.20), Table 4.2",
          {}};
}

PluginInfo OilCouplingGeometry::Info() {
  return {"law",
          "oil_coupling_geometry",
          "the oil coupling from its geometry and oil",
          "k_p = N w (l^2/2 + l r), kappa_p = 2 beta kappa_HP / V_0, kappa_w = 2 beta A (r + l/2) / V_0, A = w l, "
          "kappa_HP = w D^3 / (12 rho sigma L) (1 - 0.63 D/w); then as oil_coupling",
          "thesis (4.3)-(4.19); (4.3) with l r instead of the printed 2 l r",
          {}};
}

double KelvinVoigt::Torque(const LawView& view) const {
  double c = p_.damping_Nms_per_rad;
  if (p_.drift > 0.0) c *= 1.0 + p_.drift * std::expm1(-view.time_s / p_.drift_time_s);
  return p_.stiffness_Nm_per_rad * view.twist + c * view.rate;
}

OilCoupling::OilCoupling(const Params& params, const BuildContext& context)
    : OilCoupling(mechanics::OilCoupling{params.stiffness_Nm_per_rad, params.k_p_m3, params.kappa_p_per_s,
                                         params.kappa_w_Pa_per_rad},
                  context.nominal) {}

OilCoupling::OilCoupling(const mechanics::OilCoupling& model, double nominal_torque) : m_(model) {
  layout_.states = {{"pressure_drop", "Pa", "pressure drop Dp between the chambers", nominal_torque / m_.k_p}};
}

void OilCouplingGeometry::Params::Check(Faults& faults) const {
  if (gap_height_m > width_m) {
    faults.At("gap_height_m", fmt::format("the gap is higher ({} m) than wide ({} m)", gap_height_m, width_m),
              "(4.14) is that of a narrow gap, D much smaller than w");
  }
}

mechanics::OilCouplingGeometry OilCouplingGeometry::Params::Geometry() const {
  return {.segments = segments,
          .width = width_m,
          .length = length_m,
          .inner_radius = inner_radius_m,
          .chamber_volume = chamber_volume_m3,
          .gap_height = gap_height_m,
          .gap_length = gap_length_m,
          .bulk_modulus = bulk_modulus_Pa,
          .density = density_kg_per_m3,
          .kinematic_viscosity = viscosity_m2_per_s,
          .spring = stiffness_Nm_per_rad};
}

std::unique_ptr<OilCouplingGeometry> OilCouplingGeometry::Create(const Params& params, const Value& table,
                                                                 BuildContext& context) {
  const mechanics::OilCouplingGeometry geometry = params.Geometry();
  const mechanics::OilCouplingValidity validity =
      CheckValidity(geometry, params.largest_twist_rad, params.largest_rate_rad_per_s);
  for (const std::string& warning : validity.warnings) {
    context.diagnostics.Warning(table.where(), context.context + ": " + warning, "",
                                "dynoproof describe oil_coupling_geometry");
  }
  return std::unique_ptr<OilCouplingGeometry>(
      new OilCouplingGeometry(mechanics::FromGeometry(geometry), context.nominal));
}

}  // namespace dynoproof::laws
