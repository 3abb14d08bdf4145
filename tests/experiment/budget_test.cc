// Budgets: what binds where, and that an unfit machine never passes a tail.
#include "experiment/budget.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dynoproof {
namespace {

Timing Measured(bool fit) {
  Timing timing;
  for (int i = 1; i <= 1000; ++i) timing.sorted_us.push_back(0.001 * i);  // 0.001 ... 1 us
  timing.simulated_s_per_s = 200.0;
  timing.fitness.wake_p99_us = fit ? 10.0 : 500.0;
  return timing;
}

Budget Stated() {
  Budget budget;
  budget.step_p50_us = 0.6;
  budget.step_p999_us = 1.1;
  budget.step_max_us = 0.9;
  budget.simulated_s_per_s = 100.0;
  budget.no_heap = true;
  return budget;
}

std::vector<score::Verdict> Verdicts(const Timing& timing) {
  std::vector<score::Verdict> verdicts;
  for (const score::Check& check : JudgeBudget(Stated(), timing)) verdicts.push_back(check.verdict);
  return verdicts;
}

TEST(Budget, OnAFitMachineEveryLimitBinds) {
  using enum score::Verdict;
  EXPECT_EQ(Verdicts(Measured(true)), (std::vector<score::Verdict>{kPass, kPass, kFail, kPass, kPass}));
}

TEST(Budget, OnAnUnfitMachineTailsAreInconclusiveAndNeverPass) {
  using enum score::Verdict;
  EXPECT_EQ(Verdicts(Measured(false)),
            (std::vector<score::Verdict>{kPass, kInconclusive, kInconclusive, kInconclusive, kPass}));
}

TEST(Budget, TheMedianAndTheHeapBindEverywhere) {
  Timing timing = Measured(false);
  timing.heap_growth_bytes = 16.0;
  for (double& value : timing.sorted_us) value *= 10.0;
  const std::vector<score::Verdict> verdicts = Verdicts(timing);
  EXPECT_EQ(verdicts.front(), score::Verdict::kFail);
  EXPECT_EQ(verdicts.back(), score::Verdict::kFail);
}

TEST(Budget, NothingMeasuredIsNoPass) {
  Timing timing = Measured(true);
  timing.sorted_us.clear();
  EXPECT_EQ(Verdicts(timing).front(), score::Verdict::kFail);
}

TEST(Budget, ReadsItsTable) {
  Plan plan;
  Diagnostics diagnostics;
  EXPECT_FALSE(ReadBudget(plan, diagnostics));
  EXPECT_FALSE(diagnostics.has_errors());
  plan.root["budget"] = Value{{"step_p50_us", 2.0}};
  ASSERT_TRUE(ReadBudget(plan, diagnostics));
  EXPECT_EQ(ReadBudget(plan, diagnostics)->step_p50_us, 2.0);
  plan.root["budget"] = Value{{"step_p50_us", -2.0}};
  EXPECT_FALSE(ReadBudget(plan, diagnostics));
  EXPECT_TRUE(diagnostics.has_errors());
}

}  // namespace
}  // namespace dynoproof
