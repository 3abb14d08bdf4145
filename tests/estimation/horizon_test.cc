// Where a model is wrong in a force, it is off at once; where it only accumulates, late; a right one never.
#include "estimation/horizon.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/estimation/made_record.h"
#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

namespace dynoproof::estimation {
namespace {

using ::testing::HasSubstr;

constexpr double kNoise = 0.003;  // of each signal

class HorizonOfALine : public identification::LumpedLine {
 protected:
  /// The horizon of the plan on a noisy record, which a simulation of `line` outside the engine has made.
  Horizon Of(const blind::IndependentLine& line, std::size_t samples = 7001) const {
    const Result<std::optional<Horizon>> horizon =
        HorizonOf(*plan_, identification::LineRecord(line, blind::IndependentTorque(samples, 7), kNoise), registry_);
    EXPECT_TRUE(horizon.ok());
    return horizon.ok() && *horizon ? **horizon : Horizon{};
  }
};

TEST_F(HorizonOfALine, OfTheRightModelIsTheWholeRecord) {
  const Horizon horizon = Of({});
  ASSERT_GE(horizon.levels.size(), 4U);
  EXPECT_NEAR(horizon.horizon_s, 0.7, 1e-9);
  for (const HorizonLevel& level : horizon.levels) {
    EXPECT_TRUE(level.at_noise) << horizon.ToText();
  }
  for (const auto& [name, noise] : horizon.noise) EXPECT_NEAR(noise, kNoise, 0.3 * kNoise) << name;
}

TEST_F(HorizonOfALine, OfALongRecordIsThatOfItsFirstPartAndSaysSo) {
  const Horizon horizon = Of({}, 21'001);
  EXPECT_NEAR(horizon.record_s, 2.1, 1e-9);
  EXPECT_NEAR(horizon.seen_s, 2.0, 1e-9);
  EXPECT_THAT(horizon.ToText(), HasSubstr("of the first 2 s of 2.1"));
  EXPECT_THAT(horizon.ToText(), HasSubstr("all of that part to its noise"));
}

TEST_F(HorizonOfALine, OfASmallErrorOfAStiffnessIsShorter) {
  blind::IndependentLine line;
  line.stiffness[2] *= 1.01;
  const Horizon horizon = Of(line);
  EXPECT_GT(horizon.horizon_s, 0.0) << horizon.ToText();
  EXPECT_LT(horizon.horizon_s, 0.35) << horizon.ToText();
  EXPECT_FALSE(horizon.levels.back().at_noise);
}

TEST_F(HorizonOfALine, ShrinksWithTheSizeOfWhatIsMissing) {
  double before = std::numeric_limits<double>::infinity();
  for (const double friction_Nm : {2.0, 20.0, 200.0}) {
    blind::IndependentLine line;
    line.load[3] = [=](double speed) { return -friction_Nm * std::tanh(speed); };
    const double now = Of(line).horizon_s;
    EXPECT_LE(now, before) << friction_Nm;
    before = now;
  }
  EXPECT_EQ(before, 0.0);
}

// Of 144 states ten are moved and seen.
TEST(HorizonOfASoftRotor, TellsAForceFromWhatAddsUp) {
  const Plan plan = Reversing();
  const auto horizon_of = [&](const Plan& truth) {
    const Result<std::optional<Horizon>> horizon =
        HorizonOf(plan, RecordOf(truth, 0.005, {"T_shaft", "omega_1"}), testing::BuiltIns());
    EXPECT_TRUE(horizon.ok() && horizon->has_value());
    return horizon.ok() && *horizon ? (*horizon)->horizon_s : -1.0;
  };
  EXPECT_NEAR(horizon_of(plan), 2.0, 1e-9);
  const double softer = horizon_of(WithEffect(plan, "stiffness_change", "shaft:k4", {-0.005}));
  EXPECT_GT(softer, 0.0);
  EXPECT_LT(softer, 1.0);
  EXPECT_LT(horizon_of(WithEffect(plan, "coulomb_friction", "inertia:I5", {20.0})), softer);
}

TEST_F(HorizonOfALine, OfARecordThatStandsStillIsNotTold) {
  MappedRecord record = identification::LineRecord({}, std::vector<double>(2001, 0.0), 0.0);
  const Result<std::optional<Horizon>> horizon = HorizonOf(*plan_, record, registry_);
  ASSERT_TRUE(horizon.ok());
  EXPECT_FALSE(horizon->has_value());
}

}  // namespace
}  // namespace dynoproof::estimation
