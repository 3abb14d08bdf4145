// The statistics that decide a verdict: their size where nothing is hidden, their power where something is, against
// what theory expects; and what may not stand although nothing explains the data better.

#include "diagnosis/decide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diagnosis/policy.h"
#include "linear/dense.h"
#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

namespace dynoproof::diagnosis {
namespace {

using LeavesTheSignal = LumpedLine;

// As the measurement would be if the model missed so much of each channel's motion.
TEST_F(LeavesTheSignal, WhereMostOfItIsMissedInTheChannelThatGainsMost) {
  ASSERT_TRUE(plan_);
  const EstimationProblem problem(
      *plan_, {LineRecord(blind::IndependentLine(), blind::IndependentTorque(2001, 7), 0.003)}, registry_);
  const auto missing = [&](double torque, double speed) {
    Estimate fit;
    fit.predicted = problem.measured();
    for (const Channel& c : problem.channels()) {
      for (Eigen::Index i = 0; i < c.count; ++i)
        fit.predicted[c.begin + i] += (i % 2 == 0 ? 1.0 : -1.0) * c.spread * (c.name == "T_shaft" ? torque : speed);
    }
    return fit;
  };
  EXPECT_TRUE(dynoproof::diagnosis::LeavesTheSignal(problem, missing(1.4, 0.01), missing(0.9, 0.01)));
  // A small effect under little noise, a large one under much, and a channel of noise alone beside one that gains.
  EXPECT_FALSE(dynoproof::diagnosis::LeavesTheSignal(problem, missing(0.011, 0.01), missing(0.01, 0.01)));
  EXPECT_FALSE(dynoproof::diagnosis::LeavesTheSignal(problem, missing(3.0, 0.01), missing(0.9, 0.01)));
  EXPECT_FALSE(dynoproof::diagnosis::LeavesTheSignal(problem, missing(2.9, 0.57), missing(0.01, 0.56)));
  // What a prediction without numbers leaves is not known to be little.
  EXPECT_TRUE(dynoproof::diagnosis::LeavesTheSignal(problem, missing(0.011, 0.01), missing(std::nan(""), 0.01)));
}

/// Records of white noise with variance 1, and linear models of them made by hand: what least squares does to them is
/// known in closed form.
class WhiteRecords : public LumpedLine {
 protected:
  static constexpr std::size_t kRows = 500;

  WhiteRecords()
      : problem_(*plan_, {LineRecord(blind::IndependentLine(), blind::IndependentTorque(kRows, 7), 0.003)}, registry_) {
  }

  Eigen::VectorXd White() {
    return Eigen::VectorXd::NullaryExpr(problem_.measured().size(), [this] { return normal_(random_); });
  }
  /// A whitener that changes nothing: order 0 and sigma 1.
  Whitener Unit() const {
    Eigen::VectorXd ones(problem_.measured().size());
    for (Eigen::Index i = 0; i < ones.size(); ++i) ones[i] = i % 2 == 0 ? 1.0 : -1.0;
    return Whitener(problem_.channels(), ones, 0);
  }
  /// Least squares of `columns` to what the nominal model leaves, as a fit of one effect with as many parameters.
  Estimate FitOf(const Eigen::VectorXd& left, const Eigen::MatrixXd& columns) const {
    Estimate fit;
    const Eigen::VectorXd size = dense::LeastSquares(columns, left);
    fit.hypothesis.effects = {{registry_.FindEffect("constant_load"), *ParsePlace("inertia:I4"),
                               std::vector<double>(static_cast<std::size_t>(columns.cols()), 0.0)}};
    const Eigen::VectorXd rest = left - columns * size;
    fit.predicted = problem_.measured() - rest;
    fit.jacobian = columns;
    fit.chi2 = rest.squaredNorm();
    fit.criterion = fit.chi2 + static_cast<double>(columns.cols()) * std::log(static_cast<double>(left.size()));
    return fit;
  }
  Estimate Nominal(const Eigen::VectorXd& left) const {
    Estimate fit;
    fit.predicted = problem_.measured() - left;
    fit.jacobian.resize(left.size(), 0);
    fit.chi2 = fit.criterion = left.squaredNorm();
    return fit;
  }

  EstimationProblem problem_;
  std::mt19937 random_{28};
  std::normal_distribution<double> normal_;
};

using CrossValidation = WhiteRecords;

// Left-out part b is predicted by what the others say: its error grows by J_b' (J'J - J_b'J_b)^-1 J_b summed over the
// parts, which for p columns without structure is p kBlocks / (policy::kBlocks - 1). A true effect gains its own squares
// besides.
TEST_F(CrossValidation, GainsWhatTheoryExpects) {
  const Estimator estimator(problem_, Unit());
  constexpr int kDraws = 400, kColumns = 2;
  constexpr double kCost = kColumns * policy::kBlocks / (policy::kBlocks - 1.0);
  for (const double strength : {0.0, 6.0}) {
    double sum = 0.0, squares = 0.0;
    for (int draw = 0; draw < kDraws; ++draw) {
      Eigen::MatrixXd columns(problem_.measured().size(), kColumns);
      for (int k = 0; k < kColumns; ++k) columns.col(k) = White().normalized();
      const Eigen::VectorXd left = White() + strength * columns.col(0);
      const std::vector<double> without = CrossValidate(problem_, estimator, Nominal(left)),
                                with = CrossValidate(problem_, estimator, FitOf(left, columns));
      double gain = 0.0;
      for (int b = 0; b < policy::kBlocks; ++b)
        gain += without[static_cast<std::size_t>(b)] - with[static_cast<std::size_t>(b)];
      sum += gain, squares += gain * gain;
    }
    const double mean = sum / kDraws, error = std::sqrt((squares / kDraws - mean * mean) / kDraws);
    // Four standard errors, and the percent of its own information that a part keeps.
    EXPECT_NEAR(mean, strength * strength - kCost, 4.0 * error + 0.01 * (strength * strength + kCost)) << strength;
  }
}

using Decision = WhiteRecords;

// The F test of a comparison rejects as often as its level says, and no less where something is there.
TEST_F(Decision, PValuesAreUniformWhereNothingIsHidden) {
  constexpr int kDraws = 1000;
  int below = 0, found = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::MatrixXd columns(problem_.measured().size(), 2);
    columns << White().normalized(), White().normalized();
    const Eigen::VectorXd noise = White(), hidden = noise + 6.0 * columns.col(0);
    const std::vector<double> same(policy::kBlocks, 1.0);
    const auto p_value = [&](const Eigen::VectorXd& left) {
      return Compare(problem_, Nominal(left), same, FitOf(left, columns), same, static_cast<double>(left.size()), 1)
          .p_value;
    };
    below += p_value(noise) < 0.05 ? 1 : 0;
    found += p_value(hidden) < 1e-3 ? 1 : 0;
  }
  // Binomial with 1000 trials at 5 %: 50 with a standard deviation of 6.9; the bounds are four of them.
  EXPECT_GE(below, 23);
  EXPECT_LE(below, 77);
  // Non-central chi-squared with 2 degrees of freedom and 36: beyond the 13.8 of p = 1e-3 in 99.2 % of draws.
  EXPECT_GE(found, 970);
}

// As many candidates as a lumped line has are tried on noise: the best of them gains 2 ln(candidates) and a little. The
// threshold asks for odds of 1000 to 1 for each, and must not ask for what a real effect of 10 deviations has not got.
TEST_F(Decision, TheThresholdIsAboveTheBestOfAllCandidatesOnNoise) {
  constexpr int kDraws = 300, kCandidates = 300;
  const auto rows = static_cast<double>(problem_.measured().size());
  const double threshold = Threshold(rows, kCandidates);
  std::vector<double> best;
  for (int draw = 0; draw < kDraws; ++draw) {
    double most = 0.0;
    for (int k = 0; k < kCandidates; ++k) most = std::max(most, std::pow(normal_(random_), 2));
    best.push_back(most);
  }
  EXPECT_LT(*std::max_element(best.begin(), best.end()), threshold);
  EXPECT_LT(threshold, 50.0);
  // More rows and more candidates ask for more; with very many rows a thousandth of them, whatever the odds.
  EXPECT_LT(threshold, Threshold(rows, 2 * kCandidates));
  EXPECT_LT(threshold, Threshold(2.0 * rows, kCandidates));
  EXPECT_EQ(Threshold(1e6, kCandidates), 1e3);
}

// All conditions together on noise: nothing passes; on an effect of ten deviations nearly everything does.
TEST_F(Decision, NothingOnNoiseIsSignificantAndAClearEffectIs) {
  const Estimator estimator(problem_, Unit());
  const auto rows = static_cast<double>(problem_.measured().size());
  constexpr int kDraws = 200;
  int alarms = 0, found = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::MatrixXd column = White().normalized();
    const Eigen::VectorXd noise = White();
    for (const double strength : {0.0, 10.0}) {
      const Eigen::VectorXd left = noise + strength * column;
      const Estimate nominal = Nominal(left), fit = FitOf(left, column);
      const Standing standing = Compare(problem_, nominal, CrossValidate(problem_, estimator, nominal), fit,
                                        CrossValidate(problem_, estimator, fit), rows, 300);
      (strength > 0.0 ? found : alarms) += standing.significant ? 1 : 0;
    }
  }
  EXPECT_EQ(alarms, 0);
  // A gain of (10 + n)^2 over a threshold near 33 fails below n = -4.2 only; that three parts of five are better fails
  // rarely, too.
  EXPECT_GE(found, 196);
}

using Ambiguity = WhiteRecords;

TEST_F(Ambiguity, HoldsWhatIsAsGoodAndDropsWhatIsOnlyMoreComplex) {
  const double threshold = Threshold(static_cast<double>(problem_.measured().size()), 300);
  const auto fit = [this](const char* place, std::size_t parameters, double criterion, double chi2) {
    Estimate made;
    made.hypothesis.effects = {
        {registry_.FindEffect("constant_load"), *ParsePlace(place), std::vector<double>(parameters, 0.0)}};
    made.criterion = criterion;
    made.chi2 = chi2;
    return made;
  };
  // The best; one within odds of 150 to 1; one beyond them; one with a parameter more at the best one's place, which
  // gains less than counts; and the same at another place, where it is another cause.
  const std::vector<Estimate> fits = {fit("inertia:I4", 1, 100.0, 95.0), fit("inertia:I3", 1, 105.0, 100.0),
                                      fit("inertia:I2", 1, 111.0, 106.0), fit("inertia:I4", 2, 104.0, 92.0),
                                      fit("inertia:I5", 2, 104.0, 92.0)};
  EXPECT_EQ(AmbiguitySet(fits, threshold), (std::vector<std::size_t>{0, 1, 4}));
}

// The values that are fitted along gain by themselves: an effect that only comes with them is none.
TEST(HoldOut, AnEffectHasToGainOnTheNominalModelWithItsOwnFittedValues) {
  EXPECT_TRUE(GainsOnHoldout({.before = 0.4, .released = 0.2, .after = 0.1}, 1.0));
  EXPECT_FALSE(GainsOnHoldout({.before = 0.4, .released = 0.1, .after = 0.2}, 1.0));
  EXPECT_FALSE(GainsOnHoldout({.before = 0.1, .released = 0.4, .after = 0.2}, 1.0));
}

TEST(HoldOut, ANominalModelThatNeedsValuesBeyondTheirPriorsIsNoRival) {
  EXPECT_TRUE(GainsOnHoldout({.before = 0.4, .released = 0.1, .after = 0.2}, policy::kWithinPrior + 0.1));
  EXPECT_FALSE(GainsOnHoldout({.before = 0.1, .released = 0.1, .after = 0.2}, policy::kWithinPrior + 0.1));
}

TEST(HoldOut, WhatIsNoNumberDoesNotGain) {
  EXPECT_FALSE(GainsOnHoldout({.before = 0.4, .released = 0.2, .after = std::nan("")}, 1.0));
  EXPECT_FALSE(GainsOnHoldout({.before = std::nan(""), .released = std::nan(""), .after = 0.2}, 1.0));
  EXPECT_FALSE(GainsOnHoldout({.before = 0.4, .released = std::nan(""), .after = 0.2}, 1.0));
  EXPECT_FALSE(GainsOnHoldout({.before = 0.4, .released = 0.1, .after = 0.2}, std::nan("")));
}

}  // namespace
}  // namespace dynoproof::diagnosis
