// Laws between a node and the ground that neither stick nor store: `viscous`, `quadratic_drag`, `constant`, `ripple`.
// The torque is the transmitted one: it brakes the node when positive.
#pragma once

#include "model/registry.h"

namespace dynoproof::laws {

/// T = b w.
class Viscous : public Law {
 public:
  struct Params {
    double b_Nms_per_rad = 0.0;
    void Visit(auto& v) { v.Required("b_Nms_per_rad", b_Nms_per_rad, NonNegative(), "viscous friction b"); }
  };
  static PluginInfo Info();
  explicit Viscous(const Params& params) : b_(params.b_Nms_per_rad) {}
  SpringDamper linear() const override { return {0.0, b_}; }
  bool is_linear() const override { return true; }
  double Torque(const LawView& view) const override { return b_ * view.rate; }

 private:
  double b_;
};

/// T = b2 w |w|.
class QuadraticDrag : public Law {
 public:
  struct Params {
    double b2_Nms2_per_rad2 = 0.0;
    void Visit(auto& v) { v.Required("b2_Nms2_per_rad2", b2_Nms2_per_rad2, NonNegative(), "drag b2"); }
  };
  static PluginInfo Info();
  explicit QuadraticDrag(const Params& params) : b2_(params.b2_Nms2_per_rad2) {}
  bool is_linear() const override { return b2_ == 0.0; }
  double Torque(const LawView& view) const override;

 private:
  double b2_;
};

/// T = T_0 at any speed, also at rest and backwards.
class ConstantLoad : public Law {
 public:
  struct Params {
    double T_0_Nm = 0.0;
    void Visit(auto& v) { v.Required("T_0_Nm", T_0_Nm, Any(), "load torque T_0, braking forward motion when > 0"); }
  };
  static PluginInfo Info();
  explicit ConstantLoad(const Params& params) : T_0_(params.T_0_Nm) {}
  double Torque(const LawView&) const override { return T_0_; }
  bool is_linear() const override { return T_0_ == 0.0; }
  bool constant() const override { return true; }

 private:
  double T_0_;
};

/// T = -A sin(n phi + theta): a torque A sin(n phi + theta) is added on the node, n times a revolution.
class Ripple : public Law {
 public:
  struct Params {
    double A_Nm = 0.0, n = 1.0, theta_rad = 0.0;
    void Visit(auto& v) {
      v.Required("A_Nm", A_Nm, Any(), "amplitude A");
      v.Required("n", n, NonNegative(), "order n of the angle");
      v.Optional("theta_rad", theta_rad, Any(), "phase theta");
    }
  };
  static PluginInfo Info();
  explicit Ripple(const Params& params) : p_(params) {}
  /// The torque is a spring for small angles, but linear analysis looks at a turning machine: nothing is linearised.
  bool is_linear() const override { return p_.A_Nm == 0.0; }
  double Torque(const LawView& view) const override;

 private:
  Params p_;
};

}  // namespace dynoproof::laws
