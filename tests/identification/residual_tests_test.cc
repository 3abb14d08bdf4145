// The tests of a residual by their size (false rejections under the hypothesis) and power.
#include "identification/residual_tests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "identification/noise_model.h"
#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"
#include "tests/identification/made_noise.h"

namespace dynoproof::identification {
namespace {

using ::testing::HasSubstr;

TEST(LjungBox, RejectsWhiteNoiseAsOftenAsItsLevelSays) {
  std::mt19937 random(26);
  constexpr int kRecords = 400;
  int rejected = 0;
  for (int k = 0; k < kRecords; ++k) rejected += *LjungBoxPValue(White(random, 2000), 20, 0) < 0.05 ? 1 : 0;
  // Binomial with 400 trials at 5 %: 20 with a standard deviation of 4.4; the bounds are three of them.
  EXPECT_GE(rejected, 7);
  EXPECT_LE(rejected, 33);
}

TEST(LjungBox, FittedCoefficientsTakeDegreesOfFreedom) {
  std::mt19937 random(27);
  constexpr int kRecords = 300, kOrder = 5;
  int rejected = 0;
  for (int k = 0; k < kRecords; ++k) {
    const Eigen::VectorXd y = Coloured(random, 2000, 0.7, 0.0);
    const ArModel model = FitAr(y, kOrder);
    Eigen::VectorXd error = y;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      for (Eigen::Index j = 0; j < kOrder && j < i; ++j)
        error[i] -= model.a[static_cast<std::size_t>(j)] * y[i - 1 - j];
    }
    rejected += *LjungBoxPValue(error.tail(y.size() - kOrder), 20, kOrder) < 0.05 ? 1 : 0;
  }
  EXPECT_GE(rejected, 4);  // 15 with a standard deviation of 3.8: three of them
  EXPECT_LE(rejected, 26);
}

TEST(LjungBox, FindsColour) {
  std::mt19937 random(28);
  for (int k = 0; k < 20; ++k) EXPECT_LT(*LjungBoxPValue(Coloured(random, 2000, 0.2, 0.0), 20, 0), 1e-3) << k;
}

TEST(LjungBox, SaysNothingWhereNothingCanBeSaid) {
  std::mt19937 random(29);
  EXPECT_FALSE(LjungBoxPValue(White(random, 79), 20, 0)) << "fewer than four rows a lag";
  EXPECT_FALSE(LjungBoxPValue(Eigen::VectorXd::Zero(1000), 20, 0)) << "zeros";
  EXPECT_FALSE(LjungBoxPValue(White(random, 1000), 20, 20)) << "no degree of freedom left";
}

TEST(Structure, SaysWhichTestFoundSomething) {
  Structure line;
  line.signal = "T_shaft";
  line.line_p_value = 1e-9;
  line.line_share = 0.02;
  line.line_hz = 97.38;
  EXPECT_TRUE(line.found());
  EXPECT_THAT(line.Text(), HasSubstr("T_shaft has a line at 97.38 Hz"));
  Structure inputs;
  inputs.signal = "omega_1";
  inputs.p_value = 1e-9;
  inputs.explained = 0.2;
  EXPECT_THAT(TextOf({line, inputs, Structure{}}), HasSubstr("; omega_1 follows the inputs (20 %"));
  EXPECT_EQ(Structure{}.Text(), "");
}

TEST(Structure, OfASizeThatIsNoNumberIsTooLarge) {
  constexpr double kNot = std::numeric_limits<double>::quiet_NaN();
  Structure rings, floor, size;
  rings.rings = floor.over_floor = kNot;
  rings.size = floor.size = 0.1;
  size.rings = 40.0;
  size.size = kNot;
  for (const Structure& one : {rings, floor, size}) EXPECT_TRUE(one.found());
}

TEST(ResidualTests, AreAbsentWhereNothingWasTested) {
  const ResidualTests none = TestsOf({Structure{}});
  EXPECT_FALSE(none.white());
  EXPECT_FALSE(none.independent_of_inputs());
  EXPECT_FALSE(none.line_p_value);
}

TEST(ResidualTests, EachFieldIsTheTestOfItsName) {
  Structure coloured;  // independent of the inputs, not white
  coloured.tested = true;
  coloured.p_value = 0.4;
  coloured.ljung_box_p_value = 1e-8;
  EXPECT_EQ(TestsOf({coloured}).white(), std::optional(false));
  EXPECT_EQ(TestsOf({coloured}).independent_of_inputs(), std::optional(true));
  Structure driven;  // white, but it follows the inputs
  driven.tested = true;
  driven.p_value = 1e-8;
  driven.ljung_box_p_value = 0.3;
  EXPECT_EQ(TestsOf({driven}).white(), std::optional(true));
  EXPECT_EQ(TestsOf({driven}).independent_of_inputs(), std::optional(false));
  EXPECT_EQ(*TestsOf({coloured, driven}).regression_p_value, 1e-8);
}

/// Residuals made by hand beside the signals of a line's record.
class ResidualStructure : public LumpedLine {
 protected:
  static constexpr std::size_t kRows = 6000;

  ResidualStructure()
      : problem_(*plan_, {LineRecord(blind::IndependentLine(), blind::IndependentTorque(kRows, 11), 0.003)},
                 registry_) {}

  /// What is found in the first channel for this residual of all rows.
  Structure In(const Eigen::VectorXd& residual) const {
    return FindStructure(problem_, residual, problem_.measured()).front();
  }
  Eigen::Index rows() const { return problem_.measured().size(); }

  EstimationProblem problem_;
};

// By the null hypothesis of both tests, noise of whatever colour, their p values are uniform.
TEST_F(ResidualStructure, NoiseOfAnyColourIsNone) {
  std::mt19937 random(29);
  constexpr int kRecords = 60;
  int follows = 0, line = 0;
  for (int k = 0; k < kRecords; ++k) {
    const Structure found = In(Coloured(random, rows(), 0.3 * (k % 4), 0.2));
    ASSERT_TRUE(found.tested);
    EXPECT_FALSE(found.found()) << found.Text();
    follows += found.p_value < 0.05 ? 1 : 0;
    line += found.line_p_value < 0.05 ? 1 : 0;
  }
  // Binomial with 60 trials at 5 %: 3 with a standard deviation of 1.7; the bounds are four of them.
  EXPECT_LE(follows, 9);
  EXPECT_LE(line, 9);
}

// One row without a number among thousands of white noise: nothing can be tested, and it does not pass as noise.
TEST_F(ResidualStructure, ARowWithoutANumberIsNoNoise) {
  for (const double no_number : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::mt19937 random(31);
    Eigen::VectorXd residual = White(random, rows());
    ASSERT_FALSE(In(residual).found());
    residual[100] = no_number;
    EXPECT_TRUE(In(residual).found());
    EXPECT_FALSE(In(residual).tested);
    EXPECT_NE(In(residual).Text(), "");
  }
}

// A share of the variance that the torque explains, a tone, and motion that a model has missed altogether. On a third
// of the rows such a tone is found six times of ten: the autoregressive model of order 30 takes most of it for colour.
TEST_F(ResidualStructure, ARelationALineAndARestOfTheSignalAreFound) {
  std::mt19937 random(30);
  const auto& torque = *problem_.records().front().inputs.at("T_airgap").values;
  const ComparedOutput& channel = problem_.channels().front();
  for (int k = 0; k < 10; ++k) {
    Eigen::VectorXd noise = White(random, rows()), tone = noise, rest = noise;
    double square = 0.0;
    for (const double v : torque) square += v * v / static_cast<double>(torque.size());
    for (Eigen::Index i = 0; i < channel.count; ++i) {
      const auto row = static_cast<std::size_t>(i);
      noise[i] += 0.3 * torque[row] / std::sqrt(square);                       // 8 % of the variance
      tone[i] += 0.4 * std::sin(2.0 * M_PI * 437.0 * problem_.time_s()[row]);  // 7 %
      rest[i] =
          problem_.measured()[i] - problem_.measured().head(channel.count).mean() + 1e-3 * channel.spread * rest[i];
    }
    EXPECT_TRUE(In(noise).FollowsInputs()) << k;
    const Structure line = In(tone);
    EXPECT_TRUE(line.HasLine()) << k;
    EXPECT_NEAR(line.line_hz, 437.0, 1.7);  // a bin of 0.6 s
    EXPECT_TRUE(In(rest).TooLarge()) << k;
  }
}

}  // namespace
}  // namespace dynoproof::identification
