// Variants side by side: the course of each is that of its own run, whoever its neighbours are.
#include "sim/batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

namespace dynoproof::testing {
namespace {

using ::testing::HasSubstr;

/// A soft rotor that turns, under a chirp; its torque, speed and angle. Variants differ in inertia and amplitude.
Plan Variant(int number, double keep_below_Hz) {
  Plan plan = SoftPlan();
  plan.root["run"]["duration_s"] = Value(0.2);
  plan.root["run"]["realtime"]["keep_below_Hz"] = Value(keep_below_Hz);
  plan.root["plant"]["rotor"]["I1"]["slices"] = Value(24);  // quick to decompose
  plan.root["plant"]["torque"]["T_airgap"]["slices"] = Value(Value::Array{3, 20});
  plan.root["plant"]["initial_speed_rad_per_s"] = Value(10.0 + number);
  plan.root["plant"]["inertia"]["I5"] = Value(0.14 + 0.01 * number);
  plan.root["input"]["T_airgap"]["source"] = Value{{"type", "chirp"},
                                                   {"amplitude", 100.0 * (1 + number)},
                                                   {"start_Hz", 1.0},
                                                   {"end_Hz", 2000.0},
                                                   {"rate_Hz_per_s", 10000.0}};
  plan.root["output"]["omega"] = Value{{"of", "plant.I1.left.speed"}};
  plan.root["output"]["phi"] = Value{{"of", "plant.I1.left.angle"}};
  return plan;
}

struct Made {
  std::vector<std::unique_ptr<Rig>> rigs;
  std::vector<BatchMember> members;
  std::vector<const BatchMember*> pointers;
};

Made Make(int count, double keep_below_Hz) {
  Made made;
  for (int i = 0; i < count; ++i) {
    made.rigs.push_back(RigOf(Variant(i, keep_below_Hz)));
    Result<BatchMember> member = BatchMember::Create(*made.rigs.back());
    EXPECT_TRUE(member.ok()) << member.failure().ToString();
    if (member.ok()) made.members.push_back(*std::move(member));
  }
  for (const BatchMember& member : made.members) made.pointers.push_back(&member);
  return made;
}

TEST(Batch, EachLaneIsTheRunOfItsVariant) {
  for (const double keep_below_Hz : {0.0, 2500.0}) {
    const Made made = Make(5, keep_below_Hz);
    ASSERT_EQ(made.members.size(), 5u);
    EXPECT_EQ(made.members[0].pairs() < 20, keep_below_Hz > 0.0);
    const auto together = SimulateBatch(made.pointers, std::vector<int>{0, 1, 2}, false);
    ASSERT_TRUE(together.ok());
    for (std::size_t lane = 0; lane < 5; ++lane) {
      const Samples alone = RunRig(*made.rigs[lane], "realtime"), &batched = (*together)[lane];
      EXPECT_EQ(batched.time, alone.time);
      EXPECT_EQ(batched.inputs, alone.inputs);
      // Round-off of the same exact steps summed in another order, 2000 of them; 3.7e-13 is seen, times 5.
      for (std::size_t output = 0; output < 3; ++output)
        EXPECT_LT(Nrmse(alone.outputs[output], batched.outputs[output]), 2e-12) << lane << " " << output;
    }
  }
}

TEST(Batch, ALaneDoesNotDependOnItsNeighbours) {
  const Made made = Make(8, 0.0);
  ASSERT_EQ(made.members.size(), 8u);
  const auto all = SimulateBatch(made.pointers, std::vector<int>{0, 2}, false);
  const std::vector<const BatchMember*> some = {made.pointers[6], made.pointers[3]};
  const auto two = SimulateBatch(some, std::vector<int>{0, 2}, false);
  ASSERT_TRUE(all.ok() && two.ok());
  EXPECT_EQ((*all)[6].outputs, (*two)[0].outputs);
  EXPECT_EQ((*all)[3].outputs, (*two)[1].outputs);
  EXPECT_NE((*all)[3].outputs, (*all)[6].outputs);
}

TEST(Batch, WhatIsNotLinearOrNotPlainIsRefusedWithAReason) {
  const auto why = [](const Plan& plan) {
    const std::unique_ptr<Rig> rig = RigOf(plan);
    const Result<BatchMember> member = BatchMember::Create(*rig);
    return member.ok() ? std::string("taken") : member.failure().message;
  };
  EXPECT_THAT(why(PlayPlan()), HasSubstr("not linear"));
  Plan plan = Variant(0, 0.0);
  EXPECT_EQ(why(plan), "taken");
  plan.root["input"]["T_airgap"]["actuator"] = Value(Value::Array{Value{{"type", "delay"}, {"delay_s", 1.7e-4}}});
  EXPECT_THAT(why(plan), HasSubstr("delays"));
  plan = Variant(0, 0.0);
  plan.root["run"]["solver"] = Value("reference");
  EXPECT_THAT(why(plan), HasSubstr("another solver"));
}

}  // namespace
}  // namespace dynoproof::testing
