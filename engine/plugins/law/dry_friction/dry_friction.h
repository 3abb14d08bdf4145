// Laws with dry friction: `coulomb`, `stribeck`, `asymmetric`. They slip in either direction or stick.
//
// Mode 0 sticks: T = holding_torque, the torque that keeps the rate, up to the limit. Mode +1 or -1 slips with a rate
// of that sign: T = Slip(rate, mode). One guard, >= 0 as long as the mode holds: mode * rate while slipping, the margin
// of the holding torque to its limit while sticking. When the rate comes to zero the law sticks if the limit can hold,
// else it slips on in the direction in which the other torques push. The guard is continuous within a mode and jumps
// with it.
#pragma once

#include <cmath>

#include "model/registry.h"

namespace dynoproof::laws {

class DryFriction : public Law {
 public:
  DryFriction() {
    layout_.modes = 1;
    layout_.guards = 1;
  }

  void Start(double twist, double rate, std::span<double> states, std::span<int> modes) const final;
  double Torque(const LawView& view) const final;
  void Guards(const LawView& view, std::span<double> values) const final;
  void OnEvent(const LawView& view, int guard, std::span<double> states, std::span<int> modes) const final;
  bool sticks() const final { return true; }
  /// The transmitted torque when slipping in the direction of `sign` (+1, -1) at view.rate, with its sign and with the
  /// viscous part.
  double SlipTorque(const LawView& view, int sign) const final { return Slip(view.rate, sign); }

 protected:
  /// The torque above; smooth in `rate` through zero, so that a solver may step over the event before it goes back.
  virtual double Slip(double rate, int sign) const = 0;

 private:
  /// How far the holding torque is from what it can hold at most [N m].
  double Margin(double holding_torque) const;
};

/// T = T_c sgn(w).
class Coulomb : public DryFriction {
 public:
  struct Params {
    double T_c_Nm = 0.0;
    void Visit(auto& v) { v.Required("T_c_Nm", T_c_Nm, NonNegative(), "friction torque T_c"); }
  };
  static PluginInfo Info();
  explicit Coulomb(const Params& params) : T_c_(params.T_c_Nm) {}

 private:
  double Slip(double, int sign) const override { return sign * T_c_; }
  double T_c_;
};

/// T = (T_c + (T_s - T_c) exp(-(w/w_s)^2)) sgn(w); it sticks up to T_s.
class Stribeck : public DryFriction {
 public:
  struct Params {
    double T_c_Nm = 0.0, T_s_Nm = 0.0, w_s_rad_per_s = 1.0;
    void Visit(auto& v) {
      v.Required("T_c_Nm", T_c_Nm, NonNegative(), "sliding friction T_c at high speed");
      v.Required("T_s_Nm", T_s_Nm, NonNegative(), "static friction T_s");
      v.Required("w_s_rad_per_s", w_s_rad_per_s, Positive(), "Stribeck speed w_s");
    }
  };
  static PluginInfo Info();
  explicit Stribeck(const Params& params) : T_c_(params.T_c_Nm), T_s_(params.T_s_Nm), w_s_(params.w_s_rad_per_s) {}

 private:
  double Slip(double rate, int sign) const override {
    const double ratio = rate / w_s_;
    return sign * (T_c_ + (T_s_ - T_c_) * std::exp(-ratio * ratio));
  }
  double T_c_, T_s_, w_s_;
};

/// T = T_c_pos + b_pos w for w > 0, -T_c_neg + b_neg w for w < 0.
class Asymmetric : public DryFriction {
 public:
  struct Params {
    double T_c_pos_Nm = 0.0, T_c_neg_Nm = 0.0, b_pos_Nms_per_rad = 0.0, b_neg_Nms_per_rad = 0.0;
    void Visit(auto& v) {
      v.Required("T_c_pos_Nm", T_c_pos_Nm, NonNegative(), "Coulomb friction at w > 0");
      v.Required("T_c_neg_Nm", T_c_neg_Nm, NonNegative(), "Coulomb friction at w < 0");
      v.Optional("b_pos_Nms_per_rad", b_pos_Nms_per_rad, NonNegative(), "viscous friction at w > 0");
      v.Optional("b_neg_Nms_per_rad", b_neg_Nms_per_rad, NonNegative(), "viscous friction at w < 0");
    }
  };
  static PluginInfo Info();
  explicit Asymmetric(const Params& params) : p_(params) {}

 private:
  double Slip(double rate, int sign) const override {
    return sign > 0 ? p_.T_c_pos_Nm + p_.b_pos_Nms_per_rad * rate : -p_.T_c_neg_Nm + p_.b_neg_Nms_per_rad * rate;
  }
  Params p_;
};

}  // namespace dynoproof::laws
