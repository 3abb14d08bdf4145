// Laws of shafts: `spring_damper`, `cubic_spring`.
#pragma once

#include "model/registry.h"

namespace dynoproof::laws {

/// T = k d + c w.
class SpringDamperLaw : public Law {
 public:
  struct Params {
    double stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0;
    void Visit(auto& v) {
      v.Optional("stiffness_Nm_per_rad", stiffness_Nm_per_rad, NonNegative(), "stiffness k");
      v.Optional("damping_Nms_per_rad", damping_Nms_per_rad, NonNegative(), "damping c");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  explicit SpringDamperLaw(const Params& params) : k_(params.stiffness_Nm_per_rad), c_(params.damping_Nms_per_rad) {}

  SpringDamper linear() const override { return {k_, c_}; }
  double Torque(const LawView& view) const override { return k_ * view.twist + c_ * view.rate; }

 private:
  double k_, c_;
};

/// T = k d + k3 d^3 + c w. k3 < 0 softens; the torque then falls beyond |d| = sqrt(k / (3 |k3|)).
class CubicSpring : public Law {
 public:
  struct Params {
    double stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0, k3_Nm_per_rad3 = 0.0;
    void Visit(auto& v) {
      v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, NonNegative(), "stiffness k at zero twist");
      v.Optional("damping_Nms_per_rad", damping_Nms_per_rad, NonNegative(), "damping c");
      v.Required("k3_Nm_per_rad3", k3_Nm_per_rad3, Any(), "cubic stiffness k3");
    }
  };
  static PluginInfo Info();
  explicit CubicSpring(const Params& params)
      : k_(params.stiffness_Nm_per_rad), c_(params.damping_Nms_per_rad), k3_(params.k3_Nm_per_rad3) {}

  SpringDamper linear() const override { return {k_, c_}; }
  double Torque(const LawView& view) const override {
    return (k_ + k3_ * view.twist * view.twist) * view.twist + c_ * view.rate;
  }

 private:
  double k_, c_, k3_;
};

}  // namespace dynoproof::laws
