// Play and dry friction are followed from the beginning of a record, and nothing else is.
#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/follow_friction.h"
#include "diagnosis/follow_play.h"
#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kNoise = 0.005;  // of each signal
constexpr double kGap_rad = 1.1e-5;
constexpr std::size_t kRows = 5001;

/// Half a second of a line that no engine code simulated, its values a little off, with noise.
class Hidden : public LumpedLine {
 protected:
  EstimationProblem Measured(const blind::IndependentLine& line, std::vector<double> torque = RandomTorque(kRows)) {
    return EstimationProblem(*plan_, {LineRecord(line, std::move(torque), kNoise)}, registry_);
  }
};

using SlowPlay = Hidden;
using SlowFriction = Hidden;

blind::IndependentLine SlightlyOff() {
  blind::IndependentLine line;
  line.inertia[3] *= 1.006;
  line.stiffness[2] *= 0.992;
  return line;
}

TEST_F(SlowPlay, IsFollowedFromTheFirstImpacts) {
  blind::IndependentLine line = SlightlyOff();
  const double k = line.stiffness[1], c = line.damping[1];
  // Nothing between the sides of the gap; what is beyond them twists the shaft.
  line.shaft[1] = [k, c](double twist, double rate) {
    return std::abs(twist) <= kGap_rad ? -(k * twist + c * rate) : -std::copysign(k * kGap_rad, twist);
  };
  const std::optional<Followed> followed = FollowPlay(Measured(line), [](double) {});
  ASSERT_TRUE(followed);
  const EffectInstance& play = followed->hypothesis.effects.at(0);
  EXPECT_EQ(play.ToString(), "backlash@shaft:k2");
  EXPECT_NEAR(play.parameters.at(0), kGap_rad, 0.01 * kGap_rad);  // the noise tells it to some 0.3 % by then
  EXPECT_GT(followed->share * 0.5, 0.03);                         // s: some ten times until the sides met
  // On the parts before it lay elsewhere by no more than that.
  ASSERT_EQ(followed->drift.size(), 1U);
  EXPECT_GT(followed->drift[0], 0.0);
  EXPECT_LT(followed->drift[0], 0.01 * kGap_rad);
}

TEST_F(SlowPlay, IsNotSeenInASofterShaft) {
  blind::IndependentLine line = SlightlyOff();
  line.stiffness[1] *= 0.8;
  EXPECT_FALSE(FollowPlay(Measured(line), [](double) {}));
}

TEST_F(SlowFriction, IsFollowedFromTheFirstSlipsToTheEnd) {
  constexpr double kSliding_Nm = 40.0, kAtRest_Nm = 90.0, kFalls_rad_per_s = 0.5;
  blind::IndependentLine line = SlightlyOff();
  // It creeps where it should stick: by 1e-4 rad/s, a ten thousandth of the speeds there.
  line.load[2] = [](double w) {
    const double falling = (kAtRest_Nm - kSliding_Nm) * std::exp(-std::pow(w / kFalls_rad_per_s, 2));
    return -(kSliding_Nm + falling) * std::tanh(w / 1e-4);
  };
  const std::optional<Followed> followed =
      FollowFriction(Measured(line, blind::IndependentTorque(kRows, 7)), std::nullopt, [](double) {});
  ASSERT_TRUE(followed);
  const EffectInstance& friction = followed->hypothesis.effects.at(0);
  EXPECT_EQ(friction.ToString(), "stribeck_friction@inertia:I3");
  EXPECT_EQ(followed->share, 1.0);
  EXPECT_NEAR(friction.parameters.at(0), kSliding_Nm, 0.02 * kSliding_Nm);
  EXPECT_NEAR(friction.parameters.at(1), kAtRest_Nm, 0.02 * kAtRest_Nm);
  EXPECT_NEAR(friction.parameters.at(2), kFalls_rad_per_s, 0.05 * kFalls_rad_per_s);
}

// At the torque of either direction, in both, or at the mean of the two, it explains nothing of how the line breaks
// loose.
TEST_F(SlowFriction, IsFollowedWhereItDiffersMuchWithDirection) {
  constexpr double kForth_Nm = 60.0, kBack_Nm = 25.0;
  blind::IndependentLine line = SlightlyOff();
  line.load[2] = FrictionByDirection(kForth_Nm, kBack_Nm, 2.0, 1.0);
  const std::optional<Followed> followed =
      FollowFriction(Measured(line, blind::IndependentTorque(kRows, 7)), std::nullopt, [](double) {});
  ASSERT_TRUE(followed);
  const EffectInstance& friction = followed->hypothesis.effects.at(0);
  EXPECT_EQ(friction.ToString(), "asymmetric_friction@inertia:I3");
  EXPECT_EQ(followed->share, 1.0);
  // Dry and viscous friction of a direction make up for each other.
  EXPECT_NEAR(friction.parameters.at(0), kForth_Nm, 0.03 * kForth_Nm);
  EXPECT_NEAR(friction.parameters.at(1), kBack_Nm, 0.03 * kBack_Nm);
}

TEST_F(SlowFriction, IsNotSeenInASofterShaft) {
  blind::IndependentLine line = SlightlyOff();
  line.stiffness[1] *= 0.8;
  EXPECT_FALSE(FollowFriction(Measured(line), std::nullopt, [](double) {}));
}

}  // namespace
}  // namespace dynoproof::diagnosis
