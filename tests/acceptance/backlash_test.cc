// Shafts with play from outside: the scenarios of chapter 3, their figures by name, and bad numbers answered with the
// place in the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;

nlohmann::json RunOne(const Bench& bench, const std::string& id) {
  return bench.Json({"run", id, "--out", "out"}).at("scenarios").at(0);
}

TEST(BacklashFromOutside, TheExperimentsHoldAndHaveTheirFigures) {
  const Bench bench;
  for (const char* id : {"backlash/experiment_1", "backlash/experiment_2"}) {
    const nlohmann::json result = RunOne(bench, id);
    EXPECT_EQ(result.at("verdict"), "pass") << result.dump(1);
    for (const char* law : {"dead_zone", "revised_dead_zone", "phase_plane", "damped_dead_zone",
                            "damped_revised_dead_zone", "damped_phase_plane", "full_state_backlash"}) {
      const nlohmann::json& figures = result.at("figures");
      ASSERT_TRUE(figures.contains(std::string(law) + ".impact_1_ms")) << id << " " << law;
      EXPECT_EQ(figures.at(std::string(law) + ".impact_1_ms").at("unit"), "ms");
      EXPECT_GT(figures.at(std::string(law) + ".impact_1_ms").at("value").get<double>(), 10.0);
      EXPECT_GT(figures.at(std::string(law) + ".impact_1_rad_per_s").at("value").get<double>(), 1.0);
    }
  }
}

TEST(BacklashFromOutside, MechanicsAloneAndClampedHold) {
  const Bench bench;
  for (const char* id : {"backlash/clamped", "backlash/chirp_left", "diagnose/backlash"}) {
    const nlohmann::json result = RunOne(bench, id);
    EXPECT_EQ(result.at("verdict"), "pass") << result.dump(1);
  }
}

TEST(BacklashFromOutside, BadNumbersAreAnsweredWithFileAndLine) {
  const Bench bench;
  const std::string head = R"([run]
duration_s = 0.1
[plant]
type = "drive_line"
[plant.inertia]
I1 = 1.0
I2 = 1.0
[plant.torque.T]
on = "I1"
[input.T]
to = "plant.T"
source = { type = "constant", value = 1.0 }
[output.w]
of = "plant.I2.speed"
[plant.shaft.k]
between = ["I1", "I2"]
)";  // 16 lines
  struct Case {
    const char *text, *place, *says;
  };
  const Case cases[] = {
      {"law = \"dead_zone\"\nstiffness_Nm_per_rad = 1e4\nhalf_gap_rad = -0.1\n", "play.toml:19:", "half_gap_rad"},
      {"law = \"phase_plane\"\nstiffness_Nm_per_rad = 0.0\ndamping_Nms_per_rad = 1.0\nhalf_gap_rad = 0.1\n",
       "play.toml:18:", "stiffness_Nm_per_rad"},
      {"law = \"phase_plane\"\nstiffness_Nm_per_rad = 1e4\ndamping_Nms_per_rad = 0.0\nhalf_gap_rad = 0.1\n",
       "play.toml:19:", "divides by the damping c"},
      {"law = \"damped_phase_plane\"\nstiffness_Nm_per_rad = 1e4\nhalf_gap_rad = 0.1\n"
       "contact_free_damping_Nms_per_rad = 0.0\n",
       "play.toml:15:", "divides by c + c_f"}};
  for (const Case& one : cases) {
    bench.Write("play.toml", head + one.text);
    const Outcome outcome = bench.Call({"validate", "play.toml"});
    EXPECT_EQ(outcome.exit, 2) << outcome.Both();
    EXPECT_THAT(outcome.Both(), HasSubstr(one.place));
    EXPECT_THAT(outcome.Both(), HasSubstr(one.says));
  }
}

}  // namespace
}  // namespace dynoproof::test
