// Laws with play: values by hand, and what they promise over random parameters and motions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "tests/support/build.h"

namespace dynoproof {
namespace {

using testing::BuildLaw;

struct Numbers {
  double k = 15e3, c = 0.5, alpha = 0.095993, c_f = 0.1;
};

const std::vector<std::string> kUndamped = {"dead_zone", "revised_dead_zone", "phase_plane"};
const std::vector<std::string> kDamped = {"damped_dead_zone", "damped_revised_dead_zone", "damped_phase_plane"};
const std::vector<std::string> kAll = {"dead_zone",          "revised_dead_zone",        "phase_plane",
                                       "damped_dead_zone",   "damped_revised_dead_zone", "damped_phase_plane",
                                       "full_state_backlash"};
bool HasGapDamping(const std::string& law) { return law.starts_with("damped") || law.starts_with("full"); }

Value TableOf(const std::string& law, const Numbers& n) {
  Value table{{"law", law}, {"stiffness_Nm_per_rad", n.k}, {"damping_Nms_per_rad", n.c}, {"half_gap_rad", n.alpha}};
  if (HasGapDamping(law)) table["contact_free_damping_Nms_per_rad"] = Value(n.c_f);
  return table;
}

std::unique_ptr<Law> Make(const std::string& law, const Numbers& n) {
  std::string faults;
  std::unique_ptr<Law> made = BuildLaw(TableOf(law, n), &faults);
  EXPECT_NE(made, nullptr) << faults;
  return made;
}

/// A law with its mode and state, moved by hand.
struct Moved {
  const Law& law;
  int mode = 0;
  std::vector<double> states = std::vector<double>(law.layout().states.size(), 0.0);

  void Start(double twist, double rate) { law.Start(twist, rate, states, {&mode, 1}); }
  LawView At(double twist, double rate) const { return {0.0, twist, rate, 0.0, states, {&mode, 1}}; }
  double Torque(double twist, double rate) const { return law.Torque(At(twist, rate)); }
  double Guard(double twist, double rate) const {
    double guard = 0.0;
    law.Guards(At(twist, rate), {&guard, 1});
    return guard;
  }
  bool Event(double twist, double rate) {
    if (Guard(twist, rate) > 0.0) return false;
    int next = mode;
    std::vector<double> after = states;
    law.OnEvent(At(twist, rate), 0, after, {&next, 1});
    mode = next;
    states = after;
    return true;
  }
};

/// The torque of a law whose mode follows from twist and rate.
double PlaneTorque(const Law& law, double twist, double rate) {
  Moved moved{law};
  moved.Start(twist, rate);
  return moved.Torque(twist, rate);
}

Numbers RandomNumbers(std::uint64_t seed) {
  const auto decades = [seed](std::uint64_t stream, double low, double high) {
    return low * std::pow(high / low, RandomUniform(seed, stream, 0));
  };
  return {decades(0, 1e2, 1e6), decades(1, 1e-2, 1e2), decades(2, 1e-5, 0.2), decades(3, 1e-3, 1e1)};
}

/// A sum of five sines that crosses the gap, rates and twists together in a region where the law has something to do.
struct Course {
  explicit Course(std::uint64_t seed, const Numbers& n) {
    for (std::uint64_t i = 0; i < 5; ++i) {
      amplitude[i] = n.alpha * (0.2 + RandomUniform(seed, 10, i));
      nu[i] = n.k / (n.c + n.c_f) * std::pow(10.0, -1.0 - 2.0 * RandomUniform(seed, 11, i));
      phase[i] = 2.0 * std::numbers::pi * RandomUniform(seed, 12, i);
    }
    end_s = 40.0 / *std::max_element(nu, nu + 5);
  }
  double Twist(double t) const {
    double sum = 0.0;
    for (int i = 0; i < 5; ++i) sum += amplitude[i] * std::sin(nu[i] * t + phase[i]);
    return sum;
  }
  double Rate(double t) const {
    double sum = 0.0;
    for (int i = 0; i < 5; ++i) sum += amplitude[i] * nu[i] * std::cos(nu[i] * t + phase[i]);
    return sum;
  }
  double amplitude[5], nu[5], phase[5], end_s;
};

/// Walks a law along a course in `steps` steps with its events (and, with a state, by the midpoint rule).
template <class Visit>
void Walk(const Law& law, const Course& course, int steps, const Visit& visit) {
  Moved moved{law};
  moved.Start(course.Twist(0.0), course.Rate(0.0));
  const double dt = course.end_s / steps;
  for (int i = 0; i < steps; ++i) {
    const double t = i * dt, middle = t + 0.5 * dt;
    if (!moved.states.empty()) {
      double rate = 0.0;
      const double old = moved.states[0];
      law.Derivative(moved.At(course.Twist(t), course.Rate(t)), {&rate, 1});
      moved.states[0] = old + 0.5 * dt * rate;
      law.Derivative(moved.At(course.Twist(middle), course.Rate(middle)), {&rate, 1});
      moved.states[0] = old + dt * rate;
    }
    const double twist = course.Twist(t + dt), rate = course.Rate(t + dt);
    const bool event = moved.Event(twist, rate);
    visit(moved, twist, rate, dt, event);
  }
}

TEST(Backlash, ValuesByHand) {
  const Numbers n{1000.0, 2.0, 0.1, 0.5};
  EXPECT_DOUBLE_EQ(PlaneTorque(*Make("dead_zone", n), 0.15, 3.0), 56.0);
  EXPECT_EQ(PlaneTorque(*Make("dead_zone", n), 0.05, 3.0), 0.0);
  EXPECT_DOUBLE_EQ(PlaneTorque(*Make("dead_zone", n), 0.101, -3.0), -5.0);  // it pulls
  EXPECT_EQ(PlaneTorque(*Make("revised_dead_zone", n), 0.101, -3.0), 0.0);
  EXPECT_DOUBLE_EQ(PlaneTorque(*Make("damped_dead_zone", n), 0.05, 3.0), 1.5);
  // d - alpha + (c - c_f) w/k = -0.05 + 0.0045 < 0: free. At 0.097: 0.0015 > 0, touching.
  EXPECT_DOUBLE_EQ(PlaneTorque(*Make("damped_revised_dead_zone", n), 0.05, 3.0), 1.5);
  EXPECT_NEAR(PlaneTorque(*Make("damped_revised_dead_zone", n), 0.097, 3.0), -3.0 + 6.0, 1e-13);
  // p = 400/s, t = (0.05 + 0.1)/3 + 0.002 = 0.052 s.
  EXPECT_DOUBLE_EQ(PlaneTorque(*Make("damped_phase_plane", n), 0.05, 3.0), 1.5 * (1.0 - std::exp(-400.0 * 0.052)));
  // phi_b = d - 0.0015 + 2e-9 passes 0.1 at d = 0.1015.
  EXPECT_LT(PlaneTorque(*Make("damped_phase_plane", n), 0.1014, 3.0), 2.0);
  EXPECT_NEAR(PlaneTorque(*Make("damped_phase_plane", n), 0.1016, 3.0), 1.6 + 6.0, 1e-13);
}

TEST(Backlash, BadNumbersAreNamed) {
  struct Case {
    const char* law;
    Numbers numbers;
    const char* says;
  };
  const Case cases[] = {{"dead_zone", {15e3, 0.5, -0.1, 0.1}, "half_gap_rad"},
                        {"damped_phase_plane", {15e3, 0.5, -1e-9, 0.1}, "half_gap_rad"},
                        {"revised_dead_zone", {0.0, 0.5, 0.1, 0.1}, "stiffness_Nm_per_rad"},
                        {"phase_plane", {15e3, 0.0, 0.1, 0.1}, "divides by the damping c"},
                        {"damped_phase_plane", {15e3, 0.0, 0.1, 0.0}, "divides by c + c_f"},
                        {"full_state_backlash", {15e3, 0.0, 0.1, 0.0}, "divides by c + c_f"},
                        {"damped_dead_zone", {15e3, 0.5, 0.1, -0.1}, "contact_free_damping_Nms_per_rad"}};
  for (const Case& one : cases) {
    std::string faults;
    EXPECT_EQ(BuildLaw(TableOf(one.law, one.numbers), &faults), nullptr) << one.law;
    EXPECT_THAT(faults, ::testing::HasSubstr(one.says));
  }
  EXPECT_NE(BuildLaw(TableOf("dead_zone", {15e3, 0.0, 0.1, 0.0})), nullptr);
  EXPECT_NE(BuildLaw(TableOf("damped_phase_plane", {15e3, 0.0, 0.1, 0.1})), nullptr);
}

TEST(Backlash, FacesNeverPullButInTheDeadZone) {
  bool dead_zone_pulls = false;
  for (const std::string& name : kAll) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      const Numbers n = RandomNumbers(seed);
      const auto law = Make(name, n);
      const bool dead_zone = name.ends_with("dead_zone") && !name.ends_with("revised_dead_zone");
      double worst = 0.0;
      Walk(*law, Course(seed, n), 20000, [&](const Moved& moved, double twist, double rate, double dt, bool event) {
        if (moved.mode == 0 || event) return;
        // Between the faces: all of the torque but what the damping in the gap carries at w_b (0 while touching; w for
        // the revised dead zone, which does not know w_b).
        const double gap = name == "damped_revised_dead_zone" ? n.c_f * rate : 0.0;
        worst = std::min(worst, moved.mode * (moved.Torque(twist, rate) - gap));
        static_cast<void>(dt);
      });
      if (dead_zone) {
        dead_zone_pulls = dead_zone_pulls || worst < -1e-3;
      } else {
        // Margin of the events, 1e-12 rad, and round-off of twists up to 0.5 rad.
        EXPECT_GE(worst, -n.k * 1.1e-12) << name << " seed " << seed;
      }
    }
  }
  EXPECT_TRUE(dead_zone_pulls) << "the courses do not reach the region where the dead zone pulls";
}

TEST(Backlash, StoresLessThanItTakesAtEveryInstant) {
  for (const std::string& name : kAll) {
    if (name == "full_state_backlash") continue;  // its energy is in its state: next test
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      const Numbers n = RandomNumbers(seed);
      const auto law = Make(name, n);
      for (std::uint64_t i = 0; i < 500; ++i) {
        const double twist = n.alpha * 1.5 * RandomNormal(seed, 1, i);
        const double rate = n.k / (n.c + n.c_f) * n.alpha * RandomNormal(seed, 2, i);
        const double stretch = std::max(0.0, std::abs(twist) - n.alpha) * (twist > 0.0 ? 1.0 : -1.0);
        const double power = PlaneTorque(*law, twist, rate) * rate, stored = n.k * stretch * rate;
        ASSERT_GE(power, stored - 1e-12 * std::abs(stored))
            << name << " seed " << seed << " at " << twist << ", " << rate;
      }
    }
  }
}

TEST(Backlash, FullStateTakesUpEnergyOverAnyCourse) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Numbers n = RandomNumbers(seed);
    const auto law = Make("full_state_backlash", n);
    const Course course(seed, n);
    Moved at_start{*law};
    at_start.Start(course.Twist(0.0), course.Rate(0.0));
    const double wound = course.Twist(0.0) - at_start.states[0], start = 0.5 * n.k * wound * wound;
    double taken = 0.0, handled = start,
           before = at_start.Torque(course.Twist(0.0), course.Rate(0.0)) * course.Rate(0.0);
    Walk(*law, course, 40000, [&](const Moved& moved, double twist, double rate, double dt, bool) {
      const double power = moved.Torque(twist, rate) * rate;
      taken += 0.5 * dt * (power + before);
      handled += 0.5 * dt * (std::abs(power) + std::abs(before));
      before = power;
      const double stored = 0.5 * n.k * (twist - moved.states[0]) * (twist - moved.states[0]);
      // The trapezoidal rule, and contact that comes up to a step late.
      ASSERT_GE(taken, stored - start - 2e-3 * handled) << "seed " << seed;
    });
  }
}

TEST(Backlash, TorqueIsContinuousWhereTheLawSaysSo) {
  // Nowhere a jump: the revised dead zones. At the loss of contact no jump: phase planes and full state. At contact a
  // jump of c w_b: phase planes and full state; of c w (less c_f w) : dead zones.
  for (const std::string& name : kAll) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const Numbers n = RandomNumbers(seed);
      const auto law = Make(name, n);
      int made = 0, lost = 0;
      Moved last{*law};
      Walk(*law, Course(seed, n), 50000, [&](const Moved& moved, double twist, double rate, double, bool event) {
        if (event) {
          Moved old = moved;  // the same instant in the mode before
          const double after = moved.Torque(twist, rate);
          old.mode = last.mode;
          if (!old.states.empty()) old.states = moved.states;
          const double jump = after - old.Torque(twist, rate);
          const double course = std::abs(n.c * rate) * 2e-2 + std::abs(n.c_f * rate) * 2e-2 + n.k * 1e-9;
          const bool contact = moved.mode != 0;
          (contact ? made : lost) += 1;
          if (name.ends_with("revised_dead_zone") || (!contact && !name.ends_with("dead_zone"))) {
            // An event is met up to one step late: the torque has moved on by about (k + c nu) w dt.
            EXPECT_LT(std::abs(jump), course + (n.k * std::abs(rate)) * 3e-7 * 8e3) << name << " seed " << seed;
          }
        }
        last.mode = moved.mode;
      });
      EXPECT_GT(made + lost, 2) << name << " seed " << seed << ": the course meets no contact";
    }
  }
}

TEST(Backlash, OppositeMotionsGiveOppositeTorques) {
  for (const std::string& name : kAll) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const Numbers n = RandomNumbers(seed);
      const auto law = Make(name, n);
      Moved plus{*law}, minus{*law};
      const Course course(seed, n);
      plus.Start(course.Twist(0), course.Rate(0));
      minus.Start(-course.Twist(0), -course.Rate(0));
      for (int i = 1; i < 2000; ++i) {
        const double t = course.end_s * i / 2000;
        plus.Event(course.Twist(t), course.Rate(t));
        minus.Event(-course.Twist(t), -course.Rate(t));
        ASSERT_EQ(plus.mode, -minus.mode);
        ASSERT_EQ(plus.Torque(course.Twist(t), course.Rate(t)), -minus.Torque(-course.Twist(t), -course.Rate(t)));
      }
    }
  }
}

TEST(Backlash, WithoutGapDampingTheDampedLawsAreTheOthers) {
  for (std::size_t i = 0; i < kDamped.size(); ++i) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      Numbers n = RandomNumbers(seed);
      n.c_f = 0.0;
      const auto damped = Make(kDamped[i], n), plain = Make(kUndamped[i], n);
      n.c_f = 1e-9 * n.c;
      const auto nearly = Make(kDamped[i], n);
      for (std::uint64_t j = 0; j < 300; ++j) {
        const double twist = n.alpha * 1.5 * RandomNormal(seed, 1, j);
        const double rate = n.k / n.c * n.alpha * RandomNormal(seed, 2, j);
        const double expected = PlaneTorque(*plain, twist, rate);
        ASSERT_EQ(PlaneTorque(*damped, twist, rate), expected) << kDamped[i];
        ASSERT_NEAR(PlaneTorque(*nearly, twist, rate), expected, 1e-8 * n.c * std::abs(rate)) << kDamped[i];
      }
    }
  }
}

TEST(Backlash, WithoutPlayAllAreThePlainShaft) {
  for (const std::string& name : kAll) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Numbers n = RandomNumbers(seed);
      const Course course(seed, n);
      n.alpha = 0.0;
      const auto law = Make(name, n);
      Walk(*law, course, 2000, [&](const Moved& moved, double twist, double rate, double, bool event) {
        if (event) return;  // one step late
        const double expected = n.k * twist + n.c * rate;
        ASSERT_NEAR(moved.Torque(twist, rate), expected, 1e-12 * (n.k * std::abs(twist) + n.c * std::abs(rate)))
            << name << " seed " << seed;
      });
    }
  }
}

/// The areas of (3.13), computed from a simulated transit at constant rate instead of the closed form.
TEST(Backlash, ContactOfThePhasePlaneIsThatOfTheFullStateAtConstantRate) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Numbers n = RandomNumbers(seed);
    const auto full = Make("full_state_backlash", n), plane = Make("damped_phase_plane", n);
    const double p = n.k / (n.c + n.c_f), rate = p * n.alpha * (0.05 + RandomUniform(seed, 5, 0));
    Moved moved{*full};
    moved.states[0] = -n.alpha;
    double twist = -n.alpha - n.c / n.k * rate;  // contact is just lost at the left
    const double dt = 1e-4 / p;
    for (int i = 0; i < 10'000'000 && moved.mode == 0; ++i) {
      double speed = 0.0;
      const double old = moved.states[0];
      full->Derivative(moved.At(twist, rate), {&speed, 1});
      moved.states[0] = old + 0.5 * dt * speed;
      full->Derivative(moved.At(twist + 0.5 * dt * rate, rate), {&speed, 1});
      moved.states[0] = old + dt * speed;
      twist += dt * rate;
      if (i % 5000 == 2500) {
        ASSERT_NEAR(PlaneTorque(*plane, twist, rate), moved.Torque(twist, rate), 1e-5 * n.c_f * rate);
      }
      moved.Event(twist, rate);
    }
    ASSERT_EQ(moved.mode, 1);
    EXPECT_LT(PlaneTorque(*plane, twist - 2.0 * dt * rate, rate), n.c_f * rate);
    EXPECT_GT(PlaneTorque(*plane, twist + 2.0 * dt * rate, rate),
              n.k * (twist - n.alpha) + n.c * rate);  // touching: grows with k
  }
}

}  // namespace
}  // namespace dynoproof
