// Control `speed_pi`: the core's PI speed controller (engine/control10k/speed_control.h) without torque feedthrough.
//
// e = reference - speed;  T = clamp(k_P e + s, +-limit);  s+ = s + k_I period e, held while T is at its limit and e
// would drive it further (conditional integration). Inputs reference, speed [rad/s], output torque [N m], state s [N
// m], `initial_torque_Nm` at the start.
#pragma once

#include "control10k/speed_control.h"
#include "model/registry.h"

namespace dynoproof::controls {

class SpeedPi : public Component {
 public:
  struct Params {
    double k_P_Nms_per_rad = 0.0, k_I_Nm_per_rad = 0.0, limit_Nm = 0.0, initial_torque_Nm = 0.0;
    void Visit(auto& v) {
      v.Required("k_P_Nms_per_rad", k_P_Nms_per_rad, NonNegative(), "proportional gain k_P");
      v.Required("k_I_Nm_per_rad", k_I_Nm_per_rad, NonNegative(), "integral gain k_I");
      v.Required("limit_Nm", limit_Nm, Positive(), "largest torque");
      v.Optional("initial_torque_Nm", initial_torque_Nm, Any(), "torque at t = 0");
    }
  };
  static PluginInfo Info();
  static std::unique_ptr<SpeedPi> Create(const Params& params, const Value& table, BuildContext& context);

  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  SpeedPi(const Params& params, double period_s);
  control10k::SpeedState Memory(std::span<const double> states) const;

  control10k::SpeedConfig config_;
  double initial_torque_, period_s_;
};

}  // namespace dynoproof::controls
