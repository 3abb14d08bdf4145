// Records and the plan they drive: where a pressure plant starts.
#include "experiment/prepare.h"

#include <gtest/gtest.h>

#include "tests/support/build.h"
#include "tests/support/plan_builder.h"

namespace dynoproof {
namespace {

Series Constant(double value) {
  return {std::make_shared<const std::vector<double>>(std::vector{0.0, 0.02}),
          std::make_shared<const std::vector<double>>(2, value)};
}

double StartOf(const Plan& plan, const char* volume) {
  return plan.root.FindPath(std::string("plant.volume.") + volume + ".start_pressure_Pa")->number();
}

TEST(StartFromRecord, TakesFirstSamplesThatSayOtherwise) {
  Plan plan = testing::AirPlan();  // starts at 3.5e5 and 5.0e5 Pa
  MappedRecord record;
  record.outputs = {{"p_ch", Constant(3.0e5)}, {"p_s", Constant(5.02e5)}};
  StartFromRecord(record, testing::BuiltIns(), plan);
  EXPECT_EQ(StartOf(plan, "V_1"), 3.0e5);
  EXPECT_EQ(StartOf(plan, "V_2"), 5.0e5) << "0.4 % off is noise or a sensor's error";
}

TEST(StartFromRecord, LeavesAllElseAlone) {
  MappedRecord record;
  record.outputs = {{"p_g", Constant(1e5)}, {"p_ch", Constant(-3.0e5)}};
  for (const Plan& plan : {testing::AirPlan(), testing::GasPlan(), testing::LumpedPlan()}) {
    Plan changed = plan;
    StartFromRecord(record, testing::BuiltIns(), changed);
    if (plan.root.FindPath("plant.volume.V_1") != nullptr) {
      EXPECT_EQ(StartOf(changed, "V_1"), StartOf(plan, "V_1"));
    }
    EXPECT_EQ(KeysOf(*changed.root.Find("plant")), KeysOf(*plan.root.Find("plant")));
  }
}

}  // namespace
}  // namespace dynoproof
