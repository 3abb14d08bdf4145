// Laws of shafts: `spring_damper`, `cubic_spring`, `warming_spring`.
#pragma once

#include <cmath>

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
  bool is_linear() const override { return true; }
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
  bool is_linear() const override { return k3_ == 0.0; }
  double Torque(const LawView& view) const override {
    return (k_ + k3_ * view.twist * view.twist) * view.twist + c_ * view.rate;
  }

 private:
  double k_, c_, k3_;
};

/// T = k(t) d + c w, k(t) = k (1 - loss (1 - exp(-t / loss_time))): a part that warms up as it runs.
class WarmingSpring : public Law {
 public:
  struct Params {
    double stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0, loss = 0.0, loss_time_s = 0.0;
    void Visit(auto& v) {
      v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, Positive(), "stiffness k at the start");
      v.Optional("damping_Nms_per_rad", damping_Nms_per_rad, NonNegative(), "damping c");
      v.Required("loss", loss, Between(0.0, 0.95, "1"), "share of the stiffness that is lost in the end");
      v.Required("loss_time_s", loss_time_s, Positive(), "time constant of that");
    }
  };
  static PluginInfo Info();
  explicit WarmingSpring(const Params& params) : p_(params) {}

  SpringDamper linear() const override { return {p_.stiffness_Nm_per_rad, p_.damping_Nms_per_rad}; }
  bool is_linear() const override { return p_.loss == 0.0; }
  double Torque(const LawView& view) const override {
    const double lost = -p_.loss * std::expm1(-view.time_s / p_.loss_time_s);
    return p_.stiffness_Nm_per_rad * (1.0 - lost) * view.twist + p_.damping_Nms_per_rad * view.rate;
  }

 private:
  Params p_;
};

}  // namespace dynoproof::laws
