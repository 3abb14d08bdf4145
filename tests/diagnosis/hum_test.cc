// Hum in what a model leaves: found where it is, and not where a machine answers its inputs.
#include "diagnosis/hum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "diagnosis/taken_off.h"
#include "score/series.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::AddTone;
using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;

Plan Nominal() { return Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.7"}); }

std::vector<Hum> FoundIn(const Plan& plan, const MappedRecord& record) {
  return FindHum({plan, {record}, testing::BuiltIns()}, plan);
}

double Distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a[i] - b[i], 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(Hum, IsFoundAndTakenOff) {
  const Plan plan = Nominal();
  const MappedRecord clean = RecordOf(plan, 0.01, {"T_shaft", "omega_1"});
  MappedRecord record = clean;
  AddTone(record, "T_shaft", 50.37, 0.03);
  const std::vector<Hum> hum = FoundIn(plan, record);
  ASSERT_EQ(hum.size(), 1U);
  EXPECT_EQ(hum[0].signal, "T_shaft");
  EXPECT_NEAR(hum[0].frequency_hz, 50.37, 0.03);
  EXPECT_NEAR(hum[0].share, 0.03 / std::numbers::sqrt2, 1e-3);
  std::vector<MappedRecord> cleaned = {record};
  TakeOff(hum, cleaned);
  const std::vector<double>& is = *cleaned[0].outputs.at("T_shaft").values;
  EXPECT_LT(Distance(is, *clean.outputs.at("T_shaft").values), 1e-3 * score::StandardDeviation(is));
  EXPECT_TRUE(FoundIn(plan, cleaned[0]).empty());
}

TEST(Hum, IsNoneInNoiseAlone) {
  const Plan plan = Nominal();
  EXPECT_TRUE(FoundIn(plan, RecordOf(plan, 0.01, {"T_shaft", "omega_1"})).empty());
}

/// A stiffness that is a twentieth off leaves its mode, which the input drives over some width.
TEST(Hum, IsNoneWhereAModeIsElsewhere) {
  const Plan plan = Nominal();
  for (const char* shaft : {"shaft:k1", "shaft:k2", "shaft:k3", "shaft:k4"}) {
    const Plan truth = WithEffect(plan, "stiffness_change", shaft, {0.05});
    EXPECT_TRUE(FoundIn(plan, RecordOf(truth, 0.001, {"T_shaft", "omega_1"})).empty()) << shaft;
  }
}

TEST(Hum, IsNoneThatDiesAwayOrIsLarge) {
  const Plan plan = Nominal();
  MappedRecord record = RecordOf(plan, 0.001, {"T_shaft"}), large = record;
  Series& series = record.outputs.at("T_shaft");
  std::vector<double> values = *series.values;
  const double amplitude = 0.05 * score::StandardDeviation(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = (*series.time)[i];
    values[i] += amplitude * std::exp(-t / 0.7) * std::sin(2.0 * std::numbers::pi * 150.0 * t);
  }
  series.values = std::make_shared<const std::vector<double>>(std::move(values));
  EXPECT_TRUE(FoundIn(plan, record).empty()) << "it is less than half as large in the second half";
  AddTone(large, "T_shaft", 150.0, 0.5);
  EXPECT_TRUE(FoundIn(plan, large).empty());
}

/// Friction at a light body strikes a mode at 1560 Hz each time that it sticks or slips: a line as narrow as hum, not as steady.
TEST(Hum, IsNoneWhereFrictionRings) {
  const Plan plan = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=1.0"});
  const Plan truth = WithEffect(plan, "coulomb_friction", "inertia:I4", {15.4});
  EXPECT_TRUE(FoundIn(plan, RecordOf(truth, 0.004, {"T_shaft", "omega_1"})).empty());
}

/// The third multiple of a sine is what a bent characteristic makes of it.
TEST(Hum, IsNoneWhereASineDrives) {
  const Plan plan =
      Scenario("scenarios/diagnose/heavy_duty_lumped.toml",
               {"run.duration_s=0.7",
                "input.T_airgap.source={ type = \"sine_sum\", amplitudes = [800.0], frequencies_Hz = [40.0], "
                "phases_rad = [0.0] }"});
  MappedRecord record = RecordOf(plan, 0.001, {"T_shaft"});
  for (const double multiple : {40.0, 120.0}) {
    MappedRecord disturbed = record;
    AddTone(disturbed, "T_shaft", multiple, 0.03);
    EXPECT_TRUE(FoundIn(plan, disturbed).empty()) << multiple;
  }
  AddTone(record, "T_shaft", 50.0, 0.03);
  EXPECT_EQ(FoundIn(plan, record).size(), 1U) << "beside its multiples";
}

}  // namespace
}  // namespace dynoproof::diagnosis
