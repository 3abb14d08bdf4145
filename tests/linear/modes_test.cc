// Undamped modes, energies and damping ratios: the thesis' tables, closed forms, and properties over random networks.
#include "linear/modes.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/linear/plants.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

ModalAnalysis Solve(const Network& network) {
  Result<ModalAnalysis> modal = Modes(network);
  EXPECT_TRUE(modal.ok()) << modal.failure().message;
  return *modal;
}

void ExpectElastic(const Network& network, const std::vector<double>& frequencies_hz) {
  const ModalAnalysis modal = Solve(network);
  ASSERT_EQ(modal.rigid, 1);
  EXPECT_EQ(modal.modes[0].frequency_hz, 0.0);  // exactly
  for (std::size_t i = 0; i < frequencies_hz.size(); ++i) {
    // The figures are given to 0.1 Hz: half a digit.
    EXPECT_NEAR(modal.modes[i + 1].frequency_hz, frequencies_hz[i], 0.051);
  }
}

TEST(Modes, StraightChainOfTableA1) { ExpectElastic(StraightChain(), {390.8, 548.7, 713.9, 1558.5}); }
TEST(Modes, AlternativeOfTableA4) { ExpectElastic(Alternative(), {386.3, 550.0, 710.0, 1577.0}); }
TEST(Modes, SoftRotorOfTableA5) { ExpectElastic(HeavyDuty().network, {389.3, 549.1, 812.9, 1208.5, 1542.2}); }
TEST(Modes, SoftRotorOfTableA7) { ExpectElastic(RoadToRig().network, {605.1, 832.2, 1372.8, 1897.3}); }

TEST(Modes, SingleFreeMass) {
  Network network;
  network.nodes = {{"I", 2.0}};
  const ModalAnalysis modal = Solve(network);
  ASSERT_EQ(modal.modes.size(), 1u);
  EXPECT_EQ(modal.rigid, 1);
  EXPECT_EQ(modal.modes[0].frequency_hz, 0.0);
  EXPECT_EQ(modal.modes[0].damping_ratio, 0.0);
  EXPECT_EQ(modal.modes[0].shape[0], 1.0);
  EXPECT_NEAR(modal.modes[0].kinetic[0], 1.0, 1e-15);  // a few ulps from the root of 2
  EXPECT_EQ(modal.DampedEigenvalues(), (std::vector<std::complex<double>>{0.0, 0.0}));
}

TEST(Modes, MassOnASpringToGround) {
  Network network;
  network.nodes = {{"I", 2.0}};
  network.edges = {{"k", 0, kGround, 800.0, 4.0}};  // nu = 20 rad/s, zeta = c / (2 sqrt(k I)) = 0.05
  const ModalAnalysis modal = Solve(network);
  EXPECT_EQ(modal.rigid, 0);
  // Closed form; a handful of roundings at magnitude 1.
  EXPECT_NEAR(modal.modes[0].frequency_hz * kTwoPi / 20.0, 1.0, 1e-14);
  EXPECT_NEAR(modal.modes[0].damping_ratio, 0.05, 1e-14);
  EXPECT_NEAR(modal.modes[0].strain[0], 0.5, 1e-14);
}

TEST(Modes, OverdampedPairIsRealAndItsRatioAboveOne) {
  Network network;
  network.nodes = {{"I", 1.0}};
  network.edges = {{"k", 0, kGround, 100.0, 52.0}};  // s^2 + 52 s + 100: -2 and -50, zeta = 2.6
  const ModalAnalysis modal = Solve(network);
  EXPECT_NEAR(modal.modes[0].damped.first.real(), -2.0, 1e-12);  // round-off of the eigenvalue problem, size 52
  EXPECT_NEAR(modal.modes[0].damped.second.real(), -50.0, 1e-12);
  EXPECT_EQ(modal.modes[0].damped.first.imag(), 0.0);
  EXPECT_NEAR(modal.modes[0].damping_ratio, 2.6, 1e-12);
}

TEST(Modes, TwoPartsEachKeepTheirRigidMode) {
  Network network;
  network.nodes = {{"a", 1.0}, {"b", 2.0}, {"c", 1.0}, {"d", 2.0}};
  network.edges = {{"ab", 0, 1, 1e4, 0.0}, {"cd", 2, 3, 1e4, 0.0}};  // equal parts: all frequencies repeat
  const ModalAnalysis modal = Solve(network);
  EXPECT_EQ(modal.rigid, 2);
  for (int m = 0; m < 4; ++m) {
    // Each mode lives in one part only, exactly.
    const VectorXd& shape = modal.modes[m].shape;
    EXPECT_TRUE(shape.head(2).isZero(0.0) != shape.tail(2).isZero(0.0)) << m;
  }
  EXPECT_NEAR(modal.omega[2] / std::sqrt(1e4 * 1.5), 1.0, 1e-14);  // closed form
  EXPECT_NEAR(modal.omega[3] / std::sqrt(1e4 * 1.5), 1.0, 1e-14);
}

TEST(Modes, DamperBetweenTwoPartsGivesOneDecay) {
  Network network;
  network.nodes = {{"a", 1.0}, {"b", 2.0}};
  network.edges = {{"oil", 0, 1, 0.0, 6.0}};
  const ModalAnalysis modal = Solve(network);
  EXPECT_EQ(modal.rigid, 2);
  int zeros = 0;
  double decay = 0.0;
  for (const std::complex<double>& s : modal.DampedEigenvalues()) s == 0.0 ? void(++zeros) : void(decay = s.real());
  EXPECT_EQ(zeros, 3);
  EXPECT_NEAR(decay, -9.0, 1e-13);  // -c (1/a + 1/b)
}

TEST(Modes, ThreeEqualBranchesRepeatAFrequency) {
  Network network;
  network.nodes = {{"hub", 3.0}, {"a", 1.0}, {"b", 1.0}, {"c", 1.0}};
  for (int i = 1; i <= 3; ++i) network.edges.push_back({"k" + std::to_string(i), 0, i, 400.0, 0.0});
  const ModalAnalysis modal = Solve(network);
  // Hub at rest: nu^2 = k/I twice. Hub against all: k (1/1 + 3/3).
  EXPECT_NEAR(modal.omega[1], 20.0, 1e-13);
  EXPECT_NEAR(modal.omega[2], 20.0, 1e-13);
  EXPECT_NEAR(modal.omega[3], std::sqrt(800.0), 1e-13);
}

class RandomModes : public testing::TestWithParam<unsigned> {};

TEST_P(RandomModes, DiagonaliseAndShareEnergy) {
  const unsigned seed = GetParam();
  const int n = 3 + static_cast<int>(seed % 9);
  Network network = RandomTree(seed, n, seed % 2 == 0);
  if (seed % 3 == 0) network.edges.push_back({"mesh", n - 1, 0, 3e6, 20.0});
  if (seed % 4 == 0) network.edges.push_back({"ground", n / 2, kGround, 1e6, 10.0});
  const ModalAnalysis modal = Solve(network);
  EXPECT_EQ(modal.rigid, seed % 4 == 0 ? 0 : 1);
  const MatrixXd mass = modal.phi.transpose() * network.Inertias().asDiagonal() * modal.phi;
  EXPECT_LT((mass - MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(), 1e-11);  // round-off times eigenvalue spread
  const MatrixXd stiffness = modal.phi.transpose() * network.StiffnessMatrix() * modal.phi;
  const double top = modal.omega.tail(1)[0] * modal.omega.tail(1)[0];
  EXPECT_LT((stiffness - MatrixXd(modal.omega.cwiseAbs2().asDiagonal())).cwiseAbs().maxCoeff() / top, 1e-13);
  for (int m = 0; m < n; ++m) {
    const Mode& mode = modal.modes[m];
    EXPECT_EQ(mode.shape.cwiseAbs().maxCoeff(), 1.0);
    EXPECT_EQ(mode.shape.maxCoeff(), 1.0);
    EXPECT_NEAR(mode.kinetic.sum(), m < modal.rigid ? 1.0 : 0.5, 1e-11);  // as the mass matrix above
    EXPECT_NEAR(mode.strain.sum(), m < modal.rigid ? 0.0 : 0.5, 1e-11);
    if (m > 0) {
      EXPECT_GE(mode.frequency_hz, modal.modes[m - 1].frequency_hz);
    }
  }
  const Result<VectorXd> alone = UndampedFrequencies(network);
  ASSERT_TRUE(alone.ok());
  EXPECT_LT((*alone * kTwoPi - modal.omega).cwiseAbs().maxCoeff() / modal.omega.maxCoeff(), 1e-11);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomModes, testing::Range(1u, 41u));

TEST(Modes, ThousandSlicesStayOrthogonalAndMatchTheUniformRotor) {
  Network network;
  AddSoftRotor(network, {"r", 25.308, 16.5e6, 85.6, 1000});
  const ModalAnalysis modal = Solve(network);
  const MatrixXd mass = modal.phi.transpose() * network.Inertias().asDiagonal() * modal.phi;
  // Inverse iteration: neighbours are orthogonal to eps over their relative gap, 1e-6 of the norm at worst.
  EXPECT_LT((mass - MatrixXd::Identity(1000, 1000)).cwiseAbs().maxCoeff(), 1e-9);
  for (const int m : {1, 2, 10, 500, 999}) {
    // Free uniform chain: nu_m = 2 sqrt(k/I) sin(m pi/(2 N)) of the slices. The Rayleigh quotient keeps low modes
    // exact.
    const double nu = 2.0 * std::sqrt(16.5e6 * 999.0 * 1000.0 / 25.308) * std::sin(m * std::numbers::pi / 2000.0);
    EXPECT_NEAR(modal.omega[m] / nu, 1.0, 1e-12) << m;
  }
}

TEST(Modes, RefusesWhatHasNoMeaning) {
  Network network;
  EXPECT_FALSE(Modes(network).ok());
  network.nodes = {{"a", 1.0}, {"b", std::nan("")}};
  EXPECT_EQ(Modes(network).failure().signal, "b");
  network.nodes[1].inertia = 0.0;
  EXPECT_FALSE(Modes(network).ok());
  network.nodes[1].inertia = 1.0;
  for (const Edge& edge : {Edge{"e", 0, 0, 1.0, 0.0}, Edge{"e", 0, 2, 1.0, 0.0}, Edge{"e", -1, 1, 1.0, 0.0},
                           Edge{"e", 0, 1, -1.0, 0.0}, Edge{"e", 0, 1, 1.0, std::nan("")}}) {
    network.edges = {edge};
    const Result<ModalAnalysis> modal = Modes(network);
    ASSERT_FALSE(modal.ok());
    EXPECT_EQ(modal.failure().signal, "e");
    EXPECT_EQ(modal.failure().exit_code, 2);
  }
}

}  // namespace
}  // namespace dynoproof::mechanics
