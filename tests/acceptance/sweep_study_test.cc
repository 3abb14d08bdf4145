// A campaign over a study of the thesis.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace dynoproof::test
