// Records and the plan they drive: where a pressure plant starts.
#include "experiment/prepare.h"

#include <gtest/gtest.h>

#include "experiment/run_scenario.h"
#include "tests/support/build.h"
#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

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

TEST(Variants, KeepTheOutputsThatTheyName) {
  const auto prepared = [](const Value& keep, std::string* faults) {
    Plan plan = testing::OneMass(1.0, Value{{"type", "constant"}, {"value", 1.0}}, 0.01);
    plan.root["variant"] = Value{{"heavy", Value{{"keep", keep}, {"plant", Value{{"inertia", Value{{"I", 2.0}}}}}}}};
    Diagnostics diagnostics;
    auto made = Prepare(std::move(plan), {}, testing::BuiltIns(), diagnostics);
    *faults = diagnostics.Format();
    return made;
  };
  std::string faults;
  const auto run = prepared(Value(Value::Array{Value("w")}), &faults);
  ASSERT_NE(run, nullptr) << faults;
  const Result<Course> course = Play(*run);
  ASSERT_TRUE(course.ok());
  ASSERT_NE(course->trace.Find("w_heavy"), nullptr);
  EXPECT_NEAR(course->trace.Find("w_heavy")->values.back(), 0.5 * course->trace.Find("w")->values.back(), 1e-12);
  EXPECT_EQ(course->trace.Find("phi_heavy"), nullptr);
  EXPECT_EQ(prepared(Value(Value::Array{Value("speed")}), &faults), nullptr);
  EXPECT_NE(faults.find("there is no output \"speed\" to keep"), std::string::npos) << faults;
  EXPECT_EQ(prepared(Value("w"), &faults), nullptr);
  EXPECT_NE(faults.find("\"keep\" is no list of names"), std::string::npos) << faults;
}

}  // namespace
}  // namespace dynoproof
