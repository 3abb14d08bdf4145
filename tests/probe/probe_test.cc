#include "probe/probe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "experiment/run_scenario.h"
#include "model/registry.h"
#include "probe/report.h"
#include "tests/support/largest_check.h"
#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

namespace dynoproof::probe {
namespace {

using ::dynoproof::testing::Largest;

const Registry& Plugins() { return testing::PluginsAndLargest(); }

std::unique_ptr<Prepared> PreparedOf(Plan plan, Value::Array checks) {
  plan.root["check"] = Value(std::move(checks));
  Diagnostics diagnostics;
  std::unique_ptr<Prepared> prepared = Prepare(std::move(plan), {}, Plugins(), diagnostics);
  EXPECT_NE(prepared, nullptr) << diagnostics.Format();
  return prepared;
}

/// 1 N m on 2 kg m^2 for 0.1 s: 0.05 rad/s at the end, where a fifth more is allowed.
std::unique_ptr<Prepared> OneMassWithALimit() {
  return PreparedOf(testing::OneMass(2.0, Value{{"type", "constant"}, {"value", 1.0}}), {Largest("w", 0.06)});
}

const Finding& Of(const Probed& probed, const std::string& name, const std::string& place, int sign = 1) {
  for (const Finding& one : probed.findings) {
    if (one.name == name && one.place == place && one.sign == sign) return one;
  }
  ADD_FAILURE() << name << "@" << place << " was not tried";
  static const Finding none;
  return none;
}

TEST(Probe, FindsTheStrengthsThatArithmeticGives) {
  const auto prepared = OneMassWithALimit();
  const Result<Probed> probed = Probe(*prepared, {});
  ASSERT_TRUE(probed.ok()) << probed.failure().ToString();
  constexpr double kClose = 0.05;  // half of the bracket in which a search ends
  const Finding& gain = Of(*probed, "sensor_gain", "output:w");
  EXPECT_EQ(gain.state, State::kSeen);
  EXPECT_NEAR(gain.strength, 0.2, 0.2 * kClose);
  EXPECT_EQ(gain.by, "largest w");
  EXPECT_THAT(gain.parameters, ::testing::ElementsAre(::testing::Pair("g", 1.0 + gain.strength)));
  EXPECT_NEAR(Of(*probed, "sensor_offset", "output:w").strength, 0.01, 0.01 * kClose);
  // 0.05/(1 + delta) = 0.06.
  const Finding& lighter = Of(*probed, "inertia_change", "inertia:I", -1);
  EXPECT_NEAR(lighter.strength, -1.0 / 6.0, kClose / 6.0);
  EXPECT_TRUE(lighter.IsHole()) << "such values are off by some per cent as a rule";
  // A heavier body is slower: no limit stops it, and neither does one that turns the other way.
  EXPECT_EQ(Of(*probed, "inertia_change", "inertia:I").state, State::kUnseen);
  EXPECT_EQ(Of(*probed, "turned_sign", "input:T").state, State::kUnseen);
  EXPECT_EQ(Of(*probed, "dropped_term", "plant.inertia.I").state, State::kRefused);
  // What is recorded of the angle, no check asks.
  EXPECT_EQ(Of(*probed, "sensor_gain", "output:phi").state, State::kUnseen);
  EXPECT_GT(Of(*probed, "sensor_gain", "output:phi").moves, 0.0);
}

TEST(Probe, StatesEveryLimitWithinAFifth) {
  Plan plan = testing::LumpedPlan();
  plan.root["input"]["T_airgap"]["source"] =
      Value{{"type", "chirp"}, {"amplitude", 100.0}, {"start_Hz", 0.0}, {"end_Hz", 400.0}, {"rate_Hz_per_s", 2000.0}};
  plan.root["run"]["duration_s"] = Value(0.2);
  double largest = 0.0;
  const Samples sound = testing::RunPlan(plan, "realtime");
  for (const double value : sound.outputs[0]) largest = std::max(largest, std::abs(value));
  const auto prepared = PreparedOf(plan, {Largest("T_shaft", 1.3 * largest)});
  const Result<Probed> probed = Probe(*prepared, {});
  ASSERT_TRUE(probed.ok()) << probed.failure().ToString();
  const Samples own = testing::RunRig(*prepared->rig, "realtime");
  int tried = 0;
  std::vector<std::string> wrong;
  for (const Mutation& mutation : MutationsOf(prepared->plan, Plugins(), MagnitudesOf(*prepared->rig, own))) {
    const Finding& found = Of(*probed, mutation.name, mutation.place, mutation.sign);
    if (found.state != State::kSeen || !mutation.sized()) continue;
    const auto verdict = [&](double size) {
      Plan changed = prepared->plan;
      mutation.apply(changed, size);
      Diagnostics refused;
      const auto run = PrepareLike(*prepared, changed, refused);
      return run == nullptr ? score::Verdict::kBroken : RunScenario(*run, {.out = ""}).verdict;
    };
    // Half of the bracket further on; a wide gap lets go of what a narrow one hits, so no further.
    const bool seen = verdict(1.05 * found.size) != score::Verdict::kPass;
    const bool passed = found.at_once || verdict(found.size / 1.2) == score::Verdict::kPass;
    if (!seen || !passed) wrong.push_back(mutation.Key());
    ++tried;
  }
  // How hard a shaft with play hits is no smooth function of its gap: one place of the four is between two answers.
  EXPECT_GT(tried, 20);
  EXPECT_THAT(wrong, ::testing::IsSubsetOf({"backlash@shaft:k1 +", "backlash@shaft:k3 +", "backlash@shaft:k4 +"}));
  EXPECT_LE(wrong.size(), 1U);
}

TEST(Probe, AsksNoCheckThatFollowsThePlan) {
  const auto prepared =
      PreparedOf(testing::OneMass(2.0, Value{{"type", "constant"}, {"value", 1.0}}),
                 {Value{{"kind", "solvers"}, {"signal", "w"}, {"nrmse", 1e-6}, {"origin", "two exact methods"}}});
  const Result<Probed> probed = Probe(*prepared, {});
  ASSERT_FALSE(probed.ok());
  EXPECT_EQ(probed.failure().exit_code, 1);
  EXPECT_THAT(probed.failure().message, ::testing::HasSubstr("not solvers (its reference comes from the same plan)"));
}

TEST(Probe, BeginsOnlyFromARunThatPasses) {
  const auto prepared =
      PreparedOf(testing::OneMass(2.0, Value{{"type", "constant"}, {"value", 1.0}}), {Largest("w", 0.04)});
  const Result<Probed> probed = Probe(*prepared, {});
  ASSERT_FALSE(probed.ok());
  EXPECT_EQ(probed.failure().exit_code, 1);
  EXPECT_THAT(probed.failure().message, ::testing::HasSubstr("does not pass as it is (largest w)"));
}

TEST(Probe, LooksForNothingThatIsKnown) {
  const auto prepared = OneMassWithALimit();
  const Result<Probed> first = Probe(*prepared, {});
  ASSERT_TRUE(first.ok());
  const Result<Probed> second = Probe(*prepared, {.known = first->findings});
  ASSERT_TRUE(second.ok());
  EXPECT_EQ(second->runs, 1);
  EXPECT_EQ(second->findings.size(), first->findings.size());
}

TEST(ProbeReport, FindingsComeBackFromJson) {
  const auto prepared = OneMassWithALimit();
  const Result<Probed> probed = Probe(*prepared, {.effects = {"sensor_gain", "actuator_saturation", "turned_sign"}});
  ASSERT_TRUE(probed.ok());
  for (const Finding& one : probed->findings) {
    const std::optional<Finding> back = FromJson(ToJson(one));
    ASSERT_TRUE(back.has_value()) << one.name;
    EXPECT_EQ(ToJson(*back), ToJson(one));
    EXPECT_EQ(PassesText(*back), PassesText(one));
  }
  EXPECT_FALSE(FromJson({{"effect", "sensor_gain"}}).has_value());
}

TEST(ProbeReport, ADemandIsMetWhereEveryPlaceIsSeen) {
  const auto prepared = OneMassWithALimit();
  const Result<Probed> probed = Probe(*prepared, {.effects = {"sensor_offset", "inertia_change"}});
  ASSERT_TRUE(probed.ok());
  // Of phi no offset is seen, of w one of 0.01.
  const auto unmet = Unmet({"sensor_offset", 0.011}, probed->findings);
  for (const Finding* one : unmet) EXPECT_EQ(one->place, one->sign > 0 ? "output:phi" : one->place);
  EXPECT_EQ(Unmet({"inertia_change", 0.18}, probed->findings).size(), 1U) << "a heavier one passes";
  EXPECT_EQ(Unmet({"inertia_change", 0.15}, probed->findings).size(), 2U);
}

TEST(ProbeReport, ReadsDemands) {
  EXPECT_EQ(ParseDemand("stiffness_change=5%")->strength, 0.05);
  EXPECT_EQ(ParseDemand("stiffness_change=5 %")->strength, 0.05);
  EXPECT_EQ(ParseDemand("coulomb_friction=0.3")->strength, 0.3);
  EXPECT_EQ(ParseDemand("turned_sign")->strength, 0.0);
  for (const char* wrong : {"", "=3", "x=", "x=a", "x=-1", "x=1e999", "x=nan", "x=5%%"})
    EXPECT_FALSE(ParseDemand(wrong).has_value()) << wrong;
}

}  // namespace
}  // namespace dynoproof::probe
