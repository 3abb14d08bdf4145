#include "thesis/check_coupling.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "thesis/coupling.h"

namespace dynoproof {

std::vector<score::Check> CouplingCheck::Run(CheckContext& context) const {
  const std::string name = fmt::format("{} at {:g} rad/s", p_.shaft, p_.nu_rad_per_s);
  const Value* shaft = context.plan().root.FindPath("plant.shaft." + p_.shaft);
  const std::optional<mechanics::DynamicValues> at =
      shaft != nullptr ? SteadyValues(*shaft, p_.nu_rad_per_s) : std::nullopt;
  if (!at) {
    return {FailedCheck(kName, name, std::numeric_limits<double>::quiet_NaN(), "1", p_.origin,
                        shaft == nullptr ? "there is no such shaft" : "its law has no steady stiffness and damping")};
  }
  context.figures["coupling_k_Nm_per_rad"] = {at->stiffness, "N m/rad"};
  context.figures["coupling_c_Nms_per_rad"] = {at->damping, "N m s/rad"};
  return {score::AtMost(name + ", stiffness", kName, std::abs(at->stiffness / p_.stiffness_Nm_per_rad - 1.0),
                        p_.relative, "1", p_.origin, fmt::format("{:.5g} N m/rad", at->stiffness)),
          score::AtMost(name + ", damping", kName, std::abs(at->damping / p_.damping_Nms_per_rad - 1.0), p_.relative,
                        "1", p_.origin, fmt::format("{:.4g} N m s/rad", at->damping))};
}

}  // namespace dynoproof
