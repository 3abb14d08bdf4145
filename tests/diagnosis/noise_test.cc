// The tests of a residual by their size (false rejections under the hypothesis) and power.
#include "diagnosis/noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "diagnosis/diagnose.h"

namespace dynoproof::diagnosis {
namespace {

using ::testing::HasSubstr;

Eigen::VectorXd White(std::mt19937& random, Eigen::Index rows) {
  std::normal_distribution<double> normal;
  return Eigen::VectorXd::NullaryExpr(rows, [&] { return normal(random); });
}

/// y[i] = a y[i-1] + e[i] + b e[i-1].
Eigen::VectorXd Coloured(std::mt19937& random, Eigen::Index rows, double a, double b) {
  const Eigen::VectorXd e = White(random, rows);
  Eigen::VectorXd y = e;
  for (Eigen::Index i = 1; i < rows; ++i) y[i] = a * y[i - 1] + e[i] + b * e[i - 1];
  return y;
}

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

}  // namespace
}  // namespace dynoproof::diagnosis
