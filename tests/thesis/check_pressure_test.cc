// Checks of kind `ramps` and `bounded` on courses made by hand.
#include "thesis/check_pressure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/check_bed.h"

namespace dynoproof {
namespace {

using ::testing::HasSubstr;
using Bed = testing::CheckBed;

Value Ramps() {
  return {{"kind", "ramps"},          {"signal", "p_ch"},     {"reference", "u_1"},
          {"overshoot_percent", 2.0}, {"settling_s", 1.5},    {"steady", "p_s"},
          {"steady_at", 25.0},        {"steady_within", 1.0}, {"origin", "a test"}};
}

/// 10 until 10 s, a ramp of 5 s to 20, then steady.
double Ramp(double t) { return 10.0 + 10.0 * std::clamp((t - 10.0) / 5.0, 0.0, 1.0); }

TEST(RampsCheck, MeasuresOvershootSettlingDelayAndTheSteadyPlace) {
  Bed bed(Ramps());
  bed.Input(Ramp);
  // Half a second late, then 0.3 (3 % of the step of 10) above the level, gone at 17 s.
  bed.Output(0, [](double t) { return Ramp(t - 0.5) + (t > 15.6 && t < 16.995 ? 0.3 : 0.0); });
  bed.Output(1, [](double t) { return t < 37.0 ? 40.0 : 25.5; });
  Figures figures;
  const std::vector<score::Check> checks = bed.Run(&figures);
  ASSERT_EQ(checks.size(), 3u);
  EXPECT_NEAR(figures.at("overshoot_percent").value, 3.0, 1e-9);
  EXPECT_NEAR(figures.at("settling_s").value, 2.0, 0.011);
  EXPECT_NEAR(figures.at("delay_s").value, 0.5, 1e-6);
  EXPECT_NEAR(figures.at("p_s_steady").value, 25.5, 1e-12);  // of the last tenth, from 37.5 s on
  EXPECT_EQ(checks[0].verdict, score::Verdict::kFail);
  EXPECT_EQ(checks[1].verdict, score::Verdict::kFail);
  EXPECT_EQ(checks[2].verdict, score::Verdict::kPass);
}

TEST(RampsCheck, PassesAGoodCourseAndSeesFallingSteps) {
  Bed bed(Ramps());
  bed.Input([](double t) { return 30.0 - Ramp(t); });
  bed.Output(1, [](double) { return 25.0; });
  bed.Output(0, [](double t) { return 30.0 - Ramp(t - 0.2); });
  for (const score::Check& check : bed.Run()) EXPECT_EQ(check.verdict, score::Verdict::kPass) << check.name;
  bed.Output(0, [](double t) { return 30.0 - Ramp(t - 0.2) - (t > 20.0 && t < 21.0 ? 0.5 : 0.0); });
  EXPECT_EQ(bed.Run()[0].verdict, score::Verdict::kFail) << "5 % below the level";
}

TEST(RampsCheck, AnOutputThatNeverArrivesSettlesInTheWholePhase) {
  Bed bed(Ramps());
  bed.Input(Ramp);
  bed.Output(0, [](double) { return 10.0; });
  Figures figures;
  EXPECT_EQ(bed.Run(&figures)[1].verdict, score::Verdict::kFail);
  EXPECT_NEAR(figures.at("settling_s").value, 25.0, 0.011);
}

TEST(RampsCheck, FailsWhereNothingCouldBeCompared) {
  Bed bed(Ramps());  // the input never changes
  for (const score::Check& check : bed.Run()) {
    EXPECT_EQ(check.verdict, score::Verdict::kFail);
    EXPECT_THAT(check.explanation, HasSubstr("never stands still"));
  }
  Bed variants(Ramps());
  variants.plan.root["check"].array()[0]["worse"] = Value("nobody");
  variants.Input(Ramp);
  variants.Output(0, Ramp);
  const std::vector<score::Check> checks = variants.Run();
  EXPECT_EQ(checks.back().verdict, score::Verdict::kFail);
  EXPECT_THAT(checks.back().explanation, HasSubstr("no such variant"));
}

TEST(BoundedCheck, SeesTheOneSampleThatLeavesItsBounds) {
  Value check = {{"kind", "bounded"}, {"signal", "p_s"},     {"above", "p_ch"},
                 {"below", "p_ch"},   {"below_factor", 2.0}, {"origin", "(6.7)"}};
  Bed bed(check);
  bed.Output(1, [](double) { return 1.5; });
  Figures figures;
  EXPECT_EQ(bed.Run(&figures)[0].verdict, score::Verdict::kPass);
  EXPECT_NEAR(figures.at("p_s_margin").value, 0.5, 1e-12);
  for (const double wrong : {0.9, 1.0, 2.0, 2.1}) {  // on a bound is beyond it
    bed.samples.outputs[1][777] = wrong;
    const score::Check made = bed.Run()[0];
    EXPECT_EQ(made.verdict, score::Verdict::kFail) << wrong;
    EXPECT_THAT(made.explanation, HasSubstr("7.77"));
  }
  bed.samples.outputs[1][777] = std::nan("");
  EXPECT_EQ(bed.Run()[0].verdict, score::Verdict::kFail);
}

TEST(BoundedCheck, LooksAtItsStretchAlone) {
  Value check = {{"kind", "bounded"},
                 {"signal", "p_s"},
                 {"between", Value::Array{1.0, 2.0}},
                 {"during_s", Value::Array{2.0, 4.0}},
                 {"origin", "none"}};
  Bed bed(check);
  bed.Output(1, [](double) { return 1.5; });
  for (const auto& [row, seen] : {std::pair{199, false}, {200, true}, {400, true}, {401, false}}) {
    bed.samples.outputs[1][row] = 2.5;
    EXPECT_EQ(bed.Run()[0].verdict, seen ? score::Verdict::kFail : score::Verdict::kPass) << row;
    bed.samples.outputs[1][row] = 1.5;
  }
  // A stretch that the run does not have to its end was not looked at.
  const double end_s = bed.samples.time.back();
  bed.plan.root["check"].array()[0]["during_s"] = Value(Value::Array{end_s - 1.0, end_s + 1.0});
  EXPECT_EQ(bed.Run()[0].verdict, score::Verdict::kFail);
}

TEST(BoundedCheck, RefusesACheckWithoutBounds) {
  Plan plan = testing::AirPlan();
  plan.root["check"] = Value::Array{Value{{"kind", "bounded"}, {"signal", "p_s"}, {"origin", "none"}},
                                    Value{{"kind", "bounded"}, {"signal", "p_s"}, {"above", "nothing"}, {"origin", ""}},
                                    Value{{"kind", "bounded"},
                                          {"signal", "p_s"},
                                          {"above", "p_ch"},
                                          {"during_s", Value::Array{2.0, 1.0}},
                                          {"origin", ""}},
                                    Value{{"kind", "ramps"},
                                          {"signal", "p_s"},
                                          {"reference", "u_9"},
                                          {"overshoot_percent", 1.0},
                                          {"settling_s", 1.0},
                                          {"origin", ""}}};
  Diagnostics diagnostics;
  ReadChecks(plan, *testing::RigOf(plan), testing::FullRegistry(), diagnostics);
  EXPECT_THAT(diagnostics.Format(), HasSubstr("no bound"));
  EXPECT_THAT(diagnostics.Format(), HasSubstr("no output \"nothing\""));
  EXPECT_THAT(diagnostics.Format(), HasSubstr("no input \"u_9\""));
  EXPECT_THAT(diagnostics.Format(), HasSubstr("write [from, to]"));
}

}  // namespace
}  // namespace dynoproof
