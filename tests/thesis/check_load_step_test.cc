// The check of kind `load_step` on courses made by hand.
#include "thesis/check_load_step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/check_bed.h"

namespace dynoproof {
namespace {

using ::testing::HasSubstr;

Value LoadStep() {
  return {{"kind", "load_step"},
          {"speed", "p_ch"},
          {"power", "p_s"},
          {"load", "u_1"},
          {"drop_percent", Value::Array{1.0, 3.0}},
          {"recovery_s", 5.0},
          {"dip_percent", 20.0},
          {"origin", "a test"}};
}

/// A step at 10 s: the speed falls by `drop` of 100 and comes back with `rate`, the power rises from 4 to 5 at once and
/// is taken back by `dip` times the missing speed.
testing::CheckBed Course(double drop, double rate, double dip) {
  testing::CheckBed bed(LoadStep());
  const auto missing = [=](double t) {
    return t < 10.0 ? 0.0 : drop * (std::exp(-rate * (t - 10.0)) - std::exp(-3.0 * rate * (t - 10.0))) / 0.3849;
  };
  bed.Input([](double t) { return t < 10.0 ? 1.0 : 2.0; });
  bed.Output(0, [=](double t) { return 100.0 - missing(t); });
  bed.Output(1, [=](double t) { return t < 10.0 ? 4.0 : 5.0 - dip * missing(t); });
  return bed;
}

TEST(LoadStepCheck, TellsDropRecoveryAndPower) {
  Figures figures;
  const auto checks = Course(2.0, 1.0, 0.2).Run(&figures);
  ASSERT_EQ(checks.size(), 4u);
  for (const score::Check& check : checks) EXPECT_EQ(check.verdict, score::Verdict::kPass) << check.name;
  // exp(-t) - exp(-3 t) is largest at t = ln(3)/2, by 0.3849; its samples stand 0.01 s apart.
  EXPECT_NEAR(figures.at("speed_drop_percent").value, 2.0, 2e-4);
  EXPECT_NEAR(figures.at("drop_s").value, 0.5 * std::log(3.0), 0.01);
  EXPECT_NEAR(figures.at("recovery_s").value, std::log(2.0 / 0.3849 / 0.5), 0.02);
  EXPECT_EQ(figures.at("power_before_W").value, 4.0);
  EXPECT_EQ(figures.at("power_peak_W").value, 5.0);
  EXPECT_NEAR(figures.at("power_dip_W").value, 4.6, 1e-4);
}

TEST(LoadStepCheck, FailsWhatIsNotSo) {
  const auto verdict = [](const testing::CheckBed& bed, std::size_t index) { return bed.Run().at(index).verdict; };
  EXPECT_EQ(verdict(Course(0.5, 1.0, 0.8), 0), score::Verdict::kFail) << "too shallow";
  EXPECT_EQ(verdict(Course(4.0, 1.0, 0.2), 0), score::Verdict::kFail) << "too deep";
  EXPECT_EQ(verdict(Course(2.0, 0.2, 0.2), 1), score::Verdict::kFail) << "too late";
  EXPECT_EQ(verdict(Course(2.0, 0.02, 0.2), 1), score::Verdict::kFail) << "never";
  EXPECT_EQ(verdict(Course(2.0, 1.0, 0.05), 3), score::Verdict::kFail) << "power is hardly taken back";
  testing::CheckBed bed = Course(2.0, 1.0, 0.2);
  bed.Output(1, [](double t) { return t < 10.0 ? 4.0 : 4.9 + std::min(0.1, 0.01 * (t - 10.0)); });
  EXPECT_EQ(verdict(bed, 2), score::Verdict::kFail) << "does not rise at once";
}

TEST(LoadStepCheck, ComparesNothingThatIsNotThere) {
  testing::CheckBed twice = Course(2.0, 1.0, 0.2), never = Course(2.0, 1.0, 0.2), early = Course(2.0, 1.0, 0.2),
                    hole = Course(2.0, 1.0, 0.2);
  twice.Input([](double t) { return t < 10.0 ? 1.0 : t < 20.0 ? 2.0 : 3.0; });
  never.Input([](double) { return 1.0; });
  early.Input([](double t) { return t < 0.5 ? 1.0 : 2.0; });
  hole.samples.outputs[0][77] = std::nan("");
  for (const auto* bed : {&twice, &never, &early, &hole}) {
    const auto checks = bed->Run();
    ASSERT_EQ(checks.size(), 1u);
    EXPECT_EQ(checks[0].verdict, score::Verdict::kFail);
    EXPECT_FALSE(checks[0].explanation.empty());
  }
}

TEST(LoadStepCheck, RefusesADropWithoutWidth) {
  Plan plan = testing::AirPlan();
  Value check = LoadStep();
  check["drop_percent"] = Value::Array{3.0, 1.0};
  plan.root["check"] = Value::Array{check};
  const auto rig = testing::RigOf(plan);
  Diagnostics diagnostics;
  ReadChecks(plan, *rig, testing::FullRegistry(), diagnostics);
  EXPECT_THAT(diagnostics.Format(), HasSubstr("write [from, to] with from < to"));
}

}  // namespace
}  // namespace dynoproof
