// The five descriptions of a chain: their printed forms, their transformations and their common eigenvalues.
#include "thesis/descriptions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>

#include "linear/dense.h"
#include "linear/modes.h"
#include "tests/linear/plants.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Chain RandomChain(unsigned seed, int m) { return *ChainOf(RandomTree(seed, m, true)); }

/// Damping in proportion to stiffness keeps all eigenvalues well-conditioned.
Chain TwoMasses() {
  Chain chain{VectorXd(2), VectorXd(1), VectorXd(1)};
  chain.inertia << 2.0, 5.0;
  chain.stiffness << 70.0;
  chain.damping << 3.0;
  return chain;
}

std::vector<Complex> Eigenvalues(const MatrixXd& a) {
  const Eigen::VectorXcd values = dense::Eigenvalues(a);
  return {values.begin(), values.end()};
}

/// Every eigenvalue of `part` is one of `whole`; a tolerance in units of the largest.
void ExpectContained(const std::vector<Complex>& part, const std::vector<Complex>& whole, double tolerance) {
  double size = 0.0;
  for (const Complex& s : whole) size = std::max(size, std::abs(s));
  for (const Complex& s : part) {
    double nearest = INFINITY;
    for (const Complex& t : whole) nearest = std::min(nearest, std::abs(s - t));
    EXPECT_LT(nearest, tolerance * size) << s;
  }
}

TEST(Descriptions, PrintedFormsOfTwoMasses) {
  const Chain chain = TwoMasses();
  const double k = 70.0, c = 3.0, I1 = 2.0, I2 = 5.0, m = 1.0 / I1 + 1.0 / I2;
  const FirstOrder a = Absolute(chain, {0, 0});
  MatrixXd expected(4, 4);
  expected << 0, 1, 0, 0, -k / I1, -c / I1, k / I1, c / I1, 0, 0, 0, 1, k / I2, c / I2, -k / I2, -c / I2;
  EXPECT_LT((a.A - expected).norm(), 1e-14 * expected.norm());
  EXPECT_EQ(a.b, VectorXd::Unit(4, 1) / I1);
  EXPECT_EQ(a.c, (Eigen::RowVector4d() << k, c, -k, -c).finished());

  const FirstOrder d = Differential(chain, {0, 0});
  EXPECT_LT((d.A - (Eigen::Matrix2d() << 0, 1, -k * m, -c * m).finished()).norm(), 1e-13);  // magnitude 49
  EXPECT_EQ(d.b, VectorXd::Unit(2, 1) / I1);
  EXPECT_EQ(d.c, (Eigen::RowVector2d() << k, c).finished());

  const FirstOrder x = Mixed(chain, {0, 0});
  MatrixXd mixed(3, 3);
  mixed << 0, 1, -1, -k / I1, -c / I1, c / I1, k / I2, c / I2, -c / I2;
  EXPECT_LT((x.A - mixed).norm(), 1e-14 * mixed.norm());
  EXPECT_EQ(x.b, VectorXd::Unit(3, 1) / I1);  // not the last entry, as printed
  EXPECT_EQ(x.c, (Eigen::RowVector3d() << k, c, -c).finished());

  const SecondOrder twists = Twists(chain, {0, 0});
  EXPECT_NEAR(twists.K(0, 0), -k * m, 1e-13);
  EXPECT_NEAR(twists.C(0, 0), -c * m, 1e-14);  // with the minus that (2.12) lacks
  EXPECT_EQ(twists.b[0], 1.0 / I1);
}

TEST(Descriptions, ReducedStiffnessMatrixOfAnyLength) {
  const Chain chain = RandomChain(3, 5);
  const MatrixXd k = Twists(chain, {0, 0}).K;
  for (int i = 0; i < 4; ++i) {  // (2.36)
    EXPECT_NEAR(k(i, i) / (-chain.stiffness[i] * (1.0 / chain.inertia[i] + 1.0 / chain.inertia[i + 1])), 1.0, 1e-14);
    if (i < 3) {
      EXPECT_NEAR(k(i, i + 1) / (chain.stiffness[i + 1] / chain.inertia[i + 1]), 1.0, 1e-14);
      EXPECT_NEAR(k(i + 1, i) / (chain.stiffness[i] / chain.inertia[i + 1]), 1.0, 1e-14);
    }
    if (i < 2) {
      EXPECT_EQ(k(i, i + 2), 0.0);
      EXPECT_EQ(k(i + 2, i), 0.0);
    }
  }
}

TEST(Descriptions, TransformationsLeadFromOneToTheOther) {
  for (const int m : {2, 3, 6}) {
    const Chain chain = RandomChain(static_cast<unsigned>(m), m);
    const ChainPorts ports{m > 2 ? 1 : 0, m - 2};
    const FirstOrder a = Absolute(chain, ports), d = Differential(chain, ports), x = Mixed(chain, ports);
    const double size = a.A.norm();
    // (2.21): upper triangular blocks, the lower right one is A_d.
    const MatrixXd t = AbsoluteToDifferential(m), transformed = t * a.A * dense::Inverse(t);
    EXPECT_LT((transformed.bottomRightCorner(2 * m - 2, 2 * m - 2) - d.A).norm(), 1e-13 * size);
    EXPECT_LT(transformed.bottomLeftCorner(2 * m - 2, 2).norm(), 1e-13 * size);
    EXPECT_LT((transformed.topLeftCorner(2, 2) - (Eigen::Matrix2d() << 0, 1, 0, 0).finished()).norm(), 1e-13 * size);
    EXPECT_LT(((t * a.b).tail(2 * m - 2) - d.b).norm(), 1e-14);
    // The same from mixed: [w_1, x_d] with one zero (2.24).
    const MatrixXd z = MixedToDifferential(m), from_mixed = z * x.A * dense::Inverse(z);
    EXPECT_LT((from_mixed.bottomRightCorner(2 * m - 2, 2 * m - 2) - d.A).norm(), 1e-12 * size);
    EXPECT_LT(from_mixed.col(0).norm(), 1e-12 * size);
    EXPECT_LT(((z * x.b).tail(2 * m - 2) - d.b).norm(), 1e-13);
    // (2.25)-(2.27).
    const MatrixXd p = SortAnglesFirst(m);
    EXPECT_EQ(p * p.transpose(), MatrixXd::Identity(2 * m, 2 * m));
    EXPECT_EQ(p * p == MatrixXd::Identity(2 * m, 2 * m), m == 2);  // involutory for two masses only
    EXPECT_EQ(MatrixXd(p * a.A * p.transpose()), Companion(Angles(chain, ports)));
  }
}

TEST(Descriptions, EigenvaluesAgreeUpToZeros) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int m = 2 + static_cast<int>(seed % 6);
    const Chain chain = RandomChain(seed, m);
    const std::vector<Complex> s_d = Eigenvalues(Differential(chain, {0, 0}).A);
    const std::vector<Complex> s_a = Eigenvalues(Absolute(chain, {0, 0}).A);
    const std::vector<Complex> s_m = Eigenvalues(Mixed(chain, {0, 0}).A);
    const std::vector<Complex> s_delta = Eigenvalues(Companion(Twists(chain, {0, 0})));
    // Angles beside speeds, unscaled: entries and condition numbers grow as omega^2 and omega, so that eigenvalues are
    // known to 1e-16 omega^2 = 1e-7 of the largest; the double zero of s_a splits to the root of that.
    ExpectContained(s_d, s_a, 1e-7);      // (2.23)
    ExpectContained(s_d, s_m, 1e-7);      // (2.24)
    ExpectContained(s_delta, s_d, 1e-7);  // (2.33)
    ExpectContained({0.0}, s_m, 1e-7);
    ExpectContained({0.0}, s_a, 3e-4);
    const Result<ModalAnalysis> modal = Modes(NetworkOf(chain));
    ASSERT_TRUE(modal.ok());
    ExpectContained(s_d, modal->DampedEigenvalues(), 1e-7);
    // (2.31): without damping s_phi^2 = s_K.
    const std::vector<Complex> s_k = Eigenvalues(Angles(chain, {0, 0}).K);
    for (const double omega : modal->omega) ExpectContained({-omega * omega}, s_k, 1e-12);
  }
}

TEST(Descriptions, AllHaveTheSameTransferFunction) {
  const Chain chain = RandomChain(9, 4);
  const ChainPorts ports{1, 2};
  const Complex s(-20.0, 900.0);
  const auto response = [&](const FirstOrder& f) {
    const Eigen::MatrixXcd left = s * MatrixXd::Identity(f.A.rows(), f.A.rows()).cast<Complex>() - f.A.cast<Complex>();
    return (f.c.cast<Complex>() * dense::ComplexSolve(left, f.b.cast<Complex>()))(0);
  };
  const auto second = [&](const SecondOrder& f) {
    const Eigen::MatrixXcd left = s * s * MatrixXd::Identity(f.K.rows(), f.K.rows()).cast<Complex>() -
                                  s * f.C.cast<Complex>() - f.K.cast<Complex>();
    return ((f.position.cast<Complex>() + s * f.rate.cast<Complex>()) *
            dense::ComplexSolve(left, f.b.cast<Complex>()))(0);
  };
  const Complex reference = response(Differential(chain, ports));
  for (const Complex value : {response(Absolute(chain, ports)), response(Mixed(chain, ports)),
                              second(Angles(chain, ports)), second(Twists(chain, ports))}) {
    EXPECT_LT(std::abs(value / reference - 1.0), 1e-10);  // condition of the unscaled matrices, about 1e5
  }
}

TEST(Descriptions, ChainOfRefusesOtherNetworks) {
  EXPECT_TRUE(ChainOf(StraightChain()).ok());
  EXPECT_FALSE(ChainOf(Alternative()).ok());
  Network reversed = StraightChain();
  std::swap(reversed.edges[1].from, reversed.edges[1].to);
  EXPECT_EQ(ChainOf(reversed).failure().signal, "k2");
}

TEST(RelativeDegree, LastMarkovParameterOfFourMasses) {
  // (2.80): c S_u = [0 0 0 0 0 k1 k2 k3 / (I1 I2 I3)] / ... with the chain of the description (2.75) without damping.
  Chain chain{VectorXd(4), VectorXd(3), VectorXd::Zero(3)};
  chain.inertia << 2.0, 3.0, 5.0, 7.0;
  chain.stiffness << 11.0, 13.0, 17.0;
  const FirstOrder d = Differential(chain, {0, 2});
  VectorXd power = d.b;
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(d.c * power, 0.0);
    power = (d.A * power).eval();
  }
  EXPECT_NEAR(d.c * power, 11.0 * 13.0 * 17.0 / (2.0 * 3.0 * 5.0), 1e-12);  // magnitude 81: ulps
}

}  // namespace
}  // namespace dynoproof::mechanics
