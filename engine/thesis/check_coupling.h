// The check of kind `coupling`: a hydrodynamic coupling at one frequency (thesis chapter 4).
#pragma once

#include <string>
#include <vector>

#include "experiment/checks.h"

namespace dynoproof {

/// The steady stiffness and damping, (4.1), of a shaft's coupling at one frequency. Figures coupling_k_Nm_per_rad and
/// coupling_c_Nms_per_rad.
class CouplingCheck : public CheckPlan {
 public:
  struct Params {
    std::string shaft, origin;
    double nu_rad_per_s = 0.0, stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0, relative = 0.0;
    void Visit(auto& v) {
      v.Required("shaft", shaft, Any(), "name of the coupling's shaft");
      v.Required("nu_rad_per_s", nu_rad_per_s, NonNegative(), "frequency of the steady sine");
      v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, Positive(), "k that it should have there");
      v.Required("damping_Nms_per_rad", damping_Nms_per_rad, Positive(), "c that it should have there");
      v.Required("relative", relative, Positive("1"), "largest relative deviation of either");
      v.Required("origin", origin, Any(), "why this limit");
    }
  };
  static constexpr const char* kName = "coupling";
  static constexpr const char* kRelativeLimits[] = {"relative"};
  static constexpr const char* kSummary = "steady stiffness and damping of a hydrodynamic coupling at a frequency";
  explicit CouplingCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

}  // namespace dynoproof
