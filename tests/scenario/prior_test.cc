// [prior]: how well numbers are known, as a scenario states it.
#include "model/prior.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/registry.h"

namespace dynoproof {
namespace {

using ::testing::HasSubstr;

/// A line of two masses; `prior` is the section.
Plan LineWith(Value prior) {
  Plan plan;
  plan.root = Value{
      {"plant", Value{{"type", "drive_line"},
                      {"inertia", Value{{"I1", 2.0}, {"I2", 0.3}}},
                      {"shaft", Value{{"k1", Value{{"stiffness_Nm_per_rad", 4e5}, {"damping_Nms_per_rad", 0.0}}}}},
                      {"nominal_torque_Nm", 500.0}}},
      {"prior", std::move(prior)}};
  return plan;
}

std::string FaultsOf(const Plan& plan) {
  Diagnostics diagnostics;
  CheckPriors(plan, diagnostics);
  return diagnostics.Format(false);
}

NuisanceParameter Of(const Plan& plan, const std::string& path) {
  const std::vector<NuisanceParameter> all = NuisancesWithPriors(testing::FullRegistry().PlantOf(plan), plan);
  const auto found = std::ranges::find(all, path, &NuisanceParameter::path);
  return found != all.end() ? *found : NuisanceParameter{};
}

TEST(Prior, TakesThePlaceOfThePlants) {
  const std::string stiffness = "plant.shaft.k1.stiffness_Nm_per_rad";
  const Plan plan = LineWith(Value{{"plant.inertia.I1", "2.5 %"},
                                   {"plant.shaft.k1.stiffness_Nm_per_rad", "free"},
                                   {"plant.nominal_torque_Nm", "fitted"}});
  EXPECT_EQ(FaultsOf(plan), "");
  EXPECT_DOUBLE_EQ(Of(plan, "plant.inertia.I1").spread, 0.025);
  EXPECT_EQ(Of(plan, stiffness).spread, kNoPrior);
  EXPECT_DOUBLE_EQ(Of(plan, "plant.nominal_torque_Nm").spread, 0.5) << "a number that the plant does not list";
  EXPECT_DOUBLE_EQ(Of(plan, "plant.inertia.I2").spread, 0.01) << "the plant's own";
  EXPECT_TRUE(PriorIsStated(plan, stiffness));
  EXPECT_FALSE(PriorIsStated(plan, "plant.inertia.I2"));
}

TEST(Prior, TablesSayTheSameAsKeysWithDots) {
  const Plan plan = LineWith(Value{{"plant", Value{{"inertia", Value{{"I2", "3 %"}}}}}});
  EXPECT_EQ(FaultsOf(plan), "");
  EXPECT_DOUBLE_EQ(Of(plan, "plant.inertia.I2").spread, 0.03);
}

TEST(Prior, OfANumberThatDiffersFromRecordToRecordIsOnTheDifference) {
  const Plan plan = LineWith(Value{{"plant.inertia.I1", Value{{"spread", "5 %"}, {"per_record", true}}},
                                   {"plant.inertia.I2", Value{{"spread", "3 %"}}}});
  EXPECT_EQ(FaultsOf(plan), "");
  const std::vector<NumberThatDiffers> differ = NumbersThatDiffer(plan);
  ASSERT_EQ(differ.size(), 1U);
  EXPECT_EQ(differ[0].path, "plant.inertia.I1");
  EXPECT_DOUBLE_EQ(differ[0].spread, 0.05);
  EXPECT_DOUBLE_EQ(Of(plan, "plant.inertia.I1").spread, 0.01) << "of the common value the plant's own stands";
  EXPECT_FALSE(PriorIsStated(plan, "plant.inertia.I1"));
  EXPECT_DOUBLE_EQ(Of(plan, "plant.inertia.I2").spread, 0.03);
}

TEST(Prior, OfADifferenceIsAShare) {
  for (const char* spread : {"free", "fitted", ""})
    EXPECT_THAT(FaultsOf(LineWith(Value{{"plant.inertia.I1", Value{{"spread", spread}, {"per_record", true}}}})),
                HasSubstr("how much \"plant.inertia.I1\" differs from record to record is not said"))
        << spread;
  EXPECT_THAT(FaultsOf(LineWith(Value{{"plant.inertia.I1", Value{{"spread", "5 %"}, {"per_record", 1}}}})),
              HasSubstr("neither true nor false"));
  EXPECT_THAT(FaultsOf(LineWith(Value{{"plant.inertia.I1", Value{{"spread", "5 %"}, {"each", true}}}})),
              HasSubstr("unknown key \"each\""));
}

TEST(Prior, NamesEveryFault) {
  EXPECT_THAT(FaultsOf(LineWith(Value{{"plant.inertia.I7", "2 %"}})),
              HasSubstr("there is no number \"plant.inertia.I7\""));
  for (const char* text : {"2", "-1 %", "0 %", "nan %", "150 %", "2 % off", "fited", ""})
    EXPECT_THAT(FaultsOf(LineWith(Value{{"plant.inertia.I1", text}})),
                HasSubstr("the prior of \"plant.inertia.I1\" is none"))
        << text;
  EXPECT_THAT(FaultsOf(LineWith(Value{{"plant.inertia.I1", 0.02}})), HasSubstr("is none"));
  EXPECT_THAT(FaultsOf(LineWith(Value{{"plant.shaft.k1.damping_Nms_per_rad", "2 %"}})), HasSubstr("is 0"));
}

}  // namespace
}  // namespace dynoproof
