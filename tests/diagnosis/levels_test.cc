// The ways in which models are run beside a data set, and how finely.
#include "diagnosis/levels.h"

#include <gtest/gtest.h>

#include "diagnosis/parts.h"
#include "diagnosis/policy.h"
#include "identification/estimation_problem.h"
#include "model/kept_modes.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;

TEST(Levels, OfAPlantWithoutStatesAreTheFreeRunAlone) {
  const auto input = [](const char* to, const char* unit, double phase_rad) {
    return Value{{"to", to},
                 {"unit", unit},
                 {"nominal", 0.1},
                 {"source", Value{{"type", "sine_sum"},
                                  {"amplitudes", Value::Array{0.1}},
                                  {"frequencies_Hz", Value::Array{1.0}},
                                  {"phases_rad", Value::Array{phase_rad}}}}};
  };
  const Plan plan{"damper", "damper.toml",
                  Value{{"run", Value{{"duration_s", 2.0}, {"period_s", 1e-3}}},
                        {"plant", Value{{"type", "moved_body"},
                                        {"body", "rod"},
                                        {"damping_Ns_per_m", 1900.0},
                                        {"stiffness_N_per_m", 1300.0},
                                        {"nominal_force_N", 1000.0}}},
                        {"input", Value{{"x", input("plant.x", "m", 0.0)}, {"v", input("plant.v", "m/s", 1.5)}}},
                        {"output", Value{{"F", Value{{"of", "plant.force"}, {"unit", "N"}, {"nominal", 1000.0}}}}}}};
  const auto levels = Levels::Of(plan, {RecordOf(plan, 0.01, {"F"})}, testing::BuiltIns(), 0.0, 1000);
  ASSERT_TRUE(levels.ok()) << levels.failure().ToString();
  EXPECT_EQ((*levels)->size(), 1u);
  EXPECT_EQ((*levels)->Name(0), "free run");
}

/// What judges begins in each record behind the share of it that models are fitted to, however long the others are.
TEST(Levels, OfRecordsOfDifferentLengthCompareTheSameShareOfEach) {
  const Plan plan = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.3"});
  std::vector<MappedRecord> records(2, RecordOf(plan, 0.01, {"T_shaft"}));
  identification::CutRecord(records[0], 0.4);
  const auto levels = Levels::Of(plan, records, testing::BuiltIns(), kFittedShare, 10'000);
  ASSERT_TRUE(levels.ok()) << levels.failure().ToString();
  const estimation::DataSet& data = (*levels)->data();
  ASSERT_EQ(data.channels().size(), 2U);
  for (const estimation::Channel& channel : data.channels()) {
    const double end_s = records[channel.record].end_s;
    ASSERT_GT(channel.count, 0);
    EXPECT_NEAR(data.time_s()[static_cast<std::size_t>(channel.begin)], kFittedShare * end_s, 2e-4);
    EXPECT_NEAR(data.time_s()[static_cast<std::size_t>(channel.begin + channel.count - 1)], end_s, 2e-4);
  }
}

/// Where impacts come at other times altogether, all ways lead down beside a record that corrects five times as hard, and from the wrong side of a
/// hump else.
TEST(Levels, BehindAGapBeginWithAShorterMemoryWhereThePlanHasLostSight) {
  const Plan plan = Scenario("scenarios/diagnose/backlash.toml", {"run.duration_s=0.5"});
  const auto levels_of = [&](const Plan& truth) {
    auto levels = Levels::Of(plan, {RecordOf(truth, 0.002, {"T_m1", "T_m2", "omega_1", "omega_2", "omega_3"})},
                             testing::BuiltIns(), 0.0, 1000);
    EXPECT_TRUE(levels.ok()) << levels.failure().ToString();
    return *std::move(levels);
  };
  const auto near = levels_of(plan),
             far = levels_of(estimation::WithEffect(plan, "gap_change", "shaft:backlash", {0.17}));
  EXPECT_EQ(near->size(), 2U);
  ASSERT_EQ(far->size(), 3U);
  EXPECT_EQ(far->longest(), 2U);
  EXPECT_EQ(far->corrected(), 2U);
  EXPECT_NEAR((*far)[0].observer()->memory_s() * policy::kLonger, (*far)[1].observer()->memory_s(), 2e-3);
}

/// Both parts of a record are corrected with the same noise. With an estimate each, of which one took fast motion for noise, one memory gave two
/// different observers, and a model that was exact in the earlier part diverged in the later one. Other records have their own noise.
TEST(Levels, OfALaterPartHaveTheNoiseOfTheEarlierOne) {
  const Plan plan = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.3"});
  const MappedRecord whole = RecordOf(plan, 0.0, {"T_shaft", "omega_1"});
  MappedRecord first = whole;
  identification::CutRecord(first, 0.4);
  const auto training = Levels::Of(plan, {first}, testing::BuiltIns(), 0.0, 10'000);
  ASSERT_TRUE(training.ok());
  const auto later = Levels::Of(plan, {whole}, testing::BuiltIns(), 0.4, 10'000, training->get()),
             other = Levels::Of(plan, {whole}, testing::BuiltIns(), 0.0, 10'000, training->get());
  ASSERT_TRUE(later.ok() && other.ok());
  for (std::size_t c = 0; c < 2; ++c) {
    const double noise = (*training)->data().channels()[c].noise;
    EXPECT_EQ((*later)->data().channels()[c].noise, noise);
    EXPECT_NE((*other)->data().channels()[c].noise, noise);
  }
}

/// A volume forgets by itself within tenths of a second: no correction gives it a longer memory, and a level is not told twice.
TEST(Levels, HaveEachALongerMemoryThanTheOneBefore) {
  const Plan plan = Scenario("scenarios/diagnose/fuel_gas.toml", {"run.duration_s=20"});
  const auto levels = Levels::Of(plan, {RecordOf(plan, 0.01, {"p_g"})}, testing::BuiltIns(), 0.0, 20'000);
  ASSERT_TRUE(levels.ok()) << levels.failure().ToString();
  const Levels& all = **levels;
  ASSERT_GE(all.size(), 3U);
  for (std::size_t level = 1; level < all.free_run(); ++level)
    EXPECT_GT(all[level].observer()->memory_s(), 1.05 * all[level - 1].observer()->memory_s()) << all.Name(level);
  EXPECT_EQ(all.longest(), all.free_run() - 1);
  EXPECT_TRUE(all[all.free_run()].free_run());
}

/// Substeps in which a scenario is searched beside its own run.
int SubstepsFor(const Plan& plan, const std::string& output) {
  const auto levels = Levels::Of(plan, {RecordOf(plan, 0.01, {output})}, testing::BuiltIns(), 0.0, 1000);
  if (!levels.ok()) {
    ADD_FAILURE() << levels.failure().ToString();
    return 0;
  }
  return SubstepsOf(InFewerSubsteps(plan, **levels, testing::BuiltIns()));
}

/// A rotor of a hundred slices is searched with its slow modes, as many as the record sees.
TEST(WithFewerModes, KeepsWhatTheRecordSees) {
  const auto kept = [](const char* scenario, const char* output, double noise) {
    const Plan plan = Scenario(scenario, {"run.duration_s=0.2"});
    const auto levels = Levels::Of(plan, {RecordOf(plan, noise, {output})}, testing::BuiltIns(), 0.0, 1000);
    return levels.ok() ? RotorModes(WithFewerModes(plan, **levels)) : -1;
  };
  EXPECT_EQ(kept("scenarios/diagnose/coupling.toml", "T", 1e-2), policy::kRotorModes[0]);
  EXPECT_EQ(kept("scenarios/diagnose/coupling.toml", "T", 1e-6), 0);
  EXPECT_EQ(kept("scenarios/diagnose/heavy_duty_lumped.toml", "T_shaft", 1e-2), 0);
}

/// An observer that moves modes which a run has given up corrects it amiss: levels are made anew for a line with fewer modes.
TEST(WithFewerModes, AreCorrectedAsWellByLevelsOfTheirOwn) {
  const Plan plan = Scenario("scenarios/diagnose/coupling.toml", {"run.duration_s=0.4"});
  const MappedRecord record = RecordOf(plan, 1e-3, {"T", "omega_d"});
  const auto levels_of = [&](const Plan& one) {
    auto levels = Levels::Of(one, {record}, testing::BuiltIns(), 0.0, 4000);
    EXPECT_TRUE(levels.ok());
    return *std::move(levels);
  };
  const auto worst = [](const Plan& one, const Levels& levels) {
    const auto there = levels[0].Predict(one);
    double most = 0.0;
    for (const auto& scale : estimation::ScalesOf(levels.data(), there->innovations, there->noise_alone))
      most = std::max(most, scale.rms / scale.noise_alone);
    return most;
  };
  Plan fewer = plan;
  SetRotorModes(fewer, policy::kRotorModes[0]);
  const auto of_all = levels_of(plan), of_fewer = levels_of(fewer);
  EXPECT_LT(worst(plan, *of_all), 1.1);
  EXPECT_LT(worst(fewer, *of_fewer), 1.1);
  EXPECT_LT(worst(plan, *of_fewer), 1.1);
  EXPECT_GT(worst(fewer, *of_all), 1.2);
}

TEST(InFewerSubsteps, AreAsManyAsTheRecordSees) {
  // Volumes of tenths of a second, in periods of 20 ms.
  Plan air = Scenario("scenarios/diagnose/charge_air.toml", {"run.duration_s=20"});
  SetSubsteps(air, 4);
  EXPECT_EQ(SubstepsFor(air, "p_ch"), 1);
  // Impacts are elsewhere with other steps.
  Plan play = Scenario("scenarios/diagnose/backlash.toml", {"run.duration_s=0.3"});
  SetSubsteps(play, 4);
  EXPECT_EQ(SubstepsFor(play, "omega_1"), 4);
  // A linear line is carried exactly; its substeps are for the friction that an effect may bring.
  Plan line = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.2"});
  SetSubsteps(line, 4);
  EXPECT_EQ(SubstepsFor(line, "T_shaft"), 4);
}

}  // namespace
}  // namespace dynoproof::diagnosis
