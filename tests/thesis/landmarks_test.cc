// Resonances and zeros of a frequency response, and what is fitted to them.
#include "thesis/landmarks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <complex>
#include <memory>
#include <vector>

#include "tests/identification/response_misfits.h"

namespace dynoproof::identification {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST(Assigned, KeepsTheOrderAndUsesNoneTwice) {
  EXPECT_THAT(Assigned({100.0, 200.0}, {98.0, 150.0, 203.0}), ElementsAre(0, 2));
  EXPECT_THAT(Assigned({100.0, 110.0}, {106.0}), ElementsAre(-1, 0));
  EXPECT_THAT(Assigned({100.0, 110.0}, {104.0}), ElementsAre(0, -1));
  // The nearer one of each alone would be 150 for both.
  EXPECT_THAT(Assigned({140.0, 160.0}, {110.0, 150.0}), ElementsAre(0, 1));
}

TEST(Assigned, LeavesOutWhatIsTooFarOff) {
  EXPECT_THAT(Assigned({100.0}, {300.0}), ElementsAre(-1));
  EXPECT_THAT(Assigned({100.0, 900.0}, {}), ElementsAre(-1, -1));
  EXPECT_THAT(Assigned({}, {100.0}), ElementsAre());
}

using LandmarkMisfits = ResponseMisfits;

TEST_F(LandmarkMisfits, ResonancesLieWhereTheModelHasThem) {
  const Result<Landmarks> measured = MeasuredLandmarks(problem_);
  ASSERT_TRUE(measured.ok());
  ASSERT_GE(measured->resonances_hz.size(), 2U);
  const std::unique_ptr<Objective> frequencies = FrequencyObjective(problem_, *measured);
  EXPECT_LT(Missed(*frequencies, kStiffness, 1.0), 0.003);  // lines are half a hertz apart
  EXPECT_GT(Missed(*frequencies, kStiffness, 1.03), 0.004);
  EXPECT_NEAR(Missed(*frequencies, kLoss, 3.0), Missed(*frequencies, kLoss, 1.0), 1e-12);  // without dampings
}

// Noise makes peaks and dips by the dozen; a sharp resonance has little coherence. The line's modes: 391, 549, 1069 and
// 1560 Hz, the third of which is damped too much to be seen.
TEST_F(LandmarkMisfits, NoiseIsNoLandmark) {
  const EstimationProblem noisy(*plan_, {Chirp(0.003)}, registry_);
  const Result<Landmarks> landmarks = MeasuredLandmarks(noisy);
  ASSERT_TRUE(landmarks.ok()) << landmarks.failure().ToString();
  EXPECT_THAT(landmarks->resonances_hz,
              ElementsAre(DoubleNear(391.0, 2.0), DoubleNear(549.0, 1.0), DoubleNear(1560.0, 3.0)));
  EXPECT_THAT(landmarks->zeros_hz, ElementsAre());
}

// From one end of a chain to the other there is no zero: what dips between two resonances is none.
TEST_F(LandmarkMisfits, AChainShowsNoZeros) { EXPECT_THAT(MeasuredLandmarks(problem_)->zeros_hz, ElementsAre()); }

TEST(Landmarks, AZeroIsADipWhereTheSignChanges) {
  // Two modes at 100 and 200 Hz that work against each other at the output: 1 / (100^2 - f^2) -+ 1 / (200^2 - f^2).
  for (const double sign : {-1.0, 1.0}) {
    score::Response response;
    for (double f = 1.0; f < 300.0; f += 0.25) {
      const std::complex<double> a(1e4 - f * f, 2.0 * f), b(4e4 - f * f, 4.0 * f);
      response.frequency_hz.push_back(f);
      response.gain.push_back(1.0 / a + sign / b);
      response.coherence.push_back(1.0);
    }
    const Result<Landmarks> landmarks = LandmarksOf(response, 2.0);
    ASSERT_TRUE(landmarks.ok());
    EXPECT_THAT(landmarks->resonances_hz, SizeIs(2));
    EXPECT_THAT(landmarks->zeros_hz, SizeIs(sign > 0.0 ? 1 : 0)) << sign;
  }
}

TEST_F(LandmarkMisfits, GainsTellTheDamping) {
  const Result<Landmarks> measured = MeasuredLandmarks(problem_);
  ASSERT_TRUE(measured.ok());
  const std::unique_ptr<Objective> gains = GainObjective(problem_, *measured);
  const double at_truth = Missed(*gains, kLoss, 1.0);
  EXPECT_LT(at_truth, 0.05);
  for (const double factor : {0.5, 2.0}) EXPECT_GT(Missed(*gains, kLoss, factor), 0.2) << factor;
}

TEST_F(LandmarkMisfits, AResonanceThatTheModelLacksCountsAsMissing) {
  const Plan plan = Of(kStiffness, 1.0);
  const std::unique_ptr<Objective> objective =
      FrequencyObjective(problem_, {.resonances_hz = {20.0, 5e4}, .gains = {1.0, 1.0}, .zeros_hz = {}});
  const Result<Eigen::VectorXd> error = objective->Of(plan);
  ASSERT_TRUE(error.ok());
  EXPECT_THAT(std::vector<double>(error->begin(), error->end()), ElementsAre(kMissing, kMissing));
}

}  // namespace
}  // namespace dynoproof::identification
