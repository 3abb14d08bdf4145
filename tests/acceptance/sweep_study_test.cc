// A campaign over a study of the thesis.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;

TEST(CampaignOfAStudy, AxesSetItsParametersAndRatesAreCounted) {
  const Bench bench;
  const std::string file = R"(title = "suppression"
study = "suppression"
most_failing = 1.0
[parameters]
duration_s = 0.4
[[axis]]
key = "load"
list = ["quiet", "near_tone"]
[[axis]]
key = "k_V"
list = [2.1, 9.7]
[rate.found]
hits = "found"
of = "unstable_modes"
by = "load"
)";
  bench.Write("study.toml", file);
  const nlohmann::json result = bench.Json({"sweep", "study.toml"});
  EXPECT_EQ(result["exit"], 0);
  EXPECT_EQ(result["figures"]["unstable_modes"]["quantiles"]["0"], 0.0) << "k_V = 2.1 is stable";
  EXPECT_GT(result["rates"]["found"]["groups"]["quiet"]["of"].get<int>(), 0) << "k_V = 9.7 is not";
  std::string wrong = file;
  wrong.replace(wrong.find("near_tone"), 9, "near_tune");
  bench.Write("wrong.toml", wrong);
  const Outcome refused = bench.Call({"sweep", "wrong.toml"});
  EXPECT_EQ(refused.exit, 2);
  EXPECT_THAT(refused.err, HasSubstr("near_tone"));
}

// bench/campaigns/machine_robustness.toml in small: the same axes, six plants under a load that comes at once or late.
TEST(RobustnessOfTheScheme, DependsOnWhenTheLoadComes) {
  const Bench bench;
  std::ifstream shipped("bench/campaigns/machine_robustness.toml");
  std::string file((std::istreambuf_iterator<char>(shipped)), {});
  const auto replace = [&file](const std::string& from, const std::string& to) {
    ASSERT_NE(file.find(from), std::string::npos) << from;
    file.replace(file.find(from), from.size(), to);
  };
  replace("samples = 1000", "samples = 6");
  replace("run.duration_s=5.0", "run.duration_s=2.5");
  replace("uniform = [0.1, 2.0]", "list = [0.1, 2.0]");
  bench.Write("small.toml", file + "\n[rate.failing]\nhits = \"fail\"\nby = \"input.T_load.source.start_time_s\"\n");
  const nlohmann::json result = bench.Json({"sweep", "small.toml"});
  EXPECT_EQ(result["exit"], 0);
  EXPECT_EQ(result["verdicts"].value("broken", 0), 0);
  // The plants are the same: what the early load hides, the late one leaves to be found.
  const nlohmann::json& found = result["rates"]["found"]["all"];
  const nlohmann::json& failing = result["rates"]["failing"]["groups"];
  EXPECT_GT(found["of"].get<int>(), 0);
  EXPECT_GT(failing["0.1"]["hits"].get<int>(), failing["2"]["hits"].get<int>()) << result["rates"].dump(2);
  EXPECT_LT(failing["0.1"]["ci95"][0].get<double>(), failing["0.1"]["ci95"][1].get<double>());
}

}  // namespace
}  // namespace dynoproof::test
