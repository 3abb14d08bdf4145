// Numbers far off, by runs that the record corrects.
#include "identification/corrected_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "base/random.h"
#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::identification {
namespace {

using estimation::FourMasses;
using estimation::RecordOf;

/// A line of four masses, and six of its numbers each off by a random factor, `most` at most up or down (two standard
/// deviations of its logarithm).
struct FarOff {
  FarOff(double most, std::uint64_t seed) : truth(FourMasses(1.2)), nominal(truth) {
    std::uint64_t i = 0;
    for (const char* key : {"plant.inertia.I3", "plant.inertia.I4", "plant.shaft.k1.stiffness_Nm_per_rad",
                            "plant.shaft.k2.stiffness_Nm_per_rad", "plant.shaft.k3.stiffness_Nm_per_rad",
                            "plant.shaft.k3.damping_Nms_per_rad"}) {
      Value& value = *nominal.root.FindPath(key);
      value = Value(value.number() * std::pow(most, 2.0 * RandomUniform(seed, 3, i++) - 1.0));
      free.push_back({key, std::nullopt});
    }
    record = RecordOf(truth, 0.005, {"T_shaft", "omega_1"}, seed);
  }
  Plan truth, nominal;
  std::vector<FreeKey> free;
  MappedRecord record;
};

/// How many numbers are within `share` of the truth, and within their intervals.
std::pair<int, int> Hits(const Identified& found, const Plan& truth, double share) {
  int near = 0, inside = 0;
  for (const IdentifiedValue& one : found.values) {
    const double value = truth.root.FindPath(one.key)->number();
    near += std::abs(one.value / value - 1.0) < share;
    inside += one.interval && one.interval->first <= value && value <= one.interval->second;
  }
  return {near, inside};
}

TEST(SlowCorrectedFit, FindsSixNumbersOffByHalf) {
  int all_inside = 0;
  for (const std::uint64_t seed : {4U, 5U, 6U}) {
    const FarOff line(1.5, seed);
    const Result<Identified> found =
        Identify(line.nominal, {line.record}, testing::BuiltIns(), {line.free, "corrected"});
    ASSERT_TRUE(found.ok()) << found.failure().ToString();
    const auto [near, inside] = Hits(*found, line.truth, 0.01);
    EXPECT_EQ(near, 6) << seed;
    all_inside += inside;
    ASSERT_TRUE(found->level.has_value());
    EXPECT_FALSE(found->level->memory_s.has_value()) << "an exact model is judged in the free run";
    EXPECT_LT(found->nrmse_after, 0.0055);  // the noise is 0.005
    EXPECT_LT(found->level->simulations, 4000);
    EXPECT_TRUE(found->doubts.empty());
  }
  EXPECT_GE(all_inside, 15);  // of 18 at 95 %: fewer in one of two hundred
}

/// Identifies six numbers by the corrected run, which finds them, and by the free run, which ends elsewhere.
void ExpectTheFreeRunAstray(std::uint64_t seed) {
  const FarOff line(2.0, seed);
  for (const std::string method : {"corrected", "free_run"}) {
    const Result<Identified> found = Identify(line.nominal, {line.record}, testing::BuiltIns(), {line.free, method});
    ASSERT_TRUE(found.ok()) << found.failure().ToString();
    const bool all = Hits(*found, line.truth, 0.01).first == 6;
    EXPECT_EQ(all, method == "corrected") << seed << " by " << method;
  }
}

TEST(SlowCorrectedFit, FindsThemWhereTheFreeRunEndsInAnotherMinimum) { ExpectTheFreeRunAstray(2); }

TEST(NightlyCorrectedFit, FindsThemWhereTheFreeRunEndsInAnotherMinimum) {
  for (const std::uint64_t seed : {4U, 6U}) ExpectTheFreeRunAstray(seed);
}

/// One mass of 2 kg m^2 with dry friction, swung at two frequencies.
Plan Rubbing(double friction_Nm, double duration_s) {
  Plan plan = testing::OneMass(2.0,
                               Value{{"type", "sine_sum"},
                                     {"amplitudes", Value::Array{30.0, 10.0}},
                                     {"frequencies_Hz", Value::Array{1.3, 9.0}},
                                     {"phases_rad", Value::Array{0.0, 1.0}}},
                               duration_s);
  plan.root["plant"]["load"]["friction"] = Value{{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", friction_Nm}};
  return plan;
}

/// Two records of one machine, whose friction has grown by a fifth between them: no single number explains both.
TEST(CorrectedFit, ANumberThatDiffersFromRecordToRecordHasItsValueInEach) {
  std::vector<MappedRecord> records;
  for (const double friction : {4.0, 4.8}) {
    records.push_back(RecordOf(Rubbing(friction, 2.0), 0.002, {"w"}));
    records.back().file = "bench_" + std::to_string(records.size()) + ".csv";
  }
  Plan nominal = Rubbing(3.0, 2.0);
  *nominal.root.FindPath("plant.inertia.I") = Value(2.2);
  const IdentifyOptions options = {{{"plant.inertia.I", std::nullopt}, {"plant.load.friction.T_c_Nm", std::nullopt}},
                                   "corrected"};
  const Result<Identified> one = Identify(nominal, records, testing::BuiltIns(), options);
  ASSERT_TRUE(one.ok()) << one.failure().ToString();
  EXPECT_TRUE(one->of_records.empty());
  nominal.root["prior"]["plant.load.friction.T_c_Nm"] = Value{{"spread", "20 %"}, {"per_record", true}};
  const Result<Identified> each = Identify(nominal, records, testing::BuiltIns(), options);
  ASSERT_TRUE(each.ok()) << each.failure().ToString();
  ASSERT_EQ(each->of_records.size(), 2U);
  EXPECT_LT(each->nrmse_after, 0.1 * one->nrmse_after);
  EXPECT_NEAR(each->values[0].value, 2.0, 0.002);
  const double common = each->values[1].value;
  EXPECT_NEAR(common, std::sqrt(4.0 * 4.8), 0.05) << "the prior holds both alike";
  for (const ValueOfRecord& of : each->of_records) {
    const double truth = of.record == 0 ? 4.0 : 4.8;
    EXPECT_NEAR(common * of.factor, truth, 0.01) << of.file;
    EXPECT_EQ(of.file, of.record == 0 ? "bench_1.csv" : "bench_2.csv");
    EXPECT_LT(of.interval.first, truth / std::sqrt(4.0 * 4.8));
    EXPECT_GT(of.interval.second, truth / std::sqrt(4.0 * 4.8));
  }
  const std::string table = ToTable(*each);
  EXPECT_NE(table.find("plant.load.friction.T_c_Nm in bench_2.csv"), std::string::npos) << table;
}

/// Dry friction and a mass, both unknown, of a model that knows nothing of a drag beside them.
TEST(SlowCorrectedFit, OfAnInexactModelTellsHowMuchIsUnknown) {
  Plan truth = Rubbing(4.0, 4.0);
  Plan nominal = truth;
  truth.root["plant"]["load"]["unlisted"] = Value{{"on", "I"}, {"law", "quadratic_drag"}, {"b2_Nms2_per_rad2", 0.02}};
  nominal.root.FindPath("plant.load.friction")->operator[]("T_c_Nm") = Value(0.0);
  *nominal.root.FindPath("plant.inertia.I") = Value(2.6);
  const MappedRecord record = RecordOf(truth, 0.002, {"w"});
  const Result<Identified> found = Identify(
      nominal, {record}, testing::BuiltIns(),
      {{{"plant.inertia.I", std::nullopt}, {"plant.load.friction.T_c_Nm", std::pair(0.0, 50.0)}}, "corrected"});
  ASSERT_TRUE(found.ok()) << found.failure().ToString();
  ASSERT_TRUE(found->level.has_value());
  EXPECT_TRUE(found->level->memory_s.has_value());
  EXPECT_GT(found->level->share, 0.001);
  for (const IdentifiedValue& one : found->values) {
    const double value = truth.root.FindPath(one.key)->number();
    EXPECT_NEAR(one.value / value, 1.0, 0.03)
        << one.key;  // of the drag that nobody listed, 4 % of the friction at its peak
    EXPECT_TRUE(one.interval.has_value()) << one.key;
  }
}

TEST(SlowCorrectedFit, FindsTheFrictionOfAMeasuredServoAxis) {
  const std::string file = "../shared/data/servo_axis/DATA_EMPS.mat";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the public record is not here: " << file;
  const Plan plan = estimation::Scenario("tests/real/servo_axis.toml");
  Diagnostics diagnostics;
  const std::optional<MappedRecord> record =
      OpenRecord(file, "tests/real/servo_axis_map.toml", {{"F", "N m"}}, {{"x", "rad"}}, diagnostics);
  ASSERT_TRUE(record.has_value()) << diagnostics.Format();
  const auto bound = std::pair(0.0, 200.0);
  const Result<Identified> found = Identify(plan, {*record}, testing::BuiltIns(),
                                            {{{"plant.inertia.carriage", std::nullopt},
                                              {"plant.load.friction.T_c_pos_Nm", bound},
                                              {"plant.load.friction.T_c_neg_Nm", bound},
                                              {"plant.load.friction.b_pos_Nms_per_rad", std::nullopt},
                                              {"plant.load.friction.b_neg_Nms_per_rad", std::nullopt}},
                                             "corrected"});
  ASSERT_TRUE(found.ok()) << found.failure().ToString();
  // Published (Janot, Gautier, Brunot 2019, by direction): what another estimator finds in the same record.
  const std::vector<double> published = {95.11, 20.14, 20.63, 166.7, 240.4};
  for (std::size_t i = 0; i < published.size(); ++i) {
    const IdentifiedValue& one = found->values[i];
    EXPECT_NEAR(one.value / published[i], 1.0, 0.03) << one.key;
    ASSERT_TRUE(one.interval.has_value()) << one.key;
    EXPECT_LE(one.interval->first, published[i]) << one.key;
    EXPECT_GE(one.interval->second, published[i]) << one.key;
  }
}

}  // namespace
}  // namespace dynoproof::identification
