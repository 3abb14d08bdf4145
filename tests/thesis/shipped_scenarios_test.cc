// What engine/README.md says of all shipped scenarios: each compares the two solvers, and holds with either of them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/text.h"
#include "experiment/prepare.h"
#include "experiment/run_scenario.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "tests/support/registry.h"
#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

std::vector<std::string> Shipped() {
  Diagnostics diagnostics;
  return FindScenarios(ScenarioFolder(), diagnostics);
}

std::set<std::string> KindsOf(const std::string& file) {
  Diagnostics diagnostics;
  const std::optional<Plan> plan = LoadPlan(file, {}, diagnostics);
  std::set<std::string> kinds;
  const Value* checks = plan ? plan->root.Find("check") : nullptr;
  for (const Value& check : checks != nullptr && checks->is_array() ? checks->array() : Value::Array{})
    kinds.insert(check.Find("kind")->string());
  return kinds;
}

TEST(ShippedScenarios, EachComparesTheSolvers) {
  ASSERT_GE(Shipped().size(), 47u);
  for (const std::string& file : Shipped()) {
    const std::set<std::string> kinds = KindsOf(file);
    // Beyond an impact free runs part; `contacts` compares up to the second one, `windows` in windows that restart.
    EXPECT_TRUE(kinds.contains("solvers") || (kinds.contains("contacts") && kinds.contains("windows")) ||
                (kinds.contains("oracle") && kinds.contains("windows")))
        << file;
  }
}

/// The count of scenarios with an oracle in engine/README.md.
TEST(ShippedScenarios, AsManyHaveAnOracleAsThePageSays) {
  const std::vector<std::string> files = Shipped();
  const auto with = std::count_if(files.begin(), files.end(),
                                  [](const std::string& file) { return KindsOf(file).contains("oracle"); });
  const std::optional<std::string> readme = ReadTextFile("engine/README.md");
  ASSERT_TRUE(readme);
  EXPECT_THAT(*readme, ::testing::HasSubstr(fmt::format("{} of {} scenarios", with, files.size())));
}

/// One test a scenario; the ordinary runs of all of them, by `realtime`, are in tests/acceptance/report_test.cc.
class Reference : public ::testing::TestWithParam<std::string> {};

TEST_P(Reference, HoldsToo) {
  const test::TempDir folder;
  Diagnostics diagnostics;
  PrepareOptions with;
  with.solver = "reference";
  const std::unique_ptr<Prepared> prepared = Prepare(GetParam(), with, testing::FullRegistry(), diagnostics);
  ASSERT_NE(prepared, nullptr) << diagnostics.Format();
  RunOptions options;
  options.out = folder.path().string();
  const ScenarioResult result = RunScenario(*prepared, options);
  EXPECT_EQ(result.verdict, score::Verdict::kPass) << result.broken;
  for (const score::Check& check : result.checks)
    EXPECT_EQ(check.verdict, score::Verdict::kPass)
        << check.name << ": " << check.value << " of " << check.limit << ", " << check.explanation;
}

INSTANTIATE_TEST_SUITE_P(Nightly, Reference, ::testing::ValuesIn(Shipped()), [](const auto& shipped) {
  std::string name = ScenarioId(shipped.param);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
});

}  // namespace
}  // namespace dynoproof
