// The laws of hydrodynamic couplings, their effects, the speed control and the single-cylinder engine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "tests/support/build.h"
#include "tests/support/plan_builder.h"

namespace dynoproof {
namespace {

using std::numbers::pi;
using testing::BuildLaw;
using testing::BuiltIns;
using ::testing::HasSubstr;

const Value kOil = {{"law", "oil_coupling"},
                    {"stiffness_Nm_per_rad", 78e3},
                    {"k_p_m3", 0.07},
                    {"kappa_p_per_s", 190.0},
                    {"kappa_w_Pa_per_rad", 2.2e6}};
Value KelvinVoigt(double drift = 0.0) {
  return {{"law", "kelvin_voigt"},
          {"stiffness_Nm_per_rad", 94e3},
          {"damping_Nms_per_rad", 618.0},
          {"drift", drift},
          {"drift_time_s", 2.0}};
}

TEST(KelvinVoigtLaw, IsASpringAndDamper) {
  const auto law = BuildLaw(KelvinVoigt());
  EXPECT_EQ(law->Torque({7.0, 0.01, -0.5, 0.0, {}, {}}), 94e3 * 0.01 - 618.0 * 0.5);
  EXPECT_EQ(law->linear().stiffness, 94e3);
  EXPECT_EQ(law->linear().damping, 618.0);
}

TEST(KelvinVoigtLaw, LosesDampingAsTheOilWarmsUp) {
  const auto law = BuildLaw(KelvinVoigt(0.4));
  for (const double t : {0.0, 0.5, 2.0, 10.0}) {
    const double c = 618.0 * (1.0 - 0.4 * (1.0 - std::exp(-t / 2.0)));
    EXPECT_NEAR(law->Torque({t, 0.01, 3.0, 0.0, {}, {}}), 940.0 + 3.0 * c, 1e-9);
  }
}

/// The power a coupling takes up is the rise of its stored energy plus a loss that is never negative, at every state.
TEST(OilCouplingLaw, IsPassiveAtEveryState) {
  const auto law = BuildLaw(kOil);
  const double k_s = 78e3, k_p = 0.07, kappa_p = 190.0, kappa_w = 2.2e6;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const double d = 0.02 * RandomNormal(1, 0, i), w = 2.0 * RandomNormal(1, 1, i), p = 4e4 * RandomNormal(1, 2, i);
    const LawView view{0.0, d, w, 0.0, {&p, 1}, {}};
    double rate = 0.0;
    law->Derivative(view, {&rate, 1});
    const double stored = k_s * d * w + k_p / kappa_w * p * rate, lost = k_p * kappa_p / kappa_w * p * p;
    // Round-off: four products of at most 1e5 each.
    EXPECT_NEAR(law->Torque(view) * w, stored + lost, 1e-9);
    EXPECT_GE(lost, 0.0);
  }
}

TEST(OilCouplingLaw, StepOfTheRateIsTheClosedSolution) {
  // w = const: Dp = kappa_w / kappa_p w (1 - exp(-kappa_p t)). Carried by the exact step of a linear law between
  // samples, so that only round-off is left.
  const auto law = BuildLaw(kOil);
  const double w = 0.3, step = 1e-4;
  double at_zero = 0.0, at_one = 0.0, p = 0.0;
  const double zero = 0.0, one = 1.0;
  law->Derivative({0.0, 0.0, w, 0.0, {&zero, 1}, {}}, {&at_zero, 1});
  law->Derivative({0.0, 0.0, w, 0.0, {&one, 1}, {}}, {&at_one, 1});
  const double decay = at_zero - at_one;
  for (int i = 1; i <= 1000; ++i) {
    p += (at_zero / decay - p) * -std::expm1(-decay * step);
    const double t = i * step, expected = 2.2e6 / 190.0 * w * -std::expm1(-190.0 * t);
    ASSERT_NEAR(p, expected, 1e-12 * 2.2e6 / 190.0 * w) << t;
    ASSERT_NEAR(law->Torque({t, w * t, w, 0.0, {&p, 1}, {}}), 78e3 * w * t + 0.07 * expected, 1e-9);
  }
}

TEST(OilCouplingLaw, SteadySineSeesTheDynamicValues) {
  // (4.21) by the law's own differential equation: the particular solution of a sine put into Derivative and Torque.
  const auto law = BuildLaw(kOil);
  for (const double nu : {1.0, 20.0, 73.3, 190.0, 2000.0}) {
    const double K = 0.07 * 2.2e6, sum = nu * nu + 190.0 * 190.0;
    const double k = 78e3 + K * nu * nu / sum, c = K * 190.0 / sum;
    for (double t = 0.0; t < 0.1; t += 0.013) {
      const double d = 0.01 * std::sin(nu * t), w = 0.01 * nu * std::cos(nu * t);
      const double p = (k * d + c * w - 78e3 * d) / 0.07;
      double rate = 0.0;
      law->Derivative({t, d, w, 0.0, {&p, 1}, {}}, {&rate, 1});
      const double expected = ((k - 78e3) * w - c * nu * nu * d) / 0.07;
      EXPECT_NEAR(rate, expected, 1e-9 * 2.2e6 * 0.01 * nu);
      EXPECT_NEAR(law->Torque({t, d, w, 0.0, {&p, 1}, {}}), k * d + c * w, 1e-9 * 78e3);
    }
  }
}

TEST(OilCouplingLaw, FromGeometryWarns) {
  Value table = {{"law", "oil_coupling_geometry"},
                 {"stiffness_Nm_per_rad", 78e3},
                 {"segments", 12},
                 {"width_m", 0.125},
                 {"length_m", 0.08},
                 {"inner_radius_m", 0.11},
                 {"chamber_volume_m3", 3e-4},
                 {"gap_height_m", 1.6e-3},
                 {"gap_length_m", 0.03},
                 {"bulk_modulus_Pa", 1e6},
                 {"largest_twist_rad", 0.015},
                 {"largest_rate_rad_per_s", 0.1}};
  std::string faults;
  const auto law = BuildLaw(table, &faults);
  ASSERT_NE(law, nullptr) << faults;
  EXPECT_EQ(faults, "");
  const double p = 1e4;
  EXPECT_NEAR(law->Torque({0.0, 0.0, 0.0, 0.0, {&p, 1}, {}}), 0.018 * p, 1e-9);
  table["largest_twist_rad"] = Value(0.05);
  EXPECT_NE(BuildLaw(table, &faults), nullptr);
  EXPECT_THAT(faults, HasSubstr("warning"));
  EXPECT_THAT(faults, HasSubstr("of its volume"));
  table["gap_height_m"] = Value(0.2);
  EXPECT_EQ(BuildLaw(table, &faults), nullptr);
  EXPECT_THAT(faults, HasSubstr("higher"));
}

TEST(CouplingEffects, SitOnCouplingsOnly) {
  for (const char* name : {"oil_dynamics", "viscosity_drift"}) {
    const Effect& effect = *BuiltIns().FindEffect(name);
    EXPECT_TRUE(effect.Places(testing::LumpedPlan()).empty());
    const std::vector<Place> places = effect.Places(testing::CouplingPlan());
    ASSERT_EQ(places.size(), 1u);
    EXPECT_EQ(places[0].ToString(), "shaft:coupling");
  }
  Plan plan = testing::CouplingPlan();
  BuiltIns().FindEffect("viscosity_drift")->Apply(plan, *ParsePlace("shaft:coupling"), {0.3, 2.0});
  EXPECT_TRUE(BuiltIns().FindEffect("viscosity_drift")->Places(plan).empty());
  EXPECT_TRUE(BuiltIns().FindEffect("oil_dynamics")->Places(plan).empty());
}

TEST(CouplingEffects, OilDynamicsIsTheOilModelOfThatProduct) {
  Plan plan = testing::CouplingPlan();
  BuiltIns().FindEffect("oil_dynamics")->Apply(plan, *ParsePlace("shaft:coupling"), {78e3, 190.0, 154e3});
  const auto law = BuildLaw(*plan.root.FindPath("plant.shaft.coupling"));
  ASSERT_NE(law, nullptr);
  const auto printed = BuildLaw(kOil);
  const double torque = 800.0, own = torque, theirs = torque / 0.07;
  double rate = 0.0, other = 0.0;
  law->Derivative({0.0, 0.01, 0.2, 0.0, {&own, 1}, {}}, {&rate, 1});
  printed->Derivative({0.0, 0.01, 0.2, 0.0, {&theirs, 1}, {}}, {&other, 1});
  EXPECT_NEAR(rate, 0.07 * other, 1e-9 * std::abs(rate));
  EXPECT_NEAR(law->Torque({0.0, 0.01, 0.2, 0.0, {&own, 1}, {}}),
              printed->Torque({0.0, 0.01, 0.2, 0.0, {&theirs, 1}, {}}), 1e-9);
}

TEST(SpeedPi, IntegratesUnlessItIsAtItsLimit) {
  const auto control = testing::Build("control", {{"type", "speed_pi"},
                                                  {"k_P_Nms_per_rad", 10.0},
                                                  {"k_I_Nm_per_rad", 100.0},
                                                  {"limit_Nm", 50.0},
                                                  {"initial_torque_Nm", 5.0}});
  ASSERT_NE(control, nullptr);
  double state[2] = {0.0, 0.0}, out = 0.0;
  const double small[] = {3.0, 1.0}, large[] = {9.0, 1.0}, back[] = {0.0, 1.0};
  control->Tick({0.0, small, state, {}}, state, {&out, 1});
  EXPECT_EQ(out, 25.0);
  EXPECT_DOUBLE_EQ(state[0], 5.0 + 100.0 * 1e-4 * 2.0);
  const double before = state[0];
  control->Tick({0.0, large, state, {}}, state, {&out, 1});
  EXPECT_EQ(out, 50.0);
  EXPECT_EQ(state[0], before);  // no wind-up
  state[0] = 80.0;
  control->Tick({0.0, back, state, {}}, state, {&out, 1});
  EXPECT_EQ(out, 50.0);
  EXPECT_LT(state[0], 80.0);  // at the limit, but on the way back
}

Value Engine(double mass, double friction) {
  return {{"type", "single_cylinder"},  {"bore_m", 0.31},
          {"stroke_m", 0.35},           {"rod_m", 0.75},
          {"compression_ratio", 12.0},  {"exponent_compression", 1.33},
          {"exponent_expansion", 1.33}, {"oscillating_mass_kg", mass},
          {"friction_Nm", friction}};
}
double TorqueOf(const Component& engine, double phi, double w) {
  const double in[] = {phi, w};
  double out[2];
  engine.Output({0.0, in, {}, {}}, out);
  return out[0];
}
/// Mean torque over a cycle of 4 pi.
double MeanTorque(const Component& engine, double w) {
  constexpr int kPoints = 40000;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) sum += TorqueOf(engine, 4.0 * pi * i / kPoints, w) / kPoints;
  return sum;
}

TEST(SingleCylinder, MakesNoWorkWithoutLosses) {
  // Equal exponents and pressures: what compression takes, expansion gives back; the masses likewise. The rule of equal
  // steps errs at the two kinks of the pressure by its step squared.
  const auto engine = testing::Build("plant", Engine(90.0, 0.0));
  ASSERT_NE(engine, nullptr);
  double largest = 0.0;
  for (double phi = 0.0; phi < 4.0 * pi; phi += 0.01)
    largest = std::max(largest, std::abs(TorqueOf(*engine, phi, 70.0)));
  EXPECT_NEAR(MeanTorque(*engine, 70.0), 0.0, 1e-6 * largest);
  EXPECT_GT(largest, 1000.0);
}

TEST(SingleCylinder, LosesFrictionAndWallHeat) {
  Value table = Engine(90.0, 300.0);
  const auto engine = testing::Build("plant", table);
  EXPECT_NEAR(MeanTorque(*engine, 70.0), -300.0, 0.1);
  table["exponent_expansion"] = Value(1.36);
  const auto cold = testing::Build("plant", table);
  // Work of the closed strokes, p_in V_b eps^n/(n-1) (1 - eps^(1-n)), analytically for both exponents.
  const double area = 0.25 * pi * 0.31 * 0.31, swept = area * 0.35, clearance = swept / 11.0,
               top = 101300.0 * std::pow(12.0, 1.33);
  const auto given = [&](double n) { return top * clearance / (n - 1.0) * (1.0 - std::pow(12.0, 1.0 - n)); };
  EXPECT_NEAR(MeanTorque(*cold, 70.0), -300.0 + (given(1.36) - given(1.33)) / (4.0 * pi), 0.1);
}

TEST(SingleCylinder, TorqueIsContinuousOverTheCycleEvenWhenFired) {
  Value table = Engine(90.0, 300.0);
  table["firing_pressure_ratio"] = Value(2.5);
  const auto engine = testing::Build("plant", table);
  for (const double phi : {0.0, pi, 2.0 * pi, 3.0 * pi, 4.0 * pi, 40.0 * pi}) {
    // Steepest: the fired pressure of 7 MPa on 0.0755 m^2 with s'' = 0.2 m/rad: 1e5 N m/rad.
    EXPECT_NEAR(TorqueOf(*engine, phi + 1e-9, 5.0), TorqueOf(*engine, phi - 1e-9, 5.0), 1e-3) << phi;
  }
  EXPECT_GT(MeanTorque(*engine, 70.0), 500.0);
}

TEST(SingleCylinder, OscillatingMassGivesTheDerivativeOfItsEnergy) {
  // At constant speed the torque of the masses is -d/dphi (m s'^2 w^2 / 2).
  const auto heavy = testing::Build("plant", Engine(90.0, 0.0)), light = testing::Build("plant", Engine(0.0, 0.0));
  const double w = 70.0, r = 0.175, L = 0.75, h = 1e-5;
  const auto slope = [&](double phi) {
    const double s = std::sin(phi), root = std::sqrt(L * L - r * r * s * s);
    return r * s + r * r * s * std::cos(phi) / root;
  };
  for (double phi = 0.1; phi < 12.0; phi += 0.37) {
    const double energy = 0.5 * 90.0 * w * w;
    const double expected = -energy * (std::pow(slope(phi + h), 2) - std::pow(slope(phi - h), 2)) / (2.0 * h);
    EXPECT_NEAR(TorqueOf(*heavy, phi, w) - TorqueOf(*light, phi, w), expected, 1e-3);
  }
}

}  // namespace
}  // namespace dynoproof
