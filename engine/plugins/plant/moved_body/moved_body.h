// A body whose motion is measured, on a spring, a damper and other laws to the ground: the force that they need. The
// plant of a damper or mount on a testing machine, where the machine sets the motion and a load cell measures.
//
// F = k x + c v + A p + sum of the laws' forces at (x, v). States: those of the laws. Friction slips wherever v is not 0; at
// v = 0 nothing tells its force, which is then 0. A measured speed has noise and steps: with a transition speed v_t the
// force of friction is multiplied by tanh(|v| / v_t) and has no jump. With an area A the body is the piston of a cylinder
// whose gauge pressure p is measured, and p A is added. Inputs x [m], v [m/s], with an area p [Pa]; output force [N].
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/component.h"
#include "model/motion.h"
#include "model/registry.h"
#include "plugins/plant/sliding_loads.h"

namespace dynoproof {

class MovedBody : public Component {
 public:
  struct Params {
    std::string body = "body";
    double stiffness_N_per_m = 0.0, damping_Ns_per_m = 0.0, nominal_force_N = 1000.0;
    double transition_speed_m_per_s = 0.0, area_m2 = 0.0;
    std::vector<std::pair<std::string, Value>> load;
    void Visit(auto& v) {
      v.Optional("body", body, Any(), "name of the body: the place of frictions, inertia:NAME");
      v.Optional("stiffness_N_per_m", stiffness_N_per_m, NonNegative(), "stiffness k to the ground");
      v.Optional("damping_Ns_per_m", damping_Ns_per_m, NonNegative(), "damping c to the ground");
      v.Optional("transition_speed_m_per_s", transition_speed_m_per_s, NonNegative(),
                 "v_t: friction turns its sign along tanh(v / v_t), 0: at once");
      v.Optional("area_m2", area_m2, NonNegative(),
                 "area A that the gauge pressure `p` acts on; 0: there is no input p");
      v.Optional("nominal_force_N", nominal_force_N, Positive(), "usual force; scales solver tolerances");
      v.Optional("load", load, Any(),
                 "laws to the ground by name: on = the body, law and its parameters; read force, speed, stretch");
    }
  };

  static PluginInfo Info();
  static PlantTraits Traits();
  /// Null, with diagnostics, where a load is faulty.
  static std::unique_ptr<MovedBody> Create(const Params& params, const Value& table, BuildContext& context);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;

 private:
  MovedBody() = default;

  double stiffness_ = 0.0, damping_ = 0.0, area_ = 0.0;
  SlidingLoads loads_;
};

}  // namespace dynoproof
