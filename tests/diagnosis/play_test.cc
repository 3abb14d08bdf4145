// Play is followed from the beginning of a record, and nothing else is.
#include "diagnosis/play.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "diagnosis/noise.h"
#include "scenario/load.h"
#include "tests/blind/independent_line.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kNoise = 0.005;  // of each signal
constexpr double kGap_rad = 1.1e-5;

std::shared_ptr<const std::vector<double>> Shared(std::vector<double> values) {
  return std::make_shared<const std::vector<double>>(std::move(values));
}

/// Half a second of a line that no engine code simulated, its values a little off, with noise.
class SlowPlay : public testing::Test {
 protected:
  SlowPlay() { RegisterBuiltIns(registry_); }

  Study Measured(const blind::IndependentLine& line) {
    Diagnostics diagnostics;
    const std::optional<Plan> plan = LoadPlan("scenarios/diagnose/heavy_duty_lumped.toml", {}, diagnostics);
    std::vector<double> time, torque;
    for (std::uint64_t i = 0; i <= 5000; ++i) {
      time.push_back(1e-4 * static_cast<double>(i));
      torque.push_back(300.0 * RandomNormal(5, 1, i));
    }
    const blind::IndependentLine::Output output = line.Run(torque);
    MappedRecord record;
    const auto shared_time = Shared(std::move(time));
    record.inputs["T_airgap"] = {shared_time, Shared(std::move(torque))};
    record.end_s = shared_time->back();
    std::uint64_t stream = 2;
    for (const auto& [name, clean] : {std::pair{"T_shaft", &output.T_shaft}, {"omega_1", &output.omega_1}}) {
      const Eigen::Map<const Eigen::ArrayXd> rows(clean->data(), static_cast<Eigen::Index>(clean->size()));
      const double sigma = kNoise * std::sqrt((rows - rows.mean()).square().mean());
      std::vector<double> values = *clean;
      for (std::size_t i = 0; i < values.size(); ++i) values[i] += sigma * RandomNormal(5, stream, i);
      record.outputs[name] = {shared_time, Shared(std::move(values))};
      ++stream;
    }
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
