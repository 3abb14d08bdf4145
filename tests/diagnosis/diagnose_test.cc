// Diagnosis by corrected prediction on records that the engine makes: nominal values drawn within their priors, noise of a
// hundredth, and one effect hidden, or none.
#include "diagnosis/diagnose.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

namespace fs = std::filesystem;
using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;

const char* const kScenario = "scenarios/diagnose/heavy_duty_lumped.toml";

/// The line as it was built: inertias within a percent, stiffnesses within 1.2, of what is written.
Plan AsBuilt(Plan plan) {
  int k = 0;
  for (Value::Entry& entry : plan.root["plant"]["inertia"].table())
    entry.value = Value(entry.value.number() * (1.0 + 0.01 * (k++ % 3 - 1)));
  for (Value::Entry& entry : plan.root["plant"]["shaft"].table()) {
    Value& stiffness = entry.value["stiffness_Nm_per_rad"];
    stiffness = Value(stiffness.number() * (1.0 + 0.012 * (k++ % 3 - 1)));
  }
  return plan;
}

const std::vector<std::string> kOutputs = {"T_shaft", "omega_1"};

Diagnosis DiagnosisOf(const MappedRecord& record) {
  const Plan plan = Scenario(kScenario, {"run.duration_s=0.5"});
  DiagnoseOptions options;
  const fs::path folder = fs::temp_directory_path() / ("diagnose_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  options.out = folder.string();
  options.scenario_file = kScenario;
  const Result<Diagnosis> result = Diagnose(plan, {record}, {}, testing::BuiltIns(), options);
  EXPECT_TRUE(result.ok()) << result.failure().ToString();
  fs::remove_all(folder);
  return result.ok() ? *result : Diagnosis();
}

Diagnosis DiagnosisOf(const Plan& truth, double noise, double pole = 0.0, bool in_motion = false, double hum = 0.0) {
  MappedRecord record = RecordOf(truth, noise, kOutputs, 5, pole);
  record.in_motion = in_motion;
  for (const std::string& output : kOutputs) {
    if (hum > 0.0) estimation::AddTone(record, output, 50.3, hum);
  }
  return DiagnosisOf(record);
}

Plan Nominal() { return Scenario(kScenario, {"run.duration_s=0.5"}); }

TEST(SlowDiagnose, NamesNothingWhereNothingIsHidden) {
  const Diagnosis found = DiagnosisOf(AsBuilt(Nominal()), 0.01);
  EXPECT_EQ(found.verdict, Conclusion::kNoEffect) << found.reason;
  EXPECT_TRUE(found.effects.empty());
  EXPECT_TRUE(found.at_noise_floor);
  EXPECT_LT(found.simulations, 1400.0);  // 942, and half as many more: a last bit may turn a fit
}

/// The record is the model's own run: no candidate is fitted, and the sizes at which effects would have shown are told.
TEST(SlowDiagnose, AsksNothingOfARecordThatTheModelPredictsFarBelowItsNoise) {
  const Diagnosis found = DiagnosisOf(Nominal(), 0.0);
  EXPECT_EQ(found.verdict, Conclusion::kNoEffect) << found.reason;
  EXPECT_EQ(found.journal.front().stage, "as given") << ToText(found.journal);
  EXPECT_FALSE(found.would_have_seen.empty());
  EXPECT_TRUE(found.search_complete);
  // Sizes that would have shown take some five runs each, of a hundred and fifty effects at places.
  EXPECT_LT(found.simulations, 1000.0);
  const Diagnosis hidden = DiagnosisOf(WithEffect(Nominal(), "coulomb_friction", "inertia:I3", {1.0}), 0.0);
  EXPECT_EQ(hidden.verdict, Conclusion::kEffectFound) << hidden.reason << "\n" << ToText(hidden.journal);
}

// Pairs of causes are asked before drifts of sensors are taken off, which takes 6000 simulations.
TEST(NightlyDiagnose, NamesNothingWhereAllSensorsWarmUp) {
  MappedRecord record = RecordOf(AsBuilt(Nominal()), 0.01, kOutputs);
  estimation::WarmUp(record, "T_shaft", 0.05);
  estimation::WarmUp(record, "omega_1", -0.08);
  const Diagnosis found = DiagnosisOf(record);
  EXPECT_EQ(found.verdict, Conclusion::kNoEffect) << found.reason << "\n" << ToText(found.journal);
  EXPECT_TRUE(std::ranges::any_of(found.notes, [](const std::string& note) {
    return note.find("of T_shaft, ") != std::string::npos && note.find("rad/s of omega_1") != std::string::npos;
  })) << "the drifts are told";
}

TEST(SlowDiagnose, NamesNothingWhereTheLineTurnsAtTheStartAndNoiseIsColoured) {
  Plan turning = AsBuilt(Nominal());
  turning.root["plant"]["initial_speed_rad_per_s"] = Value(2.3);
  const Diagnosis found = DiagnosisOf(turning, 0.01, 0.9, true);
  EXPECT_EQ(found.verdict, Conclusion::kNoEffect) << found.reason << "\n" << ToText(found.journal);
  EXPECT_TRUE(found.effects.empty());
}

TEST(SlowDiagnose, TakesHumOffBeforeItNamesACause) {
  const Diagnosis nothing = DiagnosisOf(AsBuilt(Nominal()), 0.01, 0.0, false, 0.04);
  EXPECT_EQ(nothing.verdict, Conclusion::kNoEffect) << nothing.reason << "\n" << ToText(nothing.journal);
  const auto told = [](const std::string& note) { return note.find("50.3 Hz") != std::string::npos; };
  EXPECT_TRUE(std::ranges::any_of(nothing.notes, told));
  const Diagnosis cause =
      DiagnosisOf(WithEffect(AsBuilt(Nominal()), "inertia_change", "inertia:I3", {0.08}), 0.01, 0.0, false, 0.04);
  EXPECT_EQ(cause.verdict, Conclusion::kEffectFound) << cause.reason << "\n" << ToText(cause.journal);
  ASSERT_EQ(cause.effects.size(), 1U);
  EXPECT_EQ(cause.effects[0].name + "@" + cause.effects[0].at, "inertia_change@inertia:I3");
}

/// A load that acts from the first sample on looks to the nominal model like a record that begins in motion.
TEST(SlowDiagnose, TakesARecordForOneThatBeginsAtRestWhereItsCauseIsExactFromThere) {
  const Diagnosis found =
      DiagnosisOf(WithEffect(AsBuilt(Nominal()), "constant_load", "inertia:I5", {25.0}), 0.01, 0.0, true);
  EXPECT_EQ(found.verdict, Conclusion::kEffectFound) << found.reason << "\n" << ToText(found.journal);
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].name + "@" + found.effects[0].at, "constant_load@inertia:I5");
  EXPECT_TRUE(std::ranges::any_of(found.notes,
                                  [](const std::string& note) { return note.find("own start") != std::string::npos; }));
  EXPECT_TRUE(std::ranges::none_of(found.refitted, &Refitted::start)) << "no start is fitted";
}

// A sensor's offset is the same to the record, and would be named.
TEST(SlowDiagnose, TakesAStartThatNoFirstSampleShows) {
  Plan turning = AsBuilt(Nominal());
  turning.root["plant"]["initial_speed_rad_per_s"] = Value(0.1);
  const Diagnosis found = DiagnosisOf(turning, 0.01);
  EXPECT_EQ(found.verdict, Conclusion::kNoEffect) << found.reason << "\n" << ToText(found.journal);
  const auto start = std::ranges::find(found.journal, "start", &JournalEntry::stage);
  ASSERT_NE(start, found.journal.end()) << ToText(found.journal);
  EXPECT_EQ(start->outcome, "leaves nothing but noise, and is taken");
}

TEST(SlowDiagnose, NamesADelayOfACommandAndNotOfASensor) {
  const Diagnosis found =
      DiagnosisOf(WithEffect(AsBuilt(Nominal()), "actuator_delay", "input:T_airgap", {2.5e-4}), 0.01);
  ASSERT_EQ(found.verdict, Conclusion::kEffectFound) << found.reason;
  EXPECT_EQ(found.effects[0].name + "@" + found.effects[0].at, "actuator_delay@input:T_airgap");
  EXPECT_NEAR(found.effects[0].parameters[0].value, 2.5e-4, 5e-6);
  // A 95 % interval: of twenty draws one lies outside, and hardly any by half as much again.
  const FoundParameter& delay = found.effects[0].parameters[0];
  EXPECT_LT(std::abs(delay.value - 2.5e-4), 0.75 * (delay.upper - delay.lower));
  EXPECT_LT(delay.upper - delay.lower, 1e-6);
  EXPECT_FALSE(found.journal.empty());
  EXPECT_LT(found.simulations, 3000.0);  // 1974, and half as many more
}

TEST(NightlyDiagnose, NamesDryFrictionAtItsPlace) {
  const Diagnosis found = DiagnosisOf(WithEffect(AsBuilt(Nominal()), "coulomb_friction", "inertia:I5", {30.0}), 0.005);
  ASSERT_EQ(found.verdict, Conclusion::kEffectFound) << found.reason;
  EXPECT_EQ(found.effects[0].name + "@" + found.effects[0].at, "coulomb_friction@inertia:I5");
  EXPECT_NEAR(found.effects[0].parameters[0].value, 30.0, 1.5);
}

/// Without noise everything counts that a fit has not come to: the limit of what is seen is 1e-4 of each output.
TEST(SlowDiagnose, NamesADeadZoneAloneInARecordWithoutNoise) {
  const Diagnosis found =
      DiagnosisOf(WithEffect(AsBuilt(Nominal()), "actuator_dead_zone", "input:T_airgap", {62.5}), 0.0);
  ASSERT_EQ(found.verdict, Conclusion::kEffectFound) << found.reason << "\n" << ToText(found.journal);
  ASSERT_EQ(found.effects.size(), 1u) << found.reason;
  EXPECT_EQ(found.effects[0].name + "@" + found.effects[0].at, "actuator_dead_zone@input:T_airgap");
  const FoundParameter& width = found.effects[0].parameters[0];
  EXPECT_NEAR(width.value, 62.5, 0.05);
  EXPECT_LT(width.lower, 62.5);
  EXPECT_GT(width.upper, 62.5);
}

TEST(SlowDiagnose, NamesTwoCausesOneAfterTheOther) {
  const Plan one = WithEffect(AsBuilt(Nominal()), "actuator_delay", "input:T_airgap", {2.5e-4});
  const Diagnosis found = DiagnosisOf(WithEffect(one, "sensor_gain", "output:omega_1", {1.08}), 0.01);
  ASSERT_EQ(found.verdict, Conclusion::kEffectFound) << found.reason << "\n" << ToText(found.journal);
  ASSERT_EQ(found.effects.size(), 2u);
  std::map<std::string, double> sizes;
  for (const FoundEffect& effect : found.effects) sizes[effect.name + "@" + effect.at] = effect.parameters[0].value;
  EXPECT_NEAR(sizes["actuator_delay@input:T_airgap"], 2.5e-4, 5e-6);
  EXPECT_NEAR(sizes["sensor_gain@output:omega_1"], 1.08, 0.01);
}

/// A plant without states and without numbers of its own: one level, and columns of effects alone.
TEST(Diagnose, NamesWhatAMotorWithoutNumbersLacks) {
  const Plan plan = estimation::HeldMotor(100);
  const MappedRecord record =
      estimation::Slower(RecordOf(WithEffect(plan, "torque_ripple", "inertia:rotor", {0.1, 72.0, 0.5}), 0.1, {"F"}), 5);
  DiagnoseOptions options;
  const fs::path folder = fs::temp_directory_path() / ("diagnose_motor_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  options.out = folder.string();
  options.scenario_file = "tests/real/cogging_standstill.toml";
  const Result<Diagnosis> found = Diagnose(plan, {record}, {}, testing::BuiltIns(), options);
  fs::remove_all(folder);
  ASSERT_TRUE(found.ok()) << found.failure().ToString();
  EXPECT_EQ(found->verdict, Conclusion::kEffectFound) << found->reason << "\n" << ToText(found->journal);
  ASSERT_EQ(found->effects.size(), 1u);
  EXPECT_EQ(found->effects[0].name, "torque_ripple");
  const FoundParameter& order = found->effects[0].parameters[1];
  EXPECT_LT(order.lower, 72.0);
  EXPECT_GT(order.upper, 72.0);
}

}  // namespace
}  // namespace dynoproof::diagnosis
