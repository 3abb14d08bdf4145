// Where a model is wrong in a force, it is off at once; where it only accumulates, late; a right one never.
#include "diagnosis/prediction_horizon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kNoise = 0.003;  // of each signal

class Horizon : public LumpedLine {
 protected:
  /// The horizon of the plan on a noisy record, which a simulation of `line` outside the engine has made.
  PredictionHorizon Of(const blind::IndependentLine& line) const {
    const Result<std::optional<PredictionHorizon>> horizon =
        PredictionHorizonOf(*plan_, LineRecord(line, blind::IndependentTorque(7001, 7), kNoise), registry_);
    EXPECT_TRUE(horizon.ok());
    return horizon.ok() && *horizon ? **horizon : PredictionHorizon{};
  }
};

TEST_F(Horizon, OfTheRightModelIsTheWholeRecord) {
  const PredictionHorizon horizon = Of({});
  ASSERT_GE(horizon.levels.size(), 5U);
  EXPECT_NEAR(horizon.horizon_s, 0.7, 1e-9);
  for (const PredictionLevel& level : horizon.levels) {
    EXPECT_TRUE(level.at_noise) << horizon.ToText();
  }
  for (const auto& [name, noise] : horizon.noise) EXPECT_NEAR(noise, kNoise, 0.3 * kNoise) << name;
}

TEST_F(Horizon, OfASmallErrorOfAStiffnessIsShorter) {
  blind::IndependentLine line;
  line.stiffness[2] *= 1.01;
  const PredictionHorizon horizon = Of(line);
  EXPECT_GT(horizon.horizon_s, 0.0) << horizon.ToText();
  EXPECT_LT(horizon.horizon_s, 0.35) << horizon.ToText();
  EXPECT_FALSE(horizon.levels.back().at_noise);
}

TEST_F(Horizon, ShrinksWithTheSizeOfWhatIsMissing) {
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

TEST_F(Horizon, OfARecordThatStandsStillIsNotTold) {
  MappedRecord record = LineRecord({}, std::vector<double>(2001, 0.0), 0.0);
  const Result<std::optional<PredictionHorizon>> horizon = PredictionHorizonOf(*plan_, record, registry_);
  ASSERT_TRUE(horizon.ok());
  EXPECT_FALSE(horizon->has_value());
}

}  // namespace
}  // namespace dynoproof::diagnosis
