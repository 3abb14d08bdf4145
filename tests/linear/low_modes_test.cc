#include "linear/low_modes.h"

#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "linear/dense.h"
#include "linear/energy_coordinates.h"
#include "tests/support/plants.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kHz = 2.0 * std::numbers::pi;
constexpr int kModes = 20;

EnergyCoordinates Line(int modes, const MatrixXd& shapes = MatrixXd(support::SoftRotorR2R().size(), 0)) {
  return *EnergyCoordinates::Build(support::SoftRotorR2R(), support::AirgapR2R(), {modes, shapes});
}

/// The frequency response of the last inertia's speed and of the torque in each shaft to the airgap torque.
Eigen::VectorXcd AnswerOf(const EnergyCoordinates& line, double hz) {
  const Network network = support::SoftRotorR2R();
  std::vector<OutputRow> rows = {line.Speed(network.size() - 1)};
  for (int edge = 0; edge < static_cast<int>(network.edges.size()); ++edge) rows.push_back(line.EdgeTorque(edge));
  const LinearSystem system = line.System(rows);
  const Eigen::MatrixXcd resolvent =
      std::complex<double>(0.0, kHz * hz) * MatrixXd::Identity(system.states(), system.states()) - system.A;
  return system.C.cast<std::complex<double>>() *
         dense::ComplexSolve(resolvent, system.B.col(0).cast<std::complex<double>>());
}

TEST(LowModes, AreThoseOfTheNetworkAndFew) {
  const VectorXd all = Line(0).frequencies(), kept = Line(kModes).frequencies();
  EXPECT_EQ(kept.size(), kModes);
  EXPECT_GT(all.size(), 3 * kModes);
  for (Eigen::Index i = 0; i < kModes / 4; ++i) EXPECT_NEAR(kept[i], all[i], 1e-7 * all[i]) << i;
}

/// The discarded modes keep their static compliance.
TEST(LowModes, WhatIsGivenUpYieldsAsAtRest) {
  const EnergyCoordinates all = Line(0), kept = Line(kModes);
  // The airgap torque is spread over the slices: the shafts between them have a shape that no kept mode has.
  for (const auto& [hz, within] : {std::pair{0.1, 1e-7}, {300.0, 1e-4}, {1000.0, 1e-3}}) {
    const Eigen::VectorXcd exact = AnswerOf(all, hz);
    EXPECT_LT((AnswerOf(kept, hz) - exact).norm(), within * exact.norm()) << hz << " Hz";
  }
}

TEST(LowModes, ATwistThatARunStartsWithStays) {
  const Network network = support::SoftRotorR2R();
  MatrixXd twist = MatrixXd::Zero(network.size(), 1);
  twist.bottomRows(50).setConstant(1e-3);  // of one slice against the next
  MatrixXd x, p, angles, speeds;
  const auto there_and_back = [&](const EnergyCoordinates& line) {
    line.FromPhysical(twist, MatrixXd::Zero(network.size(), 1), x, p);
    line.ToPhysical(x, p, angles, speeds);
    return (angles - twist).norm() / twist.norm();
  };
  EXPECT_LT(there_and_back(Line(kModes, twist)), 1e-9);
  EXPECT_GT(there_and_back(Line(kModes)), 1e-6) << "no force at the rotor does that";
}

/// A fit asks how answers change with a number: what is kept may not turn with round-off.
TEST(LowModes, ChangeSmoothlyWithTheNumbersOfTheLine) {
  const auto frequencies = [](double of_last) {
    Network network = support::SoftRotorR2R();
    network.nodes.back().inertia *= of_last;
    return EnergyCoordinates::Build(network, support::AirgapR2R(), {kModes, MatrixXd(network.size(), 0)})
        ->frequencies();
  };
  const VectorXd at = frequencies(1.0);
  const auto slope = [&](double step) { return VectorXd((frequencies(1.0 + step) - at) / step); };
  EXPECT_LT((slope(1e-6) - slope(1e-4)).cwiseQuotient(at).cwiseAbs().maxCoeff(), 0.05)
      << "where directions of round-off were kept it was some hundred";
}

/// Forces in the middle of a chain of equal inertias move none of the modes in which its ends turn against each other.
TEST(LowModes, HoldThoseThatNoForceReaches) {
  constexpr int kNodes = 61;
  Network network;
  for (int i = 0; i < kNodes; ++i) network.nodes.push_back({"n" + std::to_string(i), 0.02});
  for (int i = 0; i + 1 < kNodes; ++i) network.edges.push_back({"e" + std::to_string(i), i, i + 1, 4e6, 0.0});
  const auto frequencies = [&](int modes) {
    const MatrixXd middle = MatrixXd::Identity(kNodes, kNodes).col(kNodes / 2);
    return EnergyCoordinates::Build(network, middle, {modes, MatrixXd(kNodes, 0)})->frequencies();
  };
  const VectorXd all = frequencies(0), kept = frequencies(kModes);
  for (Eigen::Index i = 0; i < kModes / 4; ++i) EXPECT_NEAR(kept[i], all[i], 1e-3 * all[i]) << i;
}

TEST(LowModes, KeepAllWhereFewWouldBeGivenUp) {
  EXPECT_EQ(Line(60).frequencies(), Line(0).frequencies());
  // Five inertias cost nothing.
  const Network chain = support::StraightChain();
  const MatrixXd at_end = MatrixXd::Identity(5, 1);
  EXPECT_EQ(EnergyCoordinates::Build(chain, at_end, {2, MatrixXd(5, 0)})->frequencies(),
            EnergyCoordinates::Build(chain, at_end)->frequencies());
}

}  // namespace
}  // namespace dynoproof::mechanics
