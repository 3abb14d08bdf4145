// Outputs that stand still: a fault where the simulation moves, and nothing where it does not either.
#include <gtest/gtest.h>

#include <algorithm>

#include "diagnosis/data_check.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;

/// Outputs of which a check of the record against the plan says that they are constant and should not be.
std::vector<std::string> FaultsOf(const Plan& plan, const MappedRecord& record) {
  const Result<std::vector<Finding>> findings = CheckAgainst(EstimationProblem(plan, {record}, testing::BuiltIns()));
  EXPECT_TRUE(findings.ok());
  std::vector<std::string> columns;
  for (const Finding& one : *findings) {
    if (one.fault && one.kind == "constant") columns.push_back(one.column);
  }
  return columns;
}

TEST(StillOutput, IsAFaultWhereTheSimulationMoves) {
  const Plan plan = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.2"});
  MappedRecord record = RecordOf(plan, 0.0, {"T_shaft", "omega_1"});
  Series& stuck = record.outputs.at("omega_1");
  stuck.values = std::make_shared<const std::vector<double>>(stuck.values->size(), 100.0);
  EXPECT_EQ(FaultsOf(plan, record), std::vector<std::string>{"omega_1"});
}

TEST(StillOutput, IsNoneWhereTheSimulationStandsStillAsWell) {
  const Plan plan = Scenario("scenarios/heavy_duty/control_c_oscillation.toml", {"run.duration_s=0.2"});
  EXPECT_TRUE(FaultsOf(plan, RecordOf(plan, 0.0, {"T_shaft", "eta_1", "outcome", "placements"})).empty());
}

}  // namespace
}  // namespace dynoproof::diagnosis
