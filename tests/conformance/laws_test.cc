// What every law promises, asked of the whole registry with the examples of the READMEs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <vector>

#include "base/random.h"
#include "base/units.h"
#include "tests/support/build.h"
#include "tests/support/law_linearity.h"
#include "tests/support/readme_examples.h"

namespace dynoproof {
namespace {

using testing::BuildLaw;
using testing::BuiltIns;

// Sources of energy by purpose. All others must not make any.
const std::set<std::string> kActive = {"constant", "ripple"};
/// Laws that change as time goes by: a cycle that begins under load gives back what was stored then. Their energy is a
/// test of their own (Springs.AWarmingOneMakesNoEnergy).
const std::set<std::string> kChanging = {"warming_spring"};
// Laws that are not odd in (twist, rate) by purpose.
const std::set<std::string> kNotOdd = {"asymmetric", "constant", "ripple"};

void ForEachLaw(const std::function<void(const std::string&, const Law&)>& body) {
  static const testing::Examples examples = testing::ReadmeExamples();
  int count = 0;
  for (const PluginInfo* info : BuiltIns().Plugins()) {
    if (info->kind != "law") continue;
    SCOPED_TRACE("law." + info->name);
    const auto example = examples.find({"law", info->name});
    ASSERT_NE(example, examples.end()) << "its README has no example";
    std::string faults;
    const std::unique_ptr<Law> law = BuildLaw(example->second.table, &faults);
    ASSERT_NE(law, nullptr) << faults;
    body(info->name, *law);
    ++count;
  }
  EXPECT_GE(count, 10);
}

/// A law's states and modes while its two ends are moved as told.
struct Guided {
  const Law& law;
  std::vector<double> states = std::vector<double>(law.layout().states.size(), 0.0);
  std::vector<int> modes = std::vector<int>(static_cast<std::size_t>(law.layout().modes), 0);

  LawView ViewOf(double time, double twist, double rate, double holding) const {
    return {time, twist, rate, holding, states, modes};
  }
};

/// Twist, its rate and the rate's sign of change at an instant.
struct Moved {
  double twist, rate, acceleration;
};

/// A closed motion on a grid: a sum of five seeded sines of the base period, each point of the period once.
struct Motion {
  static constexpr int kSteps = 20000;
  static constexpr double kPeriod = 2.0, kStep = kPeriod / kSteps;

  Motion(std::uint64_t seed, double size) : points(kSteps) {
    for (std::uint64_t i = 0; i < 5; ++i) {
      const double amplitude = size * RandomUniform(seed, 0, i) / static_cast<double>(1 + i);
      const double phase = 2.0 * std::numbers::pi * RandomUniform(seed, 1, i);
      const double nu = 2.0 * std::numbers::pi * static_cast<double>(i + 1) / kPeriod;
      for (int k = 0; k < kSteps; ++k) {
        const double x = nu * k * kStep + phase;
        points[k].twist += amplitude * std::sin(x);
        points[k].rate += amplitude * nu * std::cos(x);
        points[k].acceleration -= amplitude * nu * nu * std::sin(x);
      }
    }
  }
  const Moved& At(int step) const { return points[step % kSteps]; }

  std::vector<Moved> points;
};

struct Work {
  double taken, handled;  // integral of T w and of |T w| over the last cycle
};

/// Moves the law through the cycle twice, so that its states are those of the cycle, and adds up its work in the
/// second.
Work WorkOfCycle(const Law& law, const Motion& motion) {
  constexpr double dt = Motion::kStep;
  Guided guided{law};
  law.Start(motion.At(0).twist, motion.At(0).rate, guided.states, guided.modes);
  const auto n = static_cast<std::size_t>(law.layout().guards);
  std::vector<double> before(n), after(n), k1(guided.states.size()), k2 = k1;
  Work work{0.0, 0.0};
  // Whoever moves the ends so holds against anything: the ends never wait for the law.
  const auto view = [&](int step) {
    const Moved& at = motion.At(step);
    return guided.ViewOf(step * dt, at.twist, at.rate, 1e9 * at.acceleration);
  };
  for (int step = 0; step < 2 * Motion::kSteps; ++step) {
    law.Guards(view(step), before);
    const double power_before = law.Torque(view(step)) * motion.At(step).rate;
    law.Derivative(view(step), k1);  // Heun's method
    const std::vector<double> old = guided.states;
    for (std::size_t i = 0; i < old.size(); ++i) guided.states[i] = old[i] + dt * k1[i];
    law.Derivative(view(step + 1), k2);
    for (std::size_t i = 0; i < old.size(); ++i) guided.states[i] = old[i] + 0.5 * dt * (k1[i] + k2[i]);
    const double power_after = law.Torque(view(step + 1)) * motion.At(step + 1).rate;
    law.Guards(view(step + 1), after);
    for (std::size_t g = 0; g < n; ++g) {
      if ((before[g] >= 0.0) != (after[g] >= 0.0)) {
        law.OnEvent(view(step + 1), static_cast<int>(g), guided.states, guided.modes);
      }
    }
    if (step < Motion::kSteps) continue;
    work.taken += 0.5 * dt * (power_before + power_after);
    work.handled += 0.5 * dt * (std::abs(power_before) + std::abs(power_after));
  }
  return work;
}

TEST(Laws, DeclareTheirStates) {
  ForEachLaw([](const std::string&, const Law& law) {
    EXPECT_TRUE(law.layout().inputs.empty());
    EXPECT_TRUE(law.layout().outputs.empty());
    for (const Port& port : law.layout().states) {
      EXPECT_TRUE(ParseUnit(port.unit)) << port.name;
      EXPECT_FALSE(port.description.empty());
      EXPECT_GT(port.nominal, 0.0);
    }
  });
}

TEST(Laws, MakeNoEnergyInClosedCycles) {
  ForEachLaw([](const std::string& name, const Law& law) {
    if (kActive.contains(name) || kChanging.contains(name)) return;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      const double size = std::pow(10.0, -static_cast<double>(seed % 4));  // 1 mrad ... 1 rad
      const Work work = WorkOfCycle(law, Motion(seed, size));
      // The trapezoidal rule is nearly exact on smooth periodic powers; at each of up to ten reversals a cycle a law
      // with a kink errs by at most its torque times the way of one step, 1e-4 of the period: 1e-6 of the energy.
      EXPECT_GE(work.taken, -1e-6 * work.handled) << "seed " << seed;
      EXPECT_GT(work.handled, 0.0) << "seed " << seed << ": the motion did not touch the law";
    }
  });
}

TEST(Laws, ActiveLawsCanDrive) {
  // The other side of the list above: what is excused from the energy test must really push on its own.
  ForEachLaw([](const std::string& name, const Law& law) {
    if (!kActive.contains(name)) return;
    bool drives = false;
    for (double angle = 0.0; angle < 6.3; angle += 0.01) {
      for (const double rate : {-1.0, 1.0}) drives = drives || law.Torque({0.0, angle, rate, 0.0, {}, {}}) * rate < 0.0;
    }
    EXPECT_TRUE(drives);
  });
}

TEST(Laws, OddLawsAreOdd) {
  ForEachLaw([](const std::string& name, const Law& law) {
    if (kNotOdd.contains(name)) return;
    for (std::uint64_t i = 0; i < 200; ++i) {
      const double twist = 0.01 * RandomNormal(3, 0, i), rate = RandomNormal(3, 1, i), holding = RandomNormal(3, 2, i);
      Guided plus{law}, minus{law};
      law.Start(twist, rate, plus.states, plus.modes);
      law.Start(-twist, -rate, minus.states, minus.modes);
      for (std::size_t s = 0; s < plus.states.size(); ++s) {
        const double shift = 0.1 * RandomNormal(3, 3 + s, i);
        plus.states[s] += shift;
        minus.states[s] -= shift;
      }
      ASSERT_EQ(law.Torque(plus.ViewOf(0.0, twist, rate, holding)),
                -law.Torque(minus.ViewOf(0.0, -twist, -rate, -holding)));
    }
  });
}

TEST(Laws, LinearPartIsTheSlopeOfTheTorque) {
  ForEachLaw([](const std::string&, const Law& law) {
    const SpringDamper linear = law.linear();
    EXPECT_GE(linear.stiffness, 0.0);
    EXPECT_GE(linear.damping, 0.0);
    if (linear.stiffness == 0.0 && linear.damping == 0.0) return;
    Guided at_rest{law};
    law.Start(0.0, 0.0, at_rest.states, at_rest.modes);
    // A power of two as step: differences of a linear law are exact but for one rounding, a cubic part adds
    // k3 h^2 / k < 1e-9 for the example's k3 = 1e9, k = 6e6.
    const double h = 0x1p-20;
    const double k = (law.Torque(at_rest.ViewOf(0, h, 0, 0)) - law.Torque(at_rest.ViewOf(0, -h, 0, 0))) / (2 * h);
    const double c = (law.Torque(at_rest.ViewOf(0, 0, h, 0)) - law.Torque(at_rest.ViewOf(0, 0, -h, 0))) / (2 * h);
    EXPECT_NEAR(k, linear.stiffness, 1e-9 * linear.stiffness);
    EXPECT_NEAR(c, linear.damping, 1e-9 * linear.damping);
  });
}

TEST(Laws, DeclareThatTheyAreLinear) {
  // Too much would give wrong results, too little slow ones.
  ForEachLaw([](const std::string&, const Law& law) {
    const std::string bend = testing::WhereItBends(law);
    EXPECT_EQ(law.is_linear(), bend.empty()) << bend;
  });
}

TEST(Laws, WithoutTheirNonlinearPartAreLinear) {
  const std::vector<Value> tables = {
      Value{{"law", "cubic_spring"}, {"stiffness_Nm_per_rad", 2e5}, {"k3_Nm_per_rad3", 0.0}},
      Value{{"law", "warming_spring"}, {"stiffness_Nm_per_rad", 2e5}, {"loss", 0.0}, {"loss_time_s", 3.0}},
      Value{{"law", "kelvin_voigt"}, {"stiffness_Nm_per_rad", 2e5}, {"damping_Nms_per_rad", 6.0}, {"drift", 0.0}},
      Value{{"law", "quadratic_drag"}, {"b2_Nms2_per_rad2", 0.0}},
      Value{{"law", "constant"}, {"T_0_Nm", 0.0}},
      Value{{"law", "ripple"}, {"A_Nm", 0.0}, {"n", 6.0}},
  };
  for (const Value& table : tables) {
    SCOPED_TRACE(table.Find("law")->string());
    std::string faults;
    const std::unique_ptr<Law> law = BuildLaw(table, &faults);
    ASSERT_NE(law, nullptr) << faults;
    EXPECT_TRUE(law->is_linear());
    EXPECT_EQ(testing::WhereItBends(*law), "");
  }
}

/// Says that it is linear and bends somewhere.
class Bent : public Law {
 public:
  enum class Where { kBeyondTwist, kBelowTwist, kBeyondRate, kBelowRate, kLater, kBeyondState };
  explicit Bent(Where where) : where_(where) {
    if (where == Where::kBeyondState) layout_.states = {{"z", "Pa", "pressure", 1e5}};
  }
  SpringDamper linear() const override { return {2e5, 6.0}; }
  bool is_linear() const override { return true; }
  double Torque(const LawView& view) const override {
    double d = view.twist, w = view.rate, z = view.states.empty() ? 0.0 : view.states[0];
    if (where_ == Where::kBeyondTwist) d = std::clamp(d, -30.0, 30.0);
    if (where_ == Where::kBelowTwist && std::abs(d) < 1e-6) d = 0.0;
    if (where_ == Where::kBeyondRate) w = std::clamp(w, -3e3, 3e3);
    if (where_ == Where::kBelowRate && std::abs(w) < 1e-7) w = 0.0;
    if (where_ == Where::kLater && view.time_s > 3e3) w = 0.9 * w;
    return 2e5 * d + 6.0 * w + 1e-3 * std::min(z, 3e9);
  }
  void Derivative(const LawView& view, std::span<double> rates) const override {
    if (!rates.empty()) rates[0] = view.rate - 10.0 * view.states[0];
  }

 private:
  Where where_;
};

TEST(Laws, ThatBendAnywhereAreFound) {
  using Where = Bent::Where;
  for (const Where where : {Where::kBeyondTwist, Where::kBelowTwist, Where::kBeyondRate, Where::kBelowRate,
                            Where::kLater, Where::kBeyondState}) {
    EXPECT_NE(testing::WhereItBends(Bent(where)), "") << static_cast<int>(where);
  }
}

/// A spring to which the root of a number is added, which may be none; it says that it is a spring alone, or not.
template <bool kLinear>
class Stuck : public Law {
 public:
  struct Params {
    double torque_Nm = 0.0;
    void Visit(auto& v) { v.Required("torque_Nm", torque_Nm, Any("N m"), "its root is added"); }
  };
  static PluginInfo Info() { return {"law", kLinear ? "stuck_linear" : "stuck", "", "", "", {}}; }
  explicit Stuck(const Params& params) : torque_(params.torque_Nm) {}
  SpringDamper linear() const override { return {1e4, 0.0}; }
  bool is_linear() const override { return kLinear; }
  double Torque(const LawView& view) const override { return std::sqrt(torque_) + 1e4 * view.twist; }

 private:
  double torque_;
};

TEST(Laws, ThatGiveNoNumberOrAnotherThanTheySayAreRefusedByName) {
  Registry registry;
  RegisterBuiltIns(registry);
  registry.Add<Stuck<true>>();
  registry.Add<Stuck<false>>();
  const auto faults = [&](const char* law, double torque_Nm) {
    const Value table{
        {"type", "drive_line"},
        {"inertia", Value{{"I1", 2.0}, {"I2", 0.5}}},
        {"shaft", Value{{"k1", Value{{"between", Value::Array{"I1", "I2"}}, {"law", law}, {"torque_Nm", torque_Nm}}}}}};
    Diagnostics diagnostics;
    BuildContext context{registry, diagnostics, "plant", {}};
    const bool refused = registry.MakeComponent("plant", table, context) == nullptr;
    EXPECT_EQ(refused, diagnostics.has_errors());
    return diagnostics.Format();
  };
  EXPECT_EQ(faults("stuck_linear", 0.0), "");
  EXPECT_EQ(faults("stuck", 0.0), "");
  EXPECT_EQ(faults("stuck", 1.0), "") << "it does not say that it is linear";
  using ::testing::HasSubstr;
  EXPECT_THAT(faults("stuck_linear", 1.0), HasSubstr("law \"stuck_linear\" of \"k1\" gives a torque of 1 at"));
  EXPECT_THAT(faults("stuck_linear", -1.0), HasSubstr("law \"stuck_linear\" of \"k1\" gives a torque of"));
  EXPECT_THAT(faults("stuck", -1.0), HasSubstr("law \"stuck\" of \"k1\" gives a torque of"));
}

TEST(Laws, WithNumbersThatCannotBeComputedWithAreRefusedByName) {
  const auto faults = [](double inertia, double stiffness, double damping) {
    const Value shaft{
        {"between", Value::Array{"I1", "I2"}}, {"stiffness_Nm_per_rad", stiffness}, {"damping_Nms_per_rad", damping}};
    const Value table{
        {"type", "drive_line"}, {"inertia", Value{{"I1", inertia}, {"I2", 0.5}}}, {"shaft", Value{{"k1", shaft}}}};
    std::string said;
    testing::Build("plant", table, {}, &said);
    return said;
  };
  EXPECT_EQ(faults(2.0, 1e5, 3.0), "");
  EXPECT_EQ(faults(1e-9, 1e12, 1e6), "") << "odd, but no trouble";
  EXPECT_NE(faults(1e-310, 1e5, 3.0).find("\"I1\" has an inertia of 1e-310 kg m^2, too small"), std::string::npos);
  EXPECT_NE(faults(2.0, 1e308, 3.0).find("\"k1\" has a stiffness too large"), std::string::npos);
  EXPECT_NE(faults(2.0, 1e5, 1e308).find("\"k1\" has a damping too large"), std::string::npos);
}

TEST(Laws, GuardsAndTorqueAreContinuousWithinAMode) {
  ForEachLaw([](const std::string&, const Law& law) {
    Guided guided{law};
    const auto n = static_cast<std::size_t>(law.layout().guards);
    std::vector<double> before(n), after(n);
    for (const double start_rate : {-1.0, 0.0, 1.0}) {
      law.Start(0.0, start_rate, guided.states, guided.modes);
      for (int i = 0; i < 4000; ++i) {
        const double x = (i - 2000) * 1e-3, h = 1e-9;  // all arguments move together through zero
        const LawView here = guided.ViewOf(0.0, 0.01 * x, x, x),
                      there = guided.ViewOf(0.0, 0.01 * (x + h), x + h, x + h);
        law.Guards(here, before);
        law.Guards(there, after);
        // Over 1e-9 a continuous function moves by 1e-9 times its slope. Slopes are below 1e6 (stiffest shaft of the
        // examples: 6e6 N m/rad on 0.01 x), jumps of the examples above 0.1.
        for (std::size_t g = 0; g < n; ++g) ASSERT_LT(std::abs(after[g] - before[g]), 1e-2);
        ASSERT_LT(std::abs(law.Torque(there) - law.Torque(here)), 1e-2) << "at " << x;
      }
    }
  });
}

TEST(Laws, ThatStickSlipAgainstTheMotion) {
  int count = 0;
  ForEachLaw([&count](const std::string&, const Law& law) {
    if (!law.sticks()) return;
    ++count;
    Guided guided{law};
    for (const double rate : {0.0, 1e-3, 0.4, 20.0}) {
      for (const int sign : {-1, 1}) {
        const LawView view = guided.ViewOf(0.0, 0.0, sign * rate, 0.0);
        EXPECT_GT(law.SlipTorque(view, sign) * sign, 0.0) << rate;
      }
    }
  });
  EXPECT_GE(count, 3);
}

}  // namespace
}  // namespace dynoproof
