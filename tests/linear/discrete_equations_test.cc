#include "linear/discrete_equations.h"

#include <gtest/gtest.h>

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Two oscillators, one of them slightly damped, over one period.
MatrixXd Oscillators() {
  MatrixXd a = MatrixXd::Zero(4, 4);
  a.topLeftCorner(2, 2) << 0.90, 0.42, -0.42, 0.90;
  a.bottomRightCorner(2, 2) << 0.60, 0.70, -0.70, 0.60;
  a(0, 2) = 0.1;
  return a;
}

TEST(DiscreteEquations, TheStationaryCovarianceIsTheLimitOfItsRecursion) {
  const MatrixXd a = Oscillators(), q = MatrixXd::Identity(4, 4);
  MatrixXd x = MatrixXd::Zero(4, 4);
  for (int i = 0; i < 20'000; ++i) x = (a * x * a.transpose() + q).eval();
  EXPECT_LT((StationaryCovariance(a, q) - x).norm(), 1e-9 * x.norm());
}

TEST(DiscreteEquations, TheStationaryFilterIsTheLimitOfTheKalmanFilter) {
  const MatrixXd a = Oscillators();
  MatrixXd c(1, 4), q = MatrixXd::Zero(4, 4);
  c << 1.0, 0.0, 0.5, 0.0;
  q(1, 1) = 0.3, q(3, 3) = 0.1;
  const VectorXd r = VectorXd::Constant(1, 0.7);
  MatrixXd p = MatrixXd::Identity(4, 4), k;
  for (int i = 0; i < 5'000; ++i) {
    k = p * c.transpose() / ((c * p * c.transpose())(0, 0) + r[0]);
    p = (a * (p - k * c * p) * a.transpose() + q).eval();
  }
  const StationaryFilter filter = MakeStationaryFilter(a, c, q, r);
  EXPECT_LT((filter.gain - k).norm(), 1e-10 * k.norm());
  EXPECT_LT((filter.covariance - p).norm(), 1e-10 * p.norm());
}

TEST(DiscreteEquations, BalancingKeepsWhatIsMovedAndSeen) {
  // A fifth state integrates the first and is not seen; a sixth is seen and not moved.
  MatrixXd a = MatrixXd::Zero(6, 6);
  a.topLeftCorner(4, 4) = Oscillators();
  a(4, 0) = 1.0, a(4, 4) = 1.0, a(5, 5) = 0.5;
  MatrixXd b = MatrixXd::Zero(6, 1), c = MatrixXd::Zero(1, 6);
  b(1, 0) = 1.0, b(3, 0) = 0.2;
  c(0, 0) = 1.0, c(0, 2) = 1.0, c(0, 5) = 1.0;
  const BalancedPart part = Balance(a, b, c, 0.9999, 40);
  ASSERT_EQ(part.basis.cols(), 4);
  EXPECT_LT((part.reduction * part.basis - MatrixXd::Identity(4, 4)).norm(), 1e-9);
  MatrixXd whole = b, small = part.reduction * b;
  for (int k = 0; k < 200; ++k) {
    EXPECT_NEAR((c * whole)(0, 0), (c * part.basis * small)(0, 0), 1e-9);
    whole = (a * whole).eval();
    small = (part.reduction * a * part.basis * small).eval();
  }
  EXPECT_EQ(Balance(a, b, c, 0.9999, 2).basis.cols(), 2);
}

TEST(DiscreteEquations, TheRangeOfAGramianIsWhatIsSeen) {
  // One integrates the first and is not seen: no gain moves its eigenvalue, and in what is seen it is none.
  MatrixXd a = MatrixXd::Zero(5, 5);
  a.topLeftCorner(4, 4) = Oscillators();
  a(4, 0) = 1.0, a(4, 4) = 1.0;
  MatrixXd c = MatrixXd::Zero(1, 5);
  c(0, 0) = 1.0, c(0, 2) = 1.0;
  const MatrixXd seen = RangeOf(Observability(a, c, 0.99));
  ASSERT_EQ(seen.cols(), 4);
  EXPECT_LT((seen.transpose() * seen - MatrixXd::Identity(4, 4)).norm(), 1e-12);
  MatrixXd whole = c, part = c * seen;
  for (int k = 0; k < 50; ++k) {
    EXPECT_LT((whole * seen - part).norm(), 1e-9) << k;
    whole = (whole * a).eval();
    part = (part * seen.transpose() * a * seen).eval();
  }
}

}  // namespace
}  // namespace dynoproof::mechanics
