// Damped eigenvalues: the dense problem against the iteration, the characteristic equation, and the assignment to
// modes.
#include "linear/damped_eigenvalues.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "linear/dense.h"
#include "linear/forest.h"
#include "tests/linear/plants.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;

/// Largest distance of an eigenvalue of `a` from the nearest of `b`, relative to its size.
double Distance(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  double worst = 0.0;
  for (const Complex& s : a) {
    double nearest = INFINITY;
    for (const Complex& t : b) nearest = std::min(nearest, std::abs(s - t) / std::abs(s));
    worst = std::max(worst, nearest);
  }
  return worst;
}

class SoftRotorSlices : public testing::TestWithParam<int> {};

// 60 slices: all modes oscillate; 300: the upper 123 are overdamped, their slow eigenvalues crowd at -k/c.
TEST_P(SoftRotorSlices, IterationFindsWhatTheDenseProblemFinds) {
  const Network network = HeavyDuty(GetParam()).network;
  const Result<ModalAnalysis> modal = Modes(network);
  ASSERT_TRUE(modal.ok());
  const DampingEstimate estimate = EstimateDamping(network, *modal);
  const auto dense = DenseEigenvalues(network, *modal, estimate);
  const auto iterated = IteratedEigenvalues(network, *modal, estimate);
  ASSERT_TRUE(iterated.has_value());
  ASSERT_EQ(dense.size(), 2u * static_cast<std::size_t>(network.size() - 1));
  ASSERT_EQ(iterated->size(), dense.size());
  // Round-off 1e-16 times norm over the smallest eigenvalue (1e2 to 1e3): worst seen 6e-14.
  EXPECT_LT(Distance(dense, *iterated), 1e-11);
  EXPECT_LT(Distance(*iterated, dense), 1e-11);
}

INSTANTIATE_TEST_SUITE_P(Slices, SoftRotorSlices, testing::Values(60, 150, 300));

TEST(DampedEigenvalues, OverdampedModesOfAFineRotorKeepTheirUndampedFrequency) {
  // Damping in proportion to stiffness, c = beta k: s^2 + beta nu^2 s + nu^2 = 0 mode by mode.
  Network network;
  AddSoftRotor(network, {"r", 25.308, 16.5e6, 85.6, 400});
  const Result<ModalAnalysis> modal = Modes(network);
  ASSERT_TRUE(modal.ok());
  const double beta = 85.6 / 16.5e6;
  int overdamped = 0;
  for (std::size_t m = 1; m < modal->modes.size(); ++m) {
    const Mode& mode = modal->modes[m];
    const double zeta = 0.5 * beta * modal->omega[static_cast<Eigen::Index>(m)];
    overdamped += zeta > 1.0;
    // At zeta = 1 two eigenvalues meet and are known to the root of the precision; worst seen away from it 1e-12.
    EXPECT_NEAR(mode.damping_ratio / zeta, 1.0, std::abs(zeta - 1.0) < 1e-3 ? 1e-6 : 1e-9) << m;
  }
  EXPECT_GT(overdamped, 100);
}

TEST(DampedEigenvalues, AllSatisfyTheCharacteristicEquation) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const int n = 3 + static_cast<int>(seed % 6);
    Network network = RandomTree(seed, n, false);
    for (Edge& edge : network.edges) edge.damping *= seed % 5 == 0 ? 300.0 : 1.0;  // some overdamped
    if (seed % 3 == 0) network.edges.push_back({"mesh", 0, n - 1, 1e6, 30.0});
    const Result<ModalAnalysis> modal = Modes(network);
    ASSERT_TRUE(modal.ok());
    const Eigen::MatrixXcd m = Eigen::MatrixXd(network.Inertias().asDiagonal()).cast<Complex>();
    const Eigen::MatrixXcd c = network.DampingMatrix().cast<Complex>(), k = network.StiffnessMatrix().cast<Complex>();
    for (const Complex& s : modal->DampedEigenvalues()) {
      const Eigen::MatrixXcd q = s * s * m + s * c + k;
      const double size = std::norm(s) * m.norm() + std::abs(s) * c.norm() + k.norm();
      Eigen::MatrixXd real(2 * n, 2 * n);  // has q's singular values, each twice
      real << q.real(), -q.imag(), q.imag(), q.real();
      const double smallest = dense::SingularValues(real).tail(1)[0];
      EXPECT_LT(smallest / size, 1e-12) << "seed " << seed;  // backward error of the eigenvalue problem
      EXPECT_LE(s.real(), 1e-9 * std::abs(s)) << "a passive network does not grow";
    }
  }
}

TEST(DampedEigenvalues, EachModeGetsThePairNearIt) {
  const Network network = StraightChain();
  const Result<ModalAnalysis> modal = Modes(network);
  ASSERT_TRUE(modal.ok());
  for (std::size_t m = 1; m < 5; ++m) {
    const Mode& mode = modal->modes[m];
    EXPECT_GT(mode.damped.first.imag(), 0.0);
    EXPECT_EQ(mode.damped.second, std::conj(mode.damped.first));
    // The heavy dampers of Table A.1 move eigenvalues by up to some per cent, never to the next mode.
    EXPECT_NEAR(std::abs(mode.damped.first) / modal->omega[static_cast<Eigen::Index>(m)], 1.0, 0.05);
  }
}

TEST(Forest, MeshIsNoForestAndParallelShaftsAreOne) {
  EXPECT_FALSE(MakeForest(Alternative()).has_value());
  Network network;
  network.nodes = {{"a", 1.0}, {"b", 2.0}};
  network.edges = {{"k", 0, 1, 300.0, 0.0}, {"c", 1, 0, 0.0, 5.0}, {"none", 0, 1, 0.0, 0.0}};
  const auto forest = MakeForest(network);
  ASSERT_TRUE(forest.has_value());
  EXPECT_EQ(forest->order[0].stiffness, 300.0);
  EXPECT_EQ(forest->order[0].damping, 5.0);
}

TEST(Forest, LogDerivativeIsThatOfTheDeterminant) {
  Network network = RandomTree(7, 6, false);
  network.edges.push_back({"ground", 2, kGround, 2e5, 40.0});
  const auto forest = MakeForest(network);
  ASSERT_TRUE(forest.has_value());
  const auto determinant = [&](Complex s) {
    const Eigen::MatrixXcd q = s * s * Eigen::MatrixXd(network.Inertias().asDiagonal()).cast<Complex>() +
                               s * network.DampingMatrix().cast<Complex>() + network.StiffnessMatrix().cast<Complex>();
    return q.determinant();
  };
  const Complex s(-30.0, 700.0);
  const double h = 1e-3;
  const Complex slope = (determinant(s + h) - determinant(s - h)) / (2.0 * h) / determinant(s);
  const Complex ours = LogDerivative(*forest, network.Inertias(), s);
  EXPECT_LT(std::abs(ours - slope) / std::abs(slope), 1e-7);  // central difference: round-off eps |s| / h
}

}  // namespace
}  // namespace dynoproof::mechanics
