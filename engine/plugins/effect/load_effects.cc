#include "plugins/effect/load_effects.h"

#include <limits>
#include <numbers>
#include <utility>

#include "plugins/effect/plan_edit.h"

namespace dynoproof::effects {
namespace {

// Bounds for drive lines of 0.001 ... 100 kg m^2 under 1 ... 20000 N m. A friction above the largest torque would hold
// the line for ever; the dampings brake with that torque at the slowest speeds of interest, about 10 rad/s. Strengths
// start small but above 0, where a relative step of a fit still changes something; what is linear and of either sign
// starts at 0.
constexpr double kLargestTorque = 20000.0, kSmallTorque = 0.1;

class LoadEffect : public Effect {
 public:
  using StartsOf = Points (*)(const Magnitudes& m);

  /// `keys`: the law's key for each parameter of the effect.
  LoadEffect(EffectInfo info, std::string law, std::vector<std::string> keys, StartsOf starts)
      : law_(std::move(law)), keys_(std::move(keys)), starts_(starts) {
    info_ = std::move(info);
  }

  std::vector<Place> Places(const Plan& plan) const override {
    const PlantTraits& plant = PlantOf(plan);
    if (!plant.bodies || (plant.drive_line && DriveLineOf(plan) == nullptr)) return {};
    return plant.bodies(plan);
  }

  Points Starts(const Plan&, const Place&, const Magnitudes& magnitudes) const override { return starts_(magnitudes); }

  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    const std::vector<std::string> taken = AllNames(plan);
    const bool free = FreeName(info_.name, taken) == info_.name;
    const std::string name = free ? info_.name : FreeName(info_.name + "_" + place.name, taken);
    Value load = {{"on", place.name}, {"law", law_}};
    for (std::size_t i = 0; i < keys_.size(); ++i) load[KeyIn(plan, load, keys_[i])] = Value(parameters[i]);
    plan.root["plant"]["load"][name] = std::move(load);
  }

 private:
  std::string law_;
  std::vector<std::string> keys_;
  StartsOf starts_;
};

/// A friction torque that a line of this torque has about [N m].
double FrictionTorque(const Magnitudes& m) { return 0.02 * m.torque; }

// Loads whose torque follows from the speed alone explain much of each other's error.
constexpr const char* kLoads = "load";

EffectParameter Friction(const char* name, const char* description) {
  return {name, "N m", description, 0.0, kLargestTorque, 0.0, kSmallTorque};
}

EffectParameter Damping(const char* name, const char* description) {
  return {name, "N m s/rad", description, 0.0, 2000.0, 0.0, 0.01};
}

}  // namespace

std::unique_ptr<Effect> ViscousFriction() {
  return std::make_unique<LoadEffect>(EffectInfo{"viscous_friction",
                                                 "T = -b w",
                                                 "friction that grows with speed",
                                                 {Damping("b", "viscous friction")},
                                                 {.family = kLoads}},
                                      "viscous", std::vector<std::string>{"b_Nms_per_rad"},
                                      [](const Magnitudes& m) { return Points{{FrictionTorque(m) / m.speed}}; });
}

std::unique_ptr<Effect> CoulombFriction() {
  return std::make_unique<LoadEffect>(EffectInfo{"coulomb_friction",
                                                 "T = -T_c sgn(w), sticking when it can hold",
                                                 "dry friction",
                                                 {Friction("T_c", "friction torque")},
                                                 {.dry_friction = true, .family = kLoads}},
                                      "coulomb", std::vector<std::string>{"T_c_Nm"},
                                      [](const Magnitudes& m) { return Points{{FrictionTorque(m)}}; });
}

std::unique_ptr<Effect> StribeckFriction() {
  return std::make_unique<LoadEffect>(
      EffectInfo{"stribeck_friction",
                 "T = -(T_c + (T_s - T_c) exp(-(w/w_s)^2)) sgn(w)",
                 "dry friction that falls with speed",
                 {Friction("T_c", "sliding friction at high speed"),
                  {"T_s", "N m", "static friction", 0.0, kLargestTorque, 0.0, 2.0 * kSmallTorque},
                  // Lubricated contacts lose their static friction between some mrad/s and some 10 rad/s.
                  {"w_s", "rad/s", "Stribeck speed", 1e-3, 100.0, kShape, 1.0}},
                 {.dry_friction = true, .refines = {"coulomb_friction"}}},
      "stribeck", std::vector<std::string>{"T_c_Nm", "T_s_Nm", "w_s_rad_per_s"}, [](const Magnitudes& m) {
        const double friction = FrictionTorque(m);
        return Points{{friction, 2 * friction, 0.1 * m.speed}, {friction, 2 * friction, 0.5 * m.speed}};
      });
}

std::unique_ptr<Effect> AsymmetricFriction() {
  return std::make_unique<LoadEffect>(
      EffectInfo{"asymmetric_friction",
                 "T = -T_c_pos - b_pos w (w > 0), T_c_neg - b_neg w (w < 0)",
                 "dry and viscous friction that differ with direction",
                 {Friction("T_c_pos", "Coulomb friction at w > 0"), Friction("T_c_neg", "Coulomb friction at w < 0"),
                  Damping("b_pos", "viscous friction at w > 0"), Damping("b_neg", "viscous friction at w < 0")},
                 {.dry_friction = true, .refines = {"coulomb_friction", "viscous_friction"}}},
      "asymmetric", std::vector<std::string>{"T_c_pos_Nm", "T_c_neg_Nm", "b_pos_Nms_per_rad", "b_neg_Nms_per_rad"},
      [](const Magnitudes& m) {
        const double friction = FrictionTorque(m);
        return Points{{friction, friction, friction / m.speed, friction / m.speed}};
      });
}

std::unique_ptr<Effect> DahlFriction() {
  return std::make_unique<LoadEffect>(
      EffectInfo{"dahl_friction",
                 "T = -F, dF/dt = sigma w (1 - F sgn(w)/F_c)",
                 "friction with elastic pre-sliding",
                 {Friction("F_c", "friction torque of long motion"),
                  // F_c/sigma is the angle of break-away: seals and bearings give way after 1e-4 ... 1e-2 rad.
                  {"sigma", "N m/rad", "pre-sliding stiffness", 1.0, 1e8, kShape, 100.0}},
                 {.dry_friction = true, .refines = {"coulomb_friction"}}},
      "dahl", std::vector<std::string>{"F_c_Nm", "sigma_Nm_per_rad"}, [](const Magnitudes& m) {
        const double friction = FrictionTorque(m);
        Points starts;
        for (const double angle : {1e-4, 1e-3, 1e-2, 0.1}) starts.push_back({friction, friction / angle});
        return starts;
      });
}

std::unique_ptr<Effect> ConstantLoad() {
  return std::make_unique<LoadEffect>(
      EffectInfo{"constant_load",
                 "T = -T_0",
                 "a load that the model does not have",
                 {{"T_0", "N m", "load torque", -kLargestTorque, kLargestTorque, 0.0, 0.0}},
                 {.family = kLoads}},
      "constant", std::vector<std::string>{"T_0_Nm"}, [](const Magnitudes& m) { return Points{{FrictionTorque(m)}}; });
}

std::unique_ptr<Effect> QuadraticDrag() {
  return std::make_unique<LoadEffect>(
      EffectInfo{"quadratic_drag",
                 "T = -b2 w abs(w)",
                 "windage: drag with the square of the speed",
                 {{"b2", "N m s^2/rad^2", "drag", 0.0, 200.0, 0.0, 1e-4}},
                 {.family = kLoads}},
      "quadratic_drag", std::vector<std::string>{"b2_Nms2_per_rad2"},
      [](const Magnitudes& m) { return Points{{FrictionTorque(m) / (m.speed * m.speed)}}; });
}

std::unique_ptr<Effect> TorqueRipple() {
  return std::make_unique<LoadEffect>(
      EffectInfo{"torque_ripple",
                 "T = A sin(n phi + theta)",
                 "torque that repeats with the angle: cogging, gear mesh",
                 {{"A", "N m", "amplitude", 0.0, kLargestTorque, 0.0, kSmallTorque},
                  // Cogging and gear meshes have up to some hundred periods a turn; gear ratios make broken orders.
                  {"n", "1", "order of the angle", 0.1, 500.0, kShape, 1.0},
                  {"theta", "rad", "phase", -std::numbers::pi, std::numbers::pi, kShape, 0.0}},
                 {.harmonic = true}},
      "ripple", std::vector<std::string>{"A_Nm", "n", "theta_rad"}, [](const Magnitudes& m) {
        Points starts;
        // Orders of poles, slots and gears; an order between them is reached by the search where the angle stays small.
        for (const double n : {1., 2., 3., 4., 5., 6., 8., 10., 12., 16., 18., 20., 24., 30., 36., 48., 60., 72.})
          starts.push_back({FrictionTorque(m), n, 0.0});
        return starts;
      });
}

}  // namespace dynoproof::effects
