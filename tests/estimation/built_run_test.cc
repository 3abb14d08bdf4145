#include "estimation/built_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/simulate.h"
#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::estimation {
namespace {

using ::testing::HasSubstr;

TEST(BuildRun, RunsThePlanByTheRecordsInputs) {
  const Plan plan = FourMasses(0.2);
  const MappedRecord record = RecordOf(plan, 0.0, {"omega_1"});
  Plan other = plan;  // its own torque is not asked for
  other.root["input"]["T"]["source"] = Value{{"type", "constant"}, {"value", 0.0}};
  const Result<BuiltRun> run = BuildRun(other, record, testing::BuiltIns());
  ASSERT_TRUE(run.ok()) << run.failure().ToString();
  const Result<Samples> samples = Simulate(*run->rig, *run->solver);
  ASSERT_TRUE(samples.ok());
  const auto line = std::ranges::find(run->rig->outputs, "omega_1", &OutputLine::name) - run->rig->outputs.begin();
  const std::vector<double>& measured = *record.outputs.at("omega_1").values;
  ASSERT_EQ(samples->outputs[static_cast<std::size_t>(line)].size(), measured.size());
  const double spread = score::StandardDeviation(measured);
  for (std::size_t i = 0; i < measured.size(); ++i)
    ASSERT_NEAR(samples->outputs[static_cast<std::size_t>(line)][i], measured[i], 1e-9 * spread) << i;
}

TEST(BuildRun, KnownDecompositionsChangeNoBit) {
  const Plan plan = FourMasses(0.05);
  const MappedRecord record = RecordOf(plan, 0.0, {"omega_1"});
  mechanics::Decompositions known;
  std::vector<std::vector<double>> first;
  for (int k = 0; k < 3; ++k) {
    const Result<BuiltRun> run = BuildRun(plan, record, testing::BuiltIns(), k == 0 ? nullptr : &known);
    ASSERT_TRUE(run.ok());
    const Result<Samples> samples = Simulate(*run->rig, *run->solver);
    ASSERT_TRUE(samples.ok());
    if (k == 0) first = samples->outputs;
    EXPECT_EQ(samples->outputs, first);
  }
}

TEST(BuildRun, TellsTheFirstFaultOfAPlan) {
  const Plan plan = FourMasses(0.05);
  const MappedRecord record = RecordOf(plan, 0.0, {"omega_1"});
  Plan broken = plan;
  broken.root["plant"]["inertia"]["I3"] = Value(-1.0);
  const Result<BuiltRun> run = BuildRun(broken, record, testing::BuiltIns());
  ASSERT_FALSE(run.ok());
  EXPECT_THAT(run.failure().message, HasSubstr("I3"));
  EXPECT_EQ(run.failure().exit_code, 2);
}

}  // namespace
}  // namespace dynoproof::estimation
