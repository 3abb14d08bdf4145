// Play is followed from the beginning of a record, and nothing else is.
#include "diagnosis/follow.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scenario/load.h"
#include "tests/blind/independent_line.h"
#include "tests/diagnosis/made_record.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kNoise = 0.005;  // of each signal
constexpr double kGap_rad = 1.1e-5;

/// Half a second of a line that no engine code simulated, its values a little off, with noise.
class SlowPlay : public testing::Test {
 protected:
  SlowPlay() { RegisterBuiltIns(registry_); }

  Study Measured(const blind::IndependentLine& line) {
    Diagnostics diagnostics;
    const std::optional<Plan> plan = LoadPlan("scenarios/diagnose/heavy_duty_lumped.toml", {}, diagnostics);
    constexpr std::size_t kRows = 5001;
    std::vector<double> torque = RandomTorque(kRows);
    const blind::IndependentLine::Output output = line.Run(torque);
    MappedRecord record;
    const auto time = Shared(Times(kRows));
    record.inputs["T_airgap"] = {time, Shared(std::move(torque))};
    record.outputs["T_shaft"] = {time, Noisy(output.T_shaft, kNoise, 2)};
    record.outputs["omega_1"] = {time, Noisy(output.omega_1, kNoise, 3)};
    record.end_s = time->back();
    return Study(*plan, {record}, registry_);
  }

  Registry registry_;
};

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
  const Assumed& play = followed->hypothesis.effects.at(0);
  EXPECT_EQ(play.ToString(), "backlash@shaft:k2");
  EXPECT_NEAR(play.parameters.at(0), kGap_rad, 0.01 * kGap_rad);  // the noise tells it to some 0.3 % by then
  EXPECT_GT(followed->share * 0.5, 0.03);                         // s: some ten times until the sides met
}

TEST_F(SlowPlay, IsNotSeenInASofterShaft) {
  blind::IndependentLine line = SlightlyOff();
  line.stiffness[1] *= 0.8;
  EXPECT_FALSE(FollowPlay(Measured(line), [](double) {}));
}

}  // namespace
}  // namespace dynoproof::diagnosis
