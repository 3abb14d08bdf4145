// Transfer functions: the recursion against the pivoting solver, low frequencies, practical resonances.
#include "linear/frequency_response.h"

#include <gtest/gtest.h>

#include <numbers>

#include "linear/dense.h"
#include "linear/modes.h"
#include "tests/linear/plants.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;
using Eigen::VectorXd;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

TransferFunction Build(const Network& network, const VectorXd& input, Output output) {
  Result<TransferFunction> transfer = TransferFunction::Build(network, input, output);
  EXPECT_TRUE(transfer.ok()) << transfer.failure().message;
  return *transfer;
}

TEST(TransferFunction, ShaftTorqueAtStandstillAcceleratesWhatLiesBeyond) {
  const SoftPlant plant = HeavyDuty();
  const TransferFunction transfer = Build(plant.network, plant.airgap, {OutputKind::kEdgeTorque, plant.k4});
  const double share = 0.159 / plant.network.Inertias().sum();
  EXPECT_NEAR(transfer.At(0.0).real() / share, 1.0, 1e-12);  // 100 slices of round-off
  // At 1 mHz the twist is 1e-12 of the angles: nothing may be lost. The true change with frequency is (f/389 Hz)^2.
  EXPECT_NEAR(transfer.AtFrequency(1e-3).real() / share, 1.0, 1e-10);
}

TEST(TransferFunction, RecursionAgreesWithPivotingSolver) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const int n = 3 + static_cast<int>(seed % 20);
    Network network = RandomTree(seed, n, seed % 2 == 0);
    if (seed % 3 == 0) network.edges.push_back({"ground", 1, kGround, 3e5, 10.0});
    if (seed % 5 == 0) network.edges.push_back({"parallel", network.edges[0].to, network.edges[0].from, 4e5, 7.0});
    const VectorXd input = VectorXd::LinSpaced(n, 1.0, 2.0) / n;
    for (const Output output :
         {Output{OutputKind::kEdgeTorque, 0}, Output{OutputKind::kSpeed, n - 1}, Output{OutputKind::kAngle, 0},
          Output{OutputKind::kEdgeTorque, static_cast<int>(network.edges.size()) - 1}}) {
      const TransferFunction transfer = Build(network, input, output);
      for (double f = 0.1; f < 5000.0; f *= 1.7) {
        const Complex s(0.0, kTwoPi * f), reference = transfer.BySparseLu(s);
        // Damping of 1 % leaves two digits less at a resonance; pivots down to 1e-3 three more.
        EXPECT_LT(std::abs(transfer.At(s) - reference) / std::abs(reference), 1e-9) << "seed " << seed << " f " << f;
      }
    }
  }
}

TEST(TransferFunction, MeshSolvesTheEquationsOfMotion) {
  const Network network = Alternative();
  VectorXd input(5);
  input << 23.534, 0.285, 0.475, 0.0, 0.0;
  input /= input.sum();
  const TransferFunction transfer = Build(network, input, {OutputKind::kEdgeTorque, 4});
  for (const double f : {50.0, 386.0, 1000.0}) {
    const Complex s(0.0, kTwoPi * f);
    const Eigen::MatrixXcd q = s * s * Eigen::MatrixXd(network.Inertias().asDiagonal()).cast<Complex>() +
                               s * network.DampingMatrix().cast<Complex>() + network.StiffnessMatrix().cast<Complex>();
    const Eigen::VectorXcd phi = dense::ComplexSolve(q, input.cast<Complex>());
    const Complex torque = (network.edges[4].stiffness + s * network.edges[4].damping) * (phi[1] - phi[4]);
    EXPECT_LT(std::abs(transfer.At(s) / torque - 1.0), 1e-9);  // the direct solution subtracts angles
  }
}

TEST(TransferFunction, RefusesWhatDoesNotFit) {
  Network network;
  network.nodes = {{"I1", 4.8}, {"I2", 0.2}};
  network.edges = {{"k", 0, 1, 2e6, 60.0}};
  EXPECT_FALSE(TransferFunction::Build(network, VectorXd::Ones(3), {OutputKind::kSpeed, 0}).ok());
  EXPECT_FALSE(TransferFunction::Build(network, VectorXd::Constant(2, NAN), {OutputKind::kSpeed, 0}).ok());
  EXPECT_FALSE(TransferFunction::Build(network, VectorXd::Ones(2), {OutputKind::kEdgeTorque, 1}).ok());
  EXPECT_FALSE(TransferFunction::Build(network, VectorXd::Ones(2), {OutputKind::kAngle, -1}).ok());
}

TEST(PracticalResonances, SoftRotorPeaksLieNextToItsModesAndStandOut) {
  const SoftPlant plant = HeavyDuty();
  const TransferFunction transfer = Build(plant.network, plant.airgap, {OutputKind::kEdgeTorque, plant.k4});
  const auto found = PracticalResonances(transfer, 10.0, 1700.0);
  ASSERT_TRUE(found.ok());
  ASSERT_EQ(found->size(), 4u);  // 1208 Hz hides behind the zero at 1204.7 Hz
  const double modes[] = {389.28, 549.15, 812.86, 1542.21};
  for (std::size_t i = 0; i < 4; ++i) {
    const Resonance& resonance = (*found)[i];
    // Practical resonance and eigenfrequency differ, but by less than 0.3 % at these dampings (thesis Sec. 2.2.2).
    EXPECT_NEAR(resonance.frequency_hz / modes[i], 1.0, 3e-3);
    // The search works on the logarithm: a few ulps.
    EXPECT_NEAR(std::abs(transfer.AtFrequency(resonance.frequency_hz)) / resonance.gain, 1.0, 1e-14);
    for (const double aside : {1.0 - 2e-5, 1.0 + 2e-5}) {
      EXPECT_LT(std::abs(transfer.AtFrequency(resonance.frequency_hz * aside)), resonance.gain);
    }
  }
}

TEST(PracticalResonances, NarrowPeaksAreNotMissed) {
  // Damping ratios near 1e-5: every mode is a peak some mHz wide in a range of kHz.
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Network network = RandomTree(seed, 6, true);
    for (Edge& edge : network.edges) edge.damping *= 1e-3;
    const TransferFunction transfer = Build(network, VectorXd::Unit(6, 0), {OutputKind::kSpeed, 0});
    const auto modal = Modes(network);
    ASSERT_TRUE(modal.ok());
    const auto found = PracticalResonances(transfer, 1.0, 1.1 * modal->modes.back().frequency_hz);
    ASSERT_TRUE(found.ok());
    for (std::size_t m = 1; m < 6; ++m) {
      const double f = modal->modes[m].frequency_hz;
      // A driving-point response shows all modes, except those that hardly move the first node.
      if (std::abs(modal->modes[m].shape[0]) < 1e-2) continue;
      double nearest = INFINITY;
      for (const Resonance& r : *found) nearest = std::min(nearest, std::abs(r.frequency_hz / f - 1.0));
      EXPECT_LT(nearest, 1e-5) << "seed " << seed << " mode " << f;
    }
  }
}

}  // namespace
}  // namespace dynoproof::mechanics
