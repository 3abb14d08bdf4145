// Who is found first decides who is found: ways on which a right cause could get lost.
#include "diagnosis/search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "diagnosis/candidates.h"
#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

namespace dynoproof::diagnosis {
namespace {

constexpr std::size_t kRows = 14001;
constexpr double kNoise = 0.003;  // of each signal

/// Lets through of a torque what goes beyond `dead_Nm` on either side.
std::function<double(double)> DeadZone(double dead_Nm) {
  return
      [dead_Nm](double torque) { return std::abs(torque) < dead_Nm ? 0.0 : torque - std::copysign(dead_Nm, torque); };
}

class SlowSearch : public LumpedLine {
 protected:
  /// 1.4 s of a line that no engine code simulated, with noise.
  std::vector<MappedRecord> Measured(const blind::IndependentLine& line) const {
    return {LineRecord(line, blind::IndependentTorque(kRows, 7), kNoise)};
  }

  Result<Found> FoundIn(const std::vector<MappedRecord>& records) const {
    const std::filesystem::path saved = std::filesystem::path(testing::TempDir()) / "search_test_state.json";
    return Search(EstimationProblem(*plan_, records, registry_), records, 1.0,
                  {saved.string(), false, [](auto&&...) {}});
  }
};

// Its modes shift with the amplitude. Fitted to all of a record beside nominal values that are a little off, it leaves
// a size that was right at once.
TEST_F(SlowSearch, ALostCubicSpringBeginsAnewOnShortParts) {
  constexpr double kCubic = 5e13;  // N m/rad^3
  blind::IndependentLine line;
  line.inertia[2] *= 1.012;
  line.inertia[3] *= 0.991;
  line.stiffness[1] *= 0.987;
  line.stiffness[2] *= 1.012;
  line.stiffness[3] *= 0.99;
  line.shaft[2] = [](double twist, double) { return kCubic * twist * twist * twist; };
  const Result<Found> found = FoundIn(Measured(line));
  ASSERT_TRUE(found.ok());
  ASSERT_FALSE(found->fits.empty());
  const Estimate& best = found->fits.front();
  ASSERT_EQ(best.Name(), "cubic_stiffness@shaft:k3");
  EXPECT_NEAR(best.hypothesis.effects[0].parameters[0], kCubic, 0.05 * kCubic);
}

// Later than the signal is wide: no slope leads there from one sample.
TEST_F(SlowSearch, ATorqueThatComesFiftySamplesLate) {
  constexpr std::size_t kLate = 50;
  const std::vector<double> told = blind::IndependentTorque(kRows, 7);
  std::vector<double> acting(kLate, told.front());
  acting.insert(acting.end(), told.begin(), told.end() - kLate);
  MappedRecord record = LineRecord(blind::IndependentLine(), std::move(acting), kNoise);
  record.inputs["T_airgap"].values = Shared(told);
  const Result<Found> found = FoundIn({record});
  ASSERT_TRUE(found.ok());
  ASSERT_FALSE(found->fits.empty());
  ASSERT_EQ(found->fits.front().Name(), "actuator_delay@input:T_airgap");
  EXPECT_NEAR(found->fits.front().hypothesis.effects[0].parameters[0], 1e-4 * kLate, 2e-6);
}

// Of a machine a little off in every number, under more noise: the fit of the dead zone comes to rest with its fastest
// mode, which the noise all but covers, a turn out of step.
TEST_F(SlowSearch, AModeThatLostStepIsBroughtBack) {
  blind::IndependentLine line;
  for (std::size_t i = 0; i < line.inertia.size(); ++i) line.inertia[i] *= 1.0 + 0.004 * RandomNormal(3, 1, i);
  for (std::size_t i = 0; i < line.stiffness.size(); ++i) line.stiffness[i] *= 1.0 + 0.006 * RandomNormal(3, 2, i);
  line.actuator = DeadZone(66.0);
  const Result<Found> found = FoundIn({LineRecord(line, blind::IndependentTorque(kRows, 10), 0.017)});
  ASSERT_TRUE(found.ok());
  ASSERT_FALSE(found->fits.empty());
  EXPECT_EQ(found->fits.front().Name(), "actuator_dead_zone@input:T_airgap");
  EXPECT_FALSE(AnyFound(found->structure));
}

// In plain power, which knows nothing of the colour that the noise seems to have.
TEST_F(SlowSearch, WhatExplainsMostLeavesLeast) {
  blind::IndependentLine line;
  line.actuator = DeadZone(100.0);
  const Result<Found> found = FoundIn(Measured(line));
  ASSERT_TRUE(found.ok());
  const auto least = std::min_element(found->screened.begin(), found->screened.end(),
                                      [](const Screened& a, const Screened& b) { return a.left < b.left; });
  EXPECT_EQ(found->candidates[least->candidate].ToString(), "actuator_dead_zone@input:T_airgap");
  EXPECT_LT(least->left, 0.1);
  ASSERT_FALSE(found->fits.empty());
  EXPECT_EQ(found->fits.front().Name(), "actuator_dead_zone@input:T_airgap");
}

}  // namespace
}  // namespace dynoproof::diagnosis
