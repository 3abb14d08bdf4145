// Left and right eigenvectors of K_Delta and the derivatives of eigenfrequencies, against finite differences.
#include "thesis/eigen_derivatives.h"

#include <gtest/gtest.h>

#include "tests/linear/plants.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(ReducedModes, LeftFollowsFromRight) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Chain chain = *ChainOf(RandomTree(seed, 3 + static_cast<int>(seed % 5), true));
    const Eigen::Index n = chain.stiffness.size();
    const MatrixXd k = Twists(chain, {0, 0}).K;
    const VectorXd l = LeftScaling(chain);
    EXPECT_EQ(l[0], 1.0);
    EXPECT_LT((l.asDiagonal() * k * l.cwiseInverse().asDiagonal() - k.transpose()).norm(), 1e-13 * k.norm());  // (2.39)
    const ReducedModes modes = SolveReduced(chain);
    const MatrixXd lambda = modes.lambda.asDiagonal();
    // Stiffnesses spread over a factor 500, so that scaling by L costs up to two digits.
    EXPECT_LT((k * modes.right - modes.right * lambda).norm(), 1e-12 * k.norm());  // (2.34)
    const MatrixXd left = modes.Left(chain);
    EXPECT_LT((k.transpose() * left - left * lambda).norm() / left.norm(), 1e-12 * k.norm());  // (2.35), (2.44)
    EXPECT_LT((modes.Inverse(chain) * modes.right - MatrixXd::Identity(n, n)).norm(), 1e-11);  // (2.49)
    EXPECT_GT(modes.gamma.minCoeff(), 0.0);
    EXPECT_LT(modes.lambda.maxCoeff(), 0.0);
    const Result<ModalAnalysis> modal = Modes(NetworkOf(chain));
    ASSERT_TRUE(modal.ok());
    for (Eigen::Index m = 0; m < n; ++m) {
      const double square = modal->omega[m + 1] * modal->omega[m + 1];
      EXPECT_LT(std::abs(modes.lambda[m] + square), 1e-13 * k.norm());
    }
  }
}

TEST(ReducedModes, LastInertiaMovesAllFrequenciesDown) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Network network = RandomTree(seed, 3 + static_cast<int>(seed % 4), true);
    const Chain chain = *ChainOf(network);
    const VectorXd derivative = LastInertiaDerivative(chain, SolveReduced(chain));
    const Result<ModalAnalysis> modal = Modes(network);
    ASSERT_TRUE(modal.ok());
    const FrequencyDerivatives general = DifferentiateFrequencies(network, *modal);
    const Eigen::Index last = network.size() - 1;
    for (Eigen::Index m = 0; m < derivative.size(); ++m) {
      EXPECT_GT(derivative[m], 0.0);  // lambda = -nu^2 rises towards zero
      // Two formulas; each carries the error of small entries of its vectors, 1e-15 of the largest derivative.
      EXPECT_NEAR(derivative[m], -general.by_inertia(m + 1, last), 1e-11 * derivative.maxCoeff());
    }
  }
}

/// nu^2 of all modes, elastic ones exact to round-off.
VectorXd Squares(const Network& network) { return Modes(network)->omega.cwiseAbs2(); }

class RandomDerivatives : public testing::TestWithParam<unsigned> {};

TEST_P(RandomDerivatives, MatchCentralDifferences) {
  const unsigned seed = GetParam();
  const int n = 3 + static_cast<int>(seed % 6);
  Network network = RandomTree(seed, n, false);
  if (seed % 2 == 0) network.edges.push_back({"mesh", n - 1, 0, 2e6, 0.0});
  if (seed % 3 == 0) network.edges.push_back({"ground", 1, kGround, 1e6, 0.0});
  const Result<ModalAnalysis> modal = Modes(network);
  ASSERT_TRUE(modal.ok());
  const FrequencyDerivatives d = DifferentiateFrequencies(network, *modal);
  const double step = 1e-5;  // relative: truncation 1e-10, round-off 1e-14 / 1e-5 = 1e-9 of nu^2
  const auto check = [&](double& value, const VectorXd& derivative) {
    const double nominal = value, h = step * nominal;
    value = nominal + h;
    const VectorXd above = Squares(network);
    value = nominal - h;
    const VectorXd below = Squares(network);
    value = nominal;
    const VectorXd difference = (above - below) / (2.0 * h);
    for (int m = 0; m < n; ++m) {
      const double scale = modal->omega[m] * modal->omega[m] / nominal;
      EXPECT_NEAR(difference[m], derivative[m], 1e-6 * scale + 1e-300) << "seed " << seed << " mode " << m;
    }
  };
  for (int i = 0; i < n; ++i) check(network.nodes[i].inertia, d.by_inertia.col(i));
  for (std::size_t e = 0; e < network.edges.size(); ++e) {
    check(network.edges[e].stiffness, d.by_stiffness.col(static_cast<Eigen::Index>(e)));
  }
  // Euler: nu^2 is homogeneous of degree -1 in the inertias and 1 in the stiffnesses.
  const VectorXd inertia = d.by_inertia * network.Inertias();
  for (int m = modal->rigid; m < n; ++m) EXPECT_NEAR(inertia[m] / -std::pow(modal->omega[m], 2), 1.0, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomDerivatives, testing::Range(1u, 25u));

TEST(FrequencyDerivatives, RepeatedFrequencyMovesByOneOnly) {
  // A hub with three equal branches: nu^2 = k/I twice, with the hub at rest.
  Network network;
  network.nodes = {{"hub", 3.0}, {"a", 1.0}, {"b", 1.0}, {"c", 1.0}};
  for (int i = 1; i <= 3; ++i) network.edges.push_back({"k" + std::to_string(i), 0, i, 400.0, 0.0});
  const Result<ModalAnalysis> modal = Modes(network);
  ASSERT_TRUE(modal.ok());
  const FrequencyDerivatives d = DifferentiateFrequencies(network, *modal);
  const double h = 1e-5;
  Network heavier = network;
  heavier.nodes[1].inertia += h;
  Network stiffer = network;
  stiffer.edges[0].stiffness += 400.0 * h;
  for (int m = 1; m <= 3; ++m) {
    // One-sided differences: an error of the order of the step, 1e-5 of derivatives near 400 and 1.
    EXPECT_NEAR((Squares(heavier)[m] - modal->omega[m] * modal->omega[m]) / h, d.by_inertia(m, 1), 0.02) << m;
    EXPECT_NEAR((Squares(stiffer)[m] - modal->omega[m] * modal->omega[m]) / (400.0 * h), d.by_stiffness(m, 0), 5e-5);
  }
  EXPECT_NEAR(d.by_inertia(1, 1), -400.0 * 2.0 / 3.0, 1e-9);  // the pair's shapes have 2/3 of their sum of squares on a
  EXPECT_EQ(d.by_inertia(2, 1), 0.0);
  EXPECT_EQ(d.by_stiffness(1, 0), 0.0);
  EXPECT_NEAR(d.by_stiffness(2, 0), 2.0 / 3.0, 1e-12);
}

TEST(FrequencyDerivatives, SpringBetweenTwoPartsStartsFromZero) {
  Network network;
  network.nodes = {{"a", 2.0}, {"b", 3.0}};
  network.edges = {{"open", 0, 1, 0.0, 0.0}};
  const Result<ModalAnalysis> modal = Modes(network);
  ASSERT_TRUE(modal.ok());
  const FrequencyDerivatives d = DifferentiateFrequencies(network, *modal);
  EXPECT_EQ(d.by_stiffness(0, 0), 0.0);  // the common rigid mode stays
  EXPECT_NEAR(d.by_stiffness(1, 0), 1.0 / 2.0 + 1.0 / 3.0, 1e-15);
}

}  // namespace
}  // namespace dynoproof::mechanics
