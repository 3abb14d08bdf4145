// Dense algebra where it says more than Eigen does.
#include "linear/dense.h"

#include <gtest/gtest.h>

namespace dynoproof::dense {
namespace {

using Eigen::MatrixXd;

TEST(CovarianceOf, IsTheInverseWhereTheMatrixTellsOfAll) {
  MatrixXd information(3, 3);
  information << 4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0;
  EXPECT_LT((CovarianceOf(information) * information - MatrixXd::Identity(3, 3)).norm(), 1e-14);
}

// A complete orthogonal decomposition takes the small number for one that does nothing, and its variance for next to 0.
TEST(CovarianceOf, KnowsNoNumberBetterForItsSmallUnit) {
  MatrixXd information(2, 2);
  information << 5e7, 20.0, 20.0, 1.5e-5;  // a correlation of 0.73
  const MatrixXd covariance = CovarianceOf(information);
  EXPECT_NEAR(covariance(1, 1) * 1.5e-5 * (1.0 - 400.0 / 750.0), 1.0, 1e-9);
  const Eigen::Vector2d unit(1.0, 1e-7);
  const MatrixXd smaller = CovarianceOf(unit.asDiagonal() * information * unit.asDiagonal());
  EXPECT_NEAR(smaller(1, 1) / (covariance(1, 1) * 1e14), 1.0, 1e-9) << "in any unit it is the same";
}

TEST(CovarianceOf, WhatNothingTellsOfIsNotKnown) {
  MatrixXd information = MatrixXd::Zero(3, 3);
  information.topLeftCorner(2, 2) << 2.0, 2.0, 2.0,
      2.0;  // only the sum of the first two shows, and nothing of the third
  const MatrixXd covariance = CovarianceOf(information);
  EXPECT_TRUE(covariance.allFinite());
  EXPECT_GT(covariance(0, 0), 1e10);
  EXPECT_GT(covariance(2, 2), 1e10);
  const Eigen::Vector3d sum(1.0, 1.0, 0.0);
  EXPECT_NEAR(sum.dot(covariance * sum), 0.5, 1e-3) << "and of the sum as much as there is";
}

TEST(Dense, AModelWithoutNumbersHasEmptyDecompositions) {
  EXPECT_EQ(PseudoInverse(MatrixXd(0, 0)).size(), 0);
  EXPECT_EQ(CovarianceOf(MatrixXd(0, 0)).size(), 0);
  EXPECT_EQ(PseudoInverse(MatrixXd(5, 0)).cols(), 5);
  EXPECT_EQ(LeastSquares(MatrixXd(5, 0), Eigen::VectorXd::Ones(5)).size(), 0);
}

}  // namespace
}  // namespace dynoproof::dense
