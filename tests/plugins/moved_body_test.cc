// A body whose motion is prescribed: the force by hand, with friction that jumps and friction that does not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/build.h"

namespace dynoproof {
namespace {

using testing::Build;
using testing::OutputOf;

Value Rod(double transition_speed_m_per_s) {
  return {{"type", "moved_body"},
          {"body", "rod"},
          {"stiffness_N_per_m", 2000.0},
          {"damping_Ns_per_m", 30.0},
          {"transition_speed_m_per_s", transition_speed_m_per_s},
          {"load", Value{{"seal", Value{{"on", "rod"}, {"law", "coulomb"}, {"T_c_Nm", 5.0}}},
                         {"gas", Value{{"on", "rod"}, {"law", "constant"}, {"T_0_Nm", 7.0}}}}}};
}

double Force(const Component& plant, double x, double v) {
  const std::array<double, 2> inputs = {x, v};
  return OutputOf(plant, 0.0, inputs);
}

TEST(MovedBody, AddsUpItsLaws) {
  const auto plant = Build("plant", Rod(0.0));
  ASSERT_NE(plant, nullptr);
  EXPECT_DOUBLE_EQ(Force(*plant, 0.01, 0.2), 20.0 + 6.0 + 5.0 + 7.0);
  EXPECT_DOUBLE_EQ(Force(*plant, 0.01, -1e-9), 20.0 - 30e-9 - 5.0 + 7.0) << "friction jumps";
  EXPECT_DOUBLE_EQ(Force(*plant, 0.01, 0.0), 27.0) << "nothing tells the friction of a body at rest";
}

TEST(MovedBody, FrictionTurnsOverTheTransitionSpeed) {
  const auto plant = Build("plant", Rod(0.01));
  ASSERT_NE(plant, nullptr);
  for (const double v : {-0.5, -0.01, -1e-5, 0.0, 1e-5, 0.004, 0.5})
    EXPECT_NEAR(Force(*plant, 0.0, v), 30.0 * v + 5.0 * std::tanh(v / 0.01) + 7.0, 1e-12) << v;
}

TEST(MovedBody, APistonCarriesItsPressure) {
  Value rod = Rod(0.0);
  rod["area_m2"] = Value(5e-4);
  const auto plant = Build("plant", rod);
  ASSERT_NE(plant, nullptr);
  ASSERT_EQ(plant->layout().inputs.size(), 3U);
  EXPECT_EQ(plant->layout().inputs[2].name, "p");
  const std::array<double, 3> inputs = {0.01, 0.2, 2e5};
  EXPECT_DOUBLE_EQ(OutputOf(*plant, 0.0, inputs), 20.0 + 6.0 + 5.0 + 7.0 + 100.0);
  EXPECT_EQ(Build("plant", Rod(0.0))->layout().inputs.size(), 2U) << "a body without an area has no pressure";
}

TEST(MovedBody, RefusesWhatItCannotCarry) {
  std::string faults;
  Value rod = Rod(-1.0);
  EXPECT_EQ(Build("plant", rod, {}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("transition_speed_m_per_s"));
  rod = Rod(0.0);
  rod["load"]["seal"]["on"] = Value("piston");
  EXPECT_EQ(Build("plant", rod, {}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("on = \"rod\""));
}

}  // namespace
}  // namespace dynoproof
