// Pictures of hydrodynamic couplings: stiffness and damping over frequency.
#include "thesis/pictures_coupling.h"

#include <fmt/format.h>

#include "thesis/coupling.h"

namespace dynoproof {
namespace {

const Value::Table& ShaftsOf(const Plan& plan) {
  static const Value::Table none;
  const Value* shafts = plan.root.FindPath("plant.shaft");
  return shafts != nullptr && shafts->is_table() ? shafts->table() : none;
}

}  // namespace

void AddCouplings(const Prepared& prepared, const Course&, RunPictures& pictures) {
  for (const Value::Entry& shaft : ShaftsOf(prepared.plan)) {
    const std::string law = shaft.value.TextOr("law");
    if (law != "oil_coupling" && law != "kelvin_voigt") continue;
    Picture k{.key = "coupling_k",
              .title = fmt::format("Stiffness of \"{}\" under a steady sine", shaft.key),
              .note = "thesis (4.1), (4.21)",
              .x = {"angular frequency", "rad/s"},
              .y = {"k", "N m/rad"}};
    Picture c{.key = "coupling_c",
              .title = fmt::format("Damping of \"{}\" under a steady sine", shaft.key),
              .note = "thesis (4.1), (4.21)",
              .x = {"angular frequency", "rad/s"},
              .y = {"c", "N m s/rad"}};
    Curve stiffness{law, {}, {}}, damping{law, {}, {}};
    for (double nu = 0.0; nu <= 700.0; nu += 2.0) {
      const std::optional<mechanics::DynamicValues> values = SteadyValues(shaft.value, nu);
      if (!values) break;
      for (auto [curve, value] : {std::pair(&stiffness, values->stiffness), std::pair(&damping, values->damping)}) {
        curve->x.push_back(nu);
        curve->y.push_back(value);
      }
    }
    k.curves.push_back(std::move(stiffness));
    c.curves.push_back(std::move(damping));
    const Value* checks = prepared.plan.root.Find("check");
    for (const Value& check : checks != nullptr && checks->is_array() ? checks->array() : Value::Array{}) {
      if (check.TextOr("kind") != "coupling" || check.TextOr("shaft") != shaft.key) continue;
      const double nu = check.NumberOr("nu_rad_per_s", 0.0);
      k.curves.push_back({"checked", {nu}, {check.NumberOr("stiffness_Nm_per_rad", 0.0)}, Curve::Style::kCircles});
      c.curves.push_back({"checked", {nu}, {check.NumberOr("damping_Nms_per_rad", 0.0)}, Curve::Style::kCircles});
    }
    for (Picture* picture : {&k, &c}) pictures.pictures.push_back(std::move(*picture));
  }
}

}  // namespace dynoproof
