// Laws: values by hand, stick and slip, limit cases.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/build.h"

namespace dynoproof {
namespace {

using testing::BuildLaw;

/// The torque of a law without states in a mode (ignored by laws that have none).
double TorqueOf(const Law& law, double twist, double rate, double holding = 0.0, int mode = 0) {
  return law.Torque({0.0, twist, rate, holding, {}, {&mode, 1}});
}

double GuardOf(const Law& law, double rate, double holding, int mode) {
  double guard = 0.0;
  law.Guards({0.0, 0.0, rate, holding, {}, {&mode, 1}}, {&guard, 1});
  return guard;
}

int AfterEvent(const Law& law, double rate, double holding, int mode) {
  int next = mode;
  law.OnEvent({0.0, 0.0, rate, holding, {}, {&mode, 1}}, 0, {}, {&next, 1});
  return next;
}

const Value kCoulomb = {{"law", "coulomb"}, {"T_c_Nm", 2.0}};
const Value kAsymmetric = {{"law", "asymmetric"},
                           {"T_c_pos_Nm", 2.0},
                           {"T_c_neg_Nm", 3.0},
                           {"b_pos_Nms_per_rad", 0.5},
                           {"b_neg_Nms_per_rad", 0.25}};
const Value kStribeck = {{"law", "stribeck"}, {"T_c_Nm", 2.0}, {"T_s_Nm", 5.0}, {"w_s_rad_per_s", 0.1}};

TEST(Springs, ValuesByHand) {
  const auto spring = BuildLaw({{"stiffness_Nm_per_rad", 100.0}, {"damping_Nms_per_rad", 2.0}});
  ASSERT_NE(spring, nullptr);
  EXPECT_EQ(TorqueOf(*spring, 0.5, -3.0), 44.0);
  const auto cubic = BuildLaw({{"law", "cubic_spring"}, {"stiffness_Nm_per_rad", 100.0}, {"k3_Nm_per_rad3", -8.0}});
  ASSERT_NE(cubic, nullptr);
  EXPECT_EQ(TorqueOf(*cubic, 0.5, 7.0), 49.0);
  EXPECT_EQ(cubic->linear().stiffness, 100.0);
}

TEST(Springs, AWarmingOneLosesItsShareOfStiffness) {
  const auto spring = BuildLaw({{"law", "warming_spring"},
                                {"stiffness_Nm_per_rad", 100.0},
                                {"damping_Nms_per_rad", 2.0},
                                {"loss", 0.25},
                                {"loss_time_s", 3.0}});
  ASSERT_NE(spring, nullptr);
  EXPECT_EQ(TorqueOf(*spring, 0.5, 1.0), 52.0);
  EXPECT_NEAR(spring->Torque({3.0, 0.5, 1.0, 0.0, {}, {}}), 2.0 + 50.0 * (1.0 - 0.25 * (1.0 - std::exp(-1.0))), 1e-12);
  EXPECT_NEAR(spring->Torque({1e6, 0.5, 1.0, 0.0, {}, {}}), 2.0 + 37.5, 1e-12);
}

TEST(Springs, AWarmingOneMakesNoEnergy) {
  // From no twist to no twist: what is put in while it is stiff does not all come back.
  const auto spring =
      BuildLaw({{"law", "warming_spring"}, {"stiffness_Nm_per_rad", 100.0}, {"loss", 0.5}, {"loss_time_s", 1.0}});
  ASSERT_NE(spring, nullptr);
  constexpr double kStep = 1e-4;
  double taken = 0.0, lost = 0.0;
  for (double t = 0.5 * kStep; t < std::numbers::pi; t += kStep) {
    taken += kStep * std::cos(t) * spring->Torque({t, std::sin(t), std::cos(t), 0.0, {}, {}});
    lost += kStep * 0.5 * 50.0 * std::exp(-t) * std::sin(t) * std::sin(t);  // -1/2 dk/dt d^2
  }
  EXPECT_GT(taken, 1.0);
  EXPECT_NEAR(taken, lost, 1e-3 * lost);
}

TEST(Springs, NeedSomethingThatConnects) {
  std::string faults;
  EXPECT_EQ(BuildLaw({{"between", "I1"}}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("nothing connects"));
}

TEST(DryFriction, StartsInTheModeOfTheRate) {
  const auto law = BuildLaw(kCoulomb);
  for (const double rate : {-0.5, 0.0, 0.5}) {
    int mode = 7;
    law->Start(0.0, rate, {}, {&mode, 1});
    EXPECT_EQ(mode, rate > 0 ? 1 : rate < 0 ? -1 : 0);
  }
}

// A stick bears its limit and 1e-12 of it.
constexpr double kRoundOff = 1e-11;

TEST(DryFriction, StickHoldsUpToTheLimit) {
  const auto law = BuildLaw(kAsymmetric);
  EXPECT_EQ(TorqueOf(*law, 0.0, 0.0, 1.5), 1.5);
  EXPECT_EQ(TorqueOf(*law, 0.0, 0.0, -2.9), -2.9);
  EXPECT_EQ(TorqueOf(*law, 0.0, 0.0, 2.5), 2.0);
  EXPECT_EQ(TorqueOf(*law, 0.0, 0.0, -9.0), -3.0);
  EXPECT_NEAR(GuardOf(*law, 0.0, 1.5, 0), 0.5, kRoundOff);
  EXPECT_NEAR(GuardOf(*law, 0.0, -2.0, 0), 1.0, kRoundOff);
  EXPECT_LT(GuardOf(*law, 0.0, 2.1, 0), 0.0);
  EXPECT_EQ(AfterEvent(*law, 0.0, 2.0, 0), 1);
  EXPECT_EQ(AfterEvent(*law, 0.0, -3.0, 0), -1);
}

TEST(DryFriction, SlipEndsInStickOrGoesThrough) {
  const auto law = BuildLaw(kCoulomb);
  EXPECT_EQ(GuardOf(*law, 0.3, 0.0, 1), 0.3);
  EXPECT_EQ(GuardOf(*law, -0.3, 0.0, -1), 0.3);
  EXPECT_LT(GuardOf(*law, -1e-9, 0.0, 1), 0.0);
  EXPECT_EQ(AfterEvent(*law, 0.0, 1.9, 1), 0);
  EXPECT_EQ(AfterEvent(*law, 0.0, -1.9, 1), 0);
  EXPECT_EQ(AfterEvent(*law, 0.0, -2.1, 1), -1);
  EXPECT_EQ(AfterEvent(*law, 0.0, 2.1, -1), 1);
}

TEST(DryFriction, StribeckFallsFromStaticToSliding) {
  const auto law = BuildLaw(kStribeck);
  const double rates[] = {0.0, 0.1, 10.0}, torques[] = {5.0, 2.0 + 3.0 * std::exp(-1.0), 2.0};
  for (int i = 0; i < 3; ++i) {
    for (const int sign : {-1, 1}) {
      EXPECT_DOUBLE_EQ(TorqueOf(*law, 0.0, sign * rates[i], 0.0, sign), sign * torques[i]);
      EXPECT_DOUBLE_EQ(law->SlipTorque({0.0, 0.0, sign * rates[i], 0.0, {}, {}}, sign), sign * torques[i]);
    }
  }
  EXPECT_NEAR(GuardOf(*law, 0.0, 4.0, 0), 1.0, kRoundOff);  // it sticks up to T_s, not T_c
}

TEST(DryFriction, AsymmetricHasItsOwnNumbersEachWay) {
  const auto law = BuildLaw(kAsymmetric);
  EXPECT_EQ(TorqueOf(*law, 0.0, 4.0, 0.0, 1), 4.0);
  EXPECT_EQ(TorqueOf(*law, 0.0, -4.0, 0.0, -1), -4.0);
  EXPECT_EQ(law->SlipTorque({0.0, 0.0, 2.0, 0.0, {}, {}}, 1), 3.0);
  EXPECT_EQ(law->SlipTorque({0.0, 0.0, -2.0, 0.0, {}, {}}, -1), -3.5);
}

/// A block of inertia I under torque T0 cos(nu t) and Coulomb friction, by small steps with the law's own events.
TEST(DryFriction, ABlockComesToRestWhereEnergySays) {
  const auto law = BuildLaw(kCoulomb);
  // Start at 3 rad/s, I = 0.5: friction 2 N m stops it after w^2 I / (2 T_c) = 1.125 rad.
  const double inertia = 0.5, dt = 1e-5;
  double angle = 0.0, speed = 3.0;
  int mode = 0;
  law->Start(angle, speed, {}, {&mode, 1});
  for (int i = 0; i < 200000; ++i) {
    const double next = speed - dt * TorqueOf(*law, angle, speed, 0.0, mode) / inertia;
    angle += 0.5 * dt * (speed + next);
    const bool event = GuardOf(*law, next, 0.0, mode) < 0.0;
    speed = next;
    if (event) mode = AfterEvent(*law, speed, 0.0, mode);
  }
  EXPECT_EQ(mode, 0);
  // The motion is exactly quadratic; the event comes up to one step late, when the speed is at most dt T_c/I = 4e-5
  // rad/s beyond zero and then kept for 1.25 s.
  EXPECT_NEAR(angle, 1.125, 6e-5);
}

/// The stretch after `travel` at `rate` from the stretch d, by the midpoint rule.
double Stretched(const Law& law, double d, double rate, double travel, double step) {
  const auto slope = [&](double at) {
    double change = 0.0;
    law.Derivative({0.0, 0.0, rate, 0.0, {&at, 1}, {}}, {&change, 1});
    return change / std::abs(rate);
  };
  for (double s = 0.0; s < travel - 0.5 * step; s += step) d += step * slope(d + 0.5 * step * slope(d));
  return d;
}

TEST(Dahl, IsASpringFirstAndCoulombLater) {
  const double F_c = 2.0, sigma = 100.0, step = 1e-6;
  const auto law = BuildLaw({{"law", "dahl"}, {"F_c_Nm", F_c}, {"sigma_Nm_per_rad", sigma}});
  ASSERT_NE(law, nullptr);
  double d = 0.0;
  for (int i = 1; i <= 10; ++i) {
    d = Stretched(*law, d, 1.0, 0.02, step);
    // Exact for motion one way: F = F_c (1 - exp(-sigma phi / F_c)). The midpoint rule errs by (sigma step / F_c)^2 / 6
    // = 4e-10 of F_c.
    const double exact = F_c * (1.0 - std::exp(-sigma * 0.02 * i / F_c));
    EXPECT_NEAR(law->Torque({0.0, 0.0, 1.0, 0.0, {&d, 1}, {}}), exact, 1e-9 * F_c);
  }
  EXPECT_NEAR(law->Torque({0.0, 0.0, 1.0, 0.0, {&d, 1}, {}}), F_c, 1e-4 * F_c);  // exp(-10) = 4.5e-5
}

TEST(Dahl, WithoutFrictionTorqueStaysAtZero) {
  const auto law = BuildLaw({{"law", "dahl"}, {"F_c_Nm", 0.0}, {"sigma_Nm_per_rad", 100.0}});
  double d = 0.0, rate = 1.0;
  law->Derivative({0.0, 0.0, 5.0, 0.0, {&d, 1}, {}}, {&rate, 1});
  EXPECT_EQ(rate, 0.0);
}

TEST(Dahl, PassesTheGapAfterEachTurn) {
  const double F_c = 2.0, sigma = 100.0, a = 0.01, step = 1e-6;
  const auto law = BuildLaw({{"law", "dahl"}, {"F_c_Nm", F_c}, {"sigma_Nm_per_rad", sigma}, {"half_gap_rad", a}});
  ASSERT_NE(law, nullptr);
  const auto torque = [&](double d) { return law->Torque({0.0, 0.0, 1.0, 0.0, {&d, 1}, {}}); };
  double d = Stretched(*law, 0.0, 3.0, a, step);
  EXPECT_NEAR(d, a, 1e-12);
  EXPECT_NEAR(torque(d), 0.0, 1e-9);
  d = Stretched(*law, d, 3.0, 0.03, step);
  EXPECT_NEAR(torque(d), F_c * (1.0 - std::exp(-sigma * 0.03 / F_c)), 1e-9 * F_c);
  // Back: 1 + F/F_c falls as exp(-sigma s / F_c) until F = 0, then the whole gap passes, then F = -F_c (1 - exp()).
  const double unloading = F_c / sigma * std::log(1.0 + torque(d) / F_c);
  d = Stretched(*law, d, -3.0, unloading + a, step);
  EXPECT_NEAR(d, 0.0, 2.0 * step);  // the kink lies within a step
  d = Stretched(*law, d, -3.0, a + 0.01, step);
  EXPECT_NEAR(torque(d), -F_c * (1.0 - std::exp(-sigma * 0.01 / F_c)), 2.0 * sigma * step);
}

TEST(Loads, ValuesByHand) {
  EXPECT_EQ(TorqueOf(*BuildLaw({{"law", "viscous"}, {"b_Nms_per_rad", 0.5}}), 0.0, -4.0), -2.0);
  EXPECT_EQ(TorqueOf(*BuildLaw({{"law", "quadratic_drag"}, {"b2_Nms2_per_rad2", 0.5}}), 0.0, -4.0), -8.0);
  EXPECT_EQ(TorqueOf(*BuildLaw({{"law", "constant"}, {"T_0_Nm", 7.0}}), 3.0, -4.0), 7.0);
  // A sin(n phi + theta) is added on the node: the transmitted torque is its negative.
  EXPECT_DOUBLE_EQ(TorqueOf(*BuildLaw({{"law", "ripple"}, {"A_Nm", 3.0}, {"n", 4.0}, {"theta_rad", 0.5}}), 0.1, 9.0),
                   -3.0 * std::sin(0.9));
}

TEST(Loads, ReportWhatIsOutOfRange) {
  std::string faults;
  EXPECT_EQ(BuildLaw({{"law", "coulomb"}, {"T_c_Nm", -1.0}}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("\"T_c_Nm\""));
  EXPECT_EQ(BuildLaw({{"law", "coulumb"}, {"T_c_Nm", 1.0}}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("did you mean \"coulomb\"?"));
}

}  // namespace
}  // namespace dynoproof
