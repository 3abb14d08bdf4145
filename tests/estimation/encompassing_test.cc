#include "estimation/encompassing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "experiment/drive_by_record.h"
#include "linear/dense.h"
#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::estimation {
namespace {

/// Two channels of 2001 rows; what they hold does not matter here.
const DataSet& Data() {
  static const DataSet data({RecordOf(FourMasses(0.2), 0.01, {"T_shaft", "omega_1"})}, FourMasses(0.2));
  return data;
}

Eigen::VectorXd Noise(std::uint64_t seed, Eigen::Index rows) {
  Eigen::VectorXd noise(rows);
  for (Eigen::Index i = 0; i < rows; ++i) noise[i] = RandomNormal(seed, 0, static_cast<std::uint64_t>(i));
  return noise;
}

/// Every row counts the same.
Eigen::VectorXd Alike() { return Eigen::VectorXd::Ones(Data().measured().size()); }

TEST(LeaveBlocksOut, IsWhatRefittingGives) {
  const Eigen::Index n = Data().measured().size();
  // A line with two numbers, fitted by least squares; the innovations are y - X b, so that J = -X.
  Eigen::MatrixXd X(n, 2);
  X.col(0).setOnes();
  X.col(1) = Noise(1, n);
  const Eigen::VectorXd y = X * Eigen::Vector2d(0.4, -1.3) + Noise(2, n);
  const Eigen::Vector2d b = dense::LeastSquares(X, y);
  Plan plan = FourMasses(0.2);
  Hypothesis two(plan);
  for (const char* name : {"plant.inertia.I1", "plant.inertia.I2"}) {
    Parameter parameter;
    parameter.name = name;
    parameter.lower = -1e3, parameter.upper = 1e3;
    two = two.WithFree(parameter);
  }
  Estimate estimate;
  estimate.q = b;
  estimate.innovations = estimate.weighted = y - X * b;
  estimate.jacobian = -X;
  estimate.scales.assign(2, {1.0, 1.0, 1.0});
  const Eigen::VectorXd left = LeaveBlocksOut(estimate, Data(), two);
  const std::vector<Block> blocks = BlocksOf(Data());
  ASSERT_EQ(blocks.size(), 40U);
  Eigen::MatrixXd others = X;
  Eigen::VectorXd target = y;
  for (const Block::Rows& rows : blocks[7].rows) {
    others.middleRows(rows.begin, rows.count).setZero();
    target.segment(rows.begin, rows.count).setZero();
  }
  const Eigen::Vector2d refitted = dense::LeastSquares(others, target);
  for (const Block::Rows& rows : blocks[7].rows) {
    const Eigen::VectorXd truth = y.segment(rows.begin, rows.count) - X.middleRows(rows.begin, rows.count) * refitted;
    EXPECT_LT((left.segment(rows.begin, rows.count) - truth).cwiseAbs().maxCoeff(), 1e-10);
  }
}

/// A number that only the first rows tell, as where a record starts: leaving them out would put anything in their place.
TEST(LeaveBlocksOut, KeepsWhereARecordStarts) {
  const Eigen::Index n = Data().measured().size();
  const Block::Rows begin = BlocksOf(Data())[0].rows[0];
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, 2);
  J.col(0).setOnes();
  J.col(1).segment(begin.begin, begin.count).setConstant(1e6);
  const auto left = [&](const char* second) {
    Hypothesis two(FourMasses(0.2));
    for (const char* name : {"plant.inertia.I1", second}) {
      Parameter parameter;
      parameter.name = name;
      parameter.lower = -1e3, parameter.upper = 1e3;
      parameter.prior = parameter.name == second;
      two = two.WithFree(parameter);
    }
    Estimate estimate;
    estimate.q = Eigen::Vector2d::Zero();
    estimate.innovations = estimate.weighted = Noise(1, n).array() + 1e-3;
    estimate.jacobian = J;
    estimate.scales.assign(2, {1.0, 1.0, 1.0});
    return LeaveBlocksOut(estimate, Data(), two).segment(begin.begin, begin.count).cwiseAbs().maxCoeff();
  };
  EXPECT_LT(left((StartOfRecord(0) + ".plant.inertia.I2").c_str()), 10.0);
  EXPECT_GT(left("plant.inertia.I2"), 1e3);
}

TEST(Encompassing, SeesWhichModelAddsNothing) {
  const Eigen::Index n = Data().measured().size();
  const Eigen::VectorXd noise = Noise(3, n), missed = Noise(4, n), other = Noise(5, n);
  // The first is right, the second has missed a share of the signal.
  const Weight right = Encompassing(noise, noise + 0.5 * missed, Data(), Alike());
  EXPECT_NEAR(right.lambda, 0.0, 4.0 * right.standard_error);
  EXPECT_EQ(Compare(right), Comparison::kFirst);
  EXPECT_EQ(Compare(Encompassing(noise + 0.5 * missed, noise, Data(), Alike())), Comparison::kSecond);
  // Each has missed another half.
  EXPECT_EQ(Compare(Encompassing(noise + missed, noise + other, Data(), Alike())), Comparison::kBoth);
  // They differ by next to nothing.
  EXPECT_EQ(Compare(Encompassing(noise, noise + 1e-3 * missed, Data(), Alike())), Comparison::kNotSeparable);
  EXPECT_EQ(Compare(Encompassing(noise, noise, Data(), Alike())), Comparison::kNotSeparable);
}

TEST(Encompassing, ErrsAsOftenAsItsErrorSays) {
  const Eigen::Index n = Data().measured().size();
  int beyond = 0;
  constexpr int kDraws = 400;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const Eigen::VectorXd noise = Noise(1000 + draw, n);
    const Weight weight = Encompassing(noise, noise + 0.2 * Noise(5000 + draw, n), Data(), Alike());
    beyond += std::abs(weight.lambda) > 1.96 * weight.standard_error ? 1 : 0;
  }
  // 5 % of 400 are 20 +- 4.4; the larger of two errors is a little large.
  EXPECT_GT(beyond, 5);
  EXPECT_LT(beyond, 33);
}

TEST(WeightsByChannel, AreThoseOfItsRmsAndItsCorrelation) {
  const Eigen::VectorXd weights = WeightsByChannel(Data(), {{2.0, 1.0, 3.0}, {0.5, 1.0, 1.0}});
  const Channel &first = Data().channels()[0], &second = Data().channels()[1];
  EXPECT_TRUE(weights.segment(first.begin, first.count).isConstant(1.0 / 12.0));
  EXPECT_TRUE(weights.segment(second.begin, second.count).isConstant(4.0));
}

TEST(WeightsByBlock, AreThoseOfWhatTheBestLeavesInABlock) {
  const std::vector<ChannelScale> scales = {{1.0, 1.0, 2.0}, {1.0, 1.0, 1.0}};
  const Block::Rows there = BlocksOf(Data())[7].rows[0], elsewhere = BlocksOf(Data())[8].rows[0];
  ASSERT_EQ(there.channel, 0U);
  const double noise = Data().channels()[0].noise;
  Eigen::VectorXd one = Eigen::VectorXd::Constant(Data().measured().size(), 5.0 * noise), other = 2.0 * one, none;
  other.segment(there.begin, there.count).setConstant(3.0 * noise);
  const Eigen::VectorXd left[] = {none, one, other};
  const Eigen::VectorXd weights = WeightsByBlock(left, Data(), scales);
  EXPECT_NEAR(weights[there.begin] * std::pow(3.0 * noise, 2) * 2.0, 1.0, 1e-12);
  EXPECT_NEAR(weights[elsewhere.begin] * std::pow(5.0 * noise, 2) * 2.0, 1.0, 1e-12);
  // Less than noise is chance, or what an input does between its samples.
  const Eigen::VectorXd exact[] = {0.1 * one};
  EXPECT_NEAR(WeightsByBlock(exact, Data(), scales)[there.begin] * std::pow(noise, 2) * 2.0, 1.0, 1e-12);
}

/// An impact that both miss is larger than all else, and says which is right in its block alone.
TEST(WeightsByBlock, KeepAnImpactThatEveryModelMissesFromDeciding) {
  const Eigen::VectorXd noise = Data().channels()[0].noise * Noise(6, Data().measured().size());
  Eigen::VectorXd right = noise, wrong = noise + 0.7 * Data().channels()[0].noise * Noise(7, noise.size());
  const Block block = BlocksOf(Data())[20];
  for (const Block::Rows& rows : block.rows) {
    right[rows.begin] += 100.0 * Data().channels()[0].noise;
    wrong[rows.begin] += 60.0 * Data().channels()[0].noise;
  }
  const std::vector<ChannelScale> scales(2, {1.0, 1.0, 1.0});
  EXPECT_NE(Compare(Encompassing(right, wrong, Data(), Alike())), Comparison::kFirst);
  const Eigen::VectorXd left[] = {right, wrong};
  EXPECT_EQ(Compare(Encompassing(right, wrong, Data(), WeightsByBlock(left, Data(), scales))), Comparison::kFirst);
}

}  // namespace
}  // namespace dynoproof::estimation
