// The judgement of a run's filters by eigenvalues: the loop that it reads from a scenario, and what it calls a failure.
#include "thesis/check_filters.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "experiment/prepare.h"
#include "experiment/run_scenario.h"
#include "tests/support/registry.h"
#include "thesis/machine_scenario.h"

namespace dynoproof {
namespace {

std::unique_ptr<Prepared> Changed(const std::vector<std::string>& changes) {
  Diagnostics diagnostics;
  auto prepared = Prepare("scenarios/suppression/adaptive_machine.toml", {changes, "", nullptr},
                          testing::FullRegistry(), diagnostics);
  EXPECT_NE(prepared, nullptr) << diagnostics.Format();
  return prepared;
}

/// A run judged by this check alone.
ScenarioResult Judged(std::vector<std::string> changes) {
  changes.push_back(
      "check=[{ kind = \"filters_hold\", notches = [\"notch_1\", \"notch_2\"], gain = \"k_V\", near_Hz = 20.0, origin "
      "= \"test\" }]");
  RunOptions options;
  options.out = "";
  return RunScenario(*Changed(changes), options);
}

TEST(MachineScenario, IsTheLoopThatTheStudiesCompute) {
  const auto prepared = Changed({"plant.inertia.I5=0.09", "control.machine.current_bandwidth_Hz=170.0"});
  const auto read = MachineLoopOf(prepared->plan, *prepared->rig, 3000.0),
             made = MachineLoop::Create(R2RPlant(0.09), VascatDrive(170.0), 0, 3000.0);
  ASSERT_TRUE(read.ok() && made.ok());
  const auto of_read = read->Modes(9.7, {}), of_made = made->Modes(9.7, {});
  ASSERT_TRUE(of_read.ok() && of_made.ok());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR((*of_read)[i].growth_per_s, (*of_made)[i].growth_per_s, 1e-6);  // round-off: 1e-16 of 1e3, over 1e-4 s
    EXPECT_NEAR((*of_read)[i].frequency_hz, (*of_made)[i].frequency_hz, 1e-6);
  }
}

TEST(FiltersHold, PassesWhereBothFiltersStandRight) {
  const ScenarioResult result = Judged({"run.duration_s=1.2"});
  EXPECT_EQ(result.verdict, score::Verdict::kPass);
  EXPECT_EQ(result.figures.at("growing").value, 2.0);
  EXPECT_EQ(result.figures.at("found").value, 2.0);
  EXPECT_EQ(result.figures.at("placed").value, 2.0);
}

TEST(FiltersHold, SeesWhatIsLeftUnstable) {
  const ScenarioResult result = Judged({"run.duration_s=0.1", "input.adapt.source.value=0.0"});
  EXPECT_EQ(result.verdict, score::Verdict::kFail);
  EXPECT_EQ(result.figures.at("found").value, 0.0);
  EXPECT_EQ(result.figures.at("unstable_at_end").value, 1.0);
  EXPECT_EQ(result.figures.at("beyond_filters").value, 0.0) << "at 150 Hz two filters hold the loop";
  const ScenarioResult fast =
      Judged({"run.duration_s=0.1", "input.adapt.source.value=0.0", "control.machine.current_bandwidth_Hz=300.0"});
  EXPECT_EQ(fast.figures.at("beyond_filters").value, 1.0) << "at 300 Hz none do";
}

TEST(FiltersHold, SeesAFilterWhereNothingGrew) {
  // At k_V = 2.1 nothing grows near 700 Hz; a steady load there passes the scheme's four conditions.
  const ScenarioResult result =
      Judged({"run.duration_s=0.6", "input.k_V.source.value=2.1",
              "input.T_load.source={ type = \"sine_sum\", amplitudes = [1000.0], frequencies_Hz = [700.0] }"});
  EXPECT_EQ(result.verdict, score::Verdict::kFail);
  EXPECT_GE(result.figures.at("false_placements").value, 1.0);
}

TEST(FiltersHold, IsRefusedWithoutAMachine) {
  Diagnostics diagnostics;
  const auto prepared = Prepare("scenarios/suppression/adaptive.toml",
                                {{"check=[{ kind = \"filters_hold\", notches = [\"notch_1\"], gain = \"k_V\", near_Hz "
                                  "= 20.0, origin = \"test\" }]"},
                                 "",
                                 nullptr},
                                testing::FullRegistry(), diagnostics);
  ASSERT_NE(prepared, nullptr) << diagnostics.Format();
  EXPECT_FALSE(ChecksApply(prepared->checks, prepared->plan, *prepared->rig, diagnostics));
  EXPECT_NE(diagnostics.Format().find("cannot judge the filters"), std::string::npos) << diagnostics.Format();
}

}  // namespace
}  // namespace dynoproof
