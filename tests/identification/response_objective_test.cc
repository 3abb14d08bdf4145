// What is fitted to a frequency response: nothing is missed at the truth, and something beside it.
#include "identification/response_objective.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "experiment/analysis.h"
#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

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

class ResponseMisfits : public LumpedLine {
 protected:
  ResponseMisfits() : problem_(*plan_, {Chirp()}, registry_) {}

  /// 0 to 2000 Hz in 2 s, from a line that no engine code simulated. Its two outer shafts have a little damping here:
  /// their resonances ring down within the record.
  static MappedRecord Chirp(double noise = 1e-4) {
    blind::IndependentLine line;
    line.damping = {850.4, 800.0, kDamping, kDamping};
    std::vector<double> torque;
    for (std::size_t i = 0; i < 20001; ++i) {
      const double t = 1e-4 * static_cast<double>(i);
      torque.push_back(t < 1.9 ? 1000.0 * std::sin(2.0 * M_PI * 0.5 * 1050.0 * t * t) : 0.0);
    }
    return LineRecord(line, std::move(torque), noise);
  }
  /// The plan of the line that was measured, with one number times `factor`.
  Plan Of(const char* key, double factor) const {
    Plan plan = *plan_;
    for (const char* shaft : {"plant.shaft.k3.damping_Nms_per_rad", "plant.shaft.k4.damping_Nms_per_rad"})
      *plan.root.FindPath(shaft) = Value(kDamping);
    *plan.root.FindPath(key) = Value(factor * plan.root.FindPath(key)->number());
    return plan;
  }
  /// Root mean square of what is missed.
  double Missed(const Objective& objective, const char* key, double factor) const {
    const Result<Eigen::VectorXd> error = objective.Of(Of(key, factor));
    EXPECT_TRUE(error.ok()) << error.failure().ToString();
    EXPECT_EQ(error->size(), objective.size());
    return std::sqrt(error->squaredNorm() / static_cast<double>(error->size()));
  }

  static constexpr double kDamping = 15.0;
  static constexpr const char* kStiffness = "plant.shaft.k4.stiffness_Nm_per_rad";
  static constexpr const char* kLoss = "plant.shaft.k4.damping_Nms_per_rad";
  EstimationProblem problem_;
};

// The hold of the input would be 6 % in gain and 0.6 in phase at 2000 Hz.
TEST_F(ResponseMisfits, TheCurveIsMetAtTheTruthAndMissedBesideIt) {
  const Result<score::Response> measured = MeasuredResponse(problem_);
  ASSERT_TRUE(measured.ok()) << measured.failure().ToString();
  const std::unique_ptr<Objective> curve = ResponseObjective(problem_, *measured);
  ASSERT_GT(curve->size(), 400);
  const double at_truth = Missed(*curve, kStiffness, 1.0);
  EXPECT_LT(at_truth, 0.02);
  for (const double factor : {0.97, 1.03}) EXPECT_GT(Missed(*curve, kStiffness, factor), 3.0 * at_truth) << factor;
}

TEST_F(ResponseMisfits, ResonancesLieWhereTheModelHasThem) {
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
TEST_F(ResponseMisfits, NoiseIsNoLandmark) {
  const EstimationProblem noisy(*plan_, {Chirp(0.003)}, registry_);
  const Result<Landmarks> landmarks = MeasuredLandmarks(noisy);
  ASSERT_TRUE(landmarks.ok()) << landmarks.failure().ToString();
  EXPECT_THAT(landmarks->resonances_hz,
              ElementsAre(DoubleNear(391.0, 2.0), DoubleNear(549.0, 1.0), DoubleNear(1560.0, 3.0)));
  EXPECT_THAT(landmarks->zeros_hz, ElementsAre());
}

// From one end of a chain to the other there is no zero: what dips between two resonances is none.
TEST_F(ResponseMisfits, AChainShowsNoZeros) { EXPECT_THAT(MeasuredLandmarks(problem_)->zeros_hz, ElementsAre()); }

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

TEST_F(ResponseMisfits, GainsTellTheDamping) {
  const Result<Landmarks> measured = MeasuredLandmarks(problem_);
  ASSERT_TRUE(measured.ok());
  const std::unique_ptr<Objective> gains = GainObjective(problem_, *measured);
  const double at_truth = Missed(*gains, kLoss, 1.0);
  EXPECT_LT(at_truth, 0.05);
  for (const double factor : {0.5, 2.0}) EXPECT_GT(Missed(*gains, kLoss, factor), 0.2) << factor;
}

TEST_F(ResponseMisfits, AResonanceThatTheModelLacksCountsAsMissing) {
  const Plan plan = Of(kStiffness, 1.0);
  const std::unique_ptr<Objective> objective =
      FrequencyObjective(problem_, {.resonances_hz = {20.0, 5e4}, .gains = {1.0, 1.0}, .zeros_hz = {}});
  const Result<Eigen::VectorXd> error = objective->Of(plan);
  ASSERT_TRUE(error.ok());
  EXPECT_THAT(std::vector<double>(error->begin(), error->end()), ElementsAre(kMissing, kMissing));
}

TEST_F(ResponseMisfits, WithoutWhatAResponseNeedsThereIsNone) {
  Plan plan = *plan_;
  ASSERT_TRUE(std::erase_if(plan.root.table(), [](const Value::Entry& entry) { return entry.key == "analysis"; }) > 0);
  const Result<score::Response> no_analysis = MeasuredResponse(EstimationProblem(plan, {Chirp()}, registry_));
  ASSERT_FALSE(no_analysis.ok());
  EXPECT_EQ(no_analysis.failure().exit_code, 2);
  MappedRecord constant = Chirp();
  constant.inputs["T_airgap"].values = Shared(std::vector<double>(20001, 100.0));
  const Result<score::Response> no_excitation = MeasuredResponse(EstimationProblem(*plan_, {constant}, registry_));
  ASSERT_FALSE(no_excitation.ok());
  EXPECT_NE(no_excitation.failure().message.find("no frequency response"), std::string::npos);
}

}  // namespace
}  // namespace dynoproof::identification
