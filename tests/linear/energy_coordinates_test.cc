#include "linear/energy_coordinates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "linear/dense.h"
#include "tests/support/plants.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;

constexpr double kHz = 2.0 * std::numbers::pi;

EnergyCoordinates Coordinates(const Network& network, const MatrixXd& weights) {
  auto result = EnergyCoordinates::Build(network, weights);
  EXPECT_TRUE(result.ok());
  return *std::move(result);
}

/// Two free parts with a damping-only link, a part on a spring to the ground, and one with ground damping only.
Network FourParts() {
  Network network;
  network.nodes = {{"a", 2.0}, {"b", 0.5}, {"c", 0.3}, {"d", 1.0}, {"e", 0.2}, {"f", 0.7}};
  network.edges = {{"ab", 0, 1, 1e4, 2.0},
                   {"bc", 1, 2, 0.0, 3.0},
                   {"cd", 2, 3, 5e4, 0.0},
                   {"ground", 4, kGround, 1e3, 0.1},
                   {"brake", 5, kGround, 0.0, 4.0}};
  return network;
}

TEST(EnergyCoordinates, FrequenciesOfTheThesisPlants) {
  // Table A.1 and A.7: independently computed values, printed to 0.1 Hz.
  const auto chain = Coordinates(support::StraightChain(), MatrixXd::Zero(5, 1));
  const double expected_chain[] = {390.8, 548.7, 713.9, 1558.5};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(chain.frequencies()[i] / kHz, expected_chain[i], 0.05);
  const auto rotor = Coordinates(support::SoftRotorR2R(), support::AirgapR2R());
  const double expected_rotor[] = {605.1, 832.2, 1372.8, 1897.3};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(rotor.frequencies()[i] / kHz, expected_rotor[i], 0.05);
}

TEST(EnergyCoordinates, UndampedSystemIsExactlySkewAndDampingOnlyTakesEnergy) {
  Network network = support::SoftRotorR2R();
  const MatrixXd A = Coordinates(network, support::AirgapR2R()).System({}).A;
  EXPECT_LE(dense::SymmetricValues(A + A.transpose()).maxCoeff(), 1e-9 * A.norm());
  for (Edge& edge : network.edges) edge.damping = 0.0;
  const MatrixXd undamped = Coordinates(network, support::AirgapR2R()).System({}).A;
  EXPECT_EQ((undamped + undamped.transpose()).cwiseAbs().maxCoeff(), 0.0);
}

TEST(EnergyCoordinates, RigidMotionIsExactlyFree) {
  const Network network = support::SoftRotorR2R();
  const auto coordinates = Coordinates(network, support::AirgapR2R());
  ASSERT_EQ(coordinates.rigid_modes(), 1);
  const LinearSystem system = coordinates.System({coordinates.EdgeTorque(network.FindEdge("k4"))});
  const int rigid = coordinates.states() - 1;
  EXPECT_TRUE((system.A.row(rigid).array() == 0.0).all());
  EXPECT_TRUE((system.A.col(rigid).array() == 0.0).all());
  EXPECT_EQ(system.C(0, rigid), 0.0);
  EXPECT_EQ(system.E(0, 0), 0.0);
  EXPECT_EQ((coordinates.Twist(3, 50).e.array() != 0.0).count(), 0);
}

TEST(EnergyCoordinates, PartsLinksAndGroundDecideOnRigidModes) {
  const auto coordinates = Coordinates(FourParts(), MatrixXd::Identity(6, 6));
  EXPECT_EQ(coordinates.rigid_modes(), 3);    // ab, cd, f; e hangs on the ground
  EXPECT_EQ(coordinates.elastic_modes(), 3);  // one in ab, one in cd, one of e
  const LinearSystem system = coordinates.System({});
  const int ab = 6, cd = 7, f = 8;
  EXPECT_NEAR(system.A(ab, ab), -3.0 / 2.5, 1e-15);
  EXPECT_NEAR(system.A(ab, cd), 3.0 / std::sqrt(2.5 * 1.3), 1e-15);
  EXPECT_NEAR(system.A(f, f), -4.0 / 0.7, 1e-14);
  EXPECT_EQ(system.A(f, ab), 0.0);
  // The gap's twist is one integrator of its own; the first part's large angle does not enter.
  const OutputRow gap = coordinates.EdgeTwist(1);
  EXPECT_EQ(gap.e[0], 0.0);
  EXPECT_EQ(gap.e[1], -1.0);
}

/// Edge torques per node torque at j w, from the equations of motion alone.
MatrixXcd DirectResponse(const Network& network, double w) {
  const std::complex<double> jw(0.0, w);
  const MatrixXcd dynamic = network.StiffnessMatrix() + jw * network.DampingMatrix() -
                            w * w * MatrixXcd(network.Inertias().cast<std::complex<double>>().asDiagonal());
  const MatrixXcd angles = dense::ComplexInverse(dynamic);
  MatrixXcd torques = network.Incidence() * angles;
  for (int e = 0; e < torques.rows(); ++e) torques.row(e) *= network.edges[e].stiffness + jw * network.edges[e].damping;
  return torques;
}

TEST(EnergyCoordinates, ResponseEqualsTheEquationsOfMotion) {
  for (const Network& network : {FourParts(), support::StraightChain()}) {
    const auto coordinates = Coordinates(network, MatrixXd::Identity(network.size(), network.size()));
    std::vector<OutputRow> rows;
    for (std::size_t e = 0; e < network.edges.size(); ++e) rows.push_back(coordinates.EdgeTorque(static_cast<int>(e)));
    const LinearSystem system = coordinates.System(rows);
    for (const double w : {10.0, 300.0, 3000.0}) {
      const std::complex<double> jw(0.0, w);
      const MatrixXcd resolvent =
          dense::ComplexInverse(jw * MatrixXcd::Identity(system.states(), system.states()) - system.A);
      const MatrixXcd x = resolvent * system.B;
      const MatrixXcd response = system.C * x + system.E * (system.P * x) / jw;
      const MatrixXcd direct = DirectResponse(network, w);
      // Round-off of two solves whose matrices have a condition of up to some 1e4.
      EXPECT_LE((response - direct).cwiseAbs().maxCoeff(), 1e-10 * direct.cwiseAbs().maxCoeff()) << w;
    }
  }
}

TEST(EnergyCoordinates, PhysicalStateGoesThereAndBack) {
  const Network network = FourParts();
  const auto coordinates = Coordinates(network, MatrixXd::Identity(6, 6));
  VectorXd angles(6), speeds(6);
  angles << 1e4, 1e4 + 1e-3, 1e4 + 0.02, 1e4 + 0.021, 0.3, -5.0;
  speeds << 100.0, 101.0, 99.0, 98.0, 0.5, 7.0;
  MatrixXd x, p, angles_back, speeds_back;
  coordinates.FromPhysical(angles, speeds, x, p);
  const LinearSystem system = coordinates.System(
      {coordinates.EdgeTwist(0), coordinates.EdgeTwist(1), coordinates.Angle(5), coordinates.Speed(3)});
  const MatrixXd y = system.C * x + system.E * p;
  // An angle of 1e4 rad is known to 2e-12; sums over a few nodes.
  EXPECT_NEAR(y(0, 0), -1e-3, 2e-11);
  EXPECT_NEAR(y(1, 0), 1e-3 - 0.02, 2e-11);
  EXPECT_NEAR(y(2, 0), -5.0, 2e-11);
  EXPECT_NEAR(y(3, 0), 98.0, 1e-12);
  coordinates.ToPhysical(x, p, angles_back, speeds_back);
  EXPECT_LE((angles_back - angles).cwiseAbs().maxCoeff(), 2e-11);
  EXPECT_LE((speeds_back - speeds).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(EnergyCoordinates, EnergyIsHalfTheSquare) {
  const Network network = support::StraightChain();
  const auto coordinates = Coordinates(network, MatrixXd::Zero(5, 1));
  VectorXd angles(5), speeds(5);
  MatrixXd x, p;
  angles << 0.0, 1e-3, -2e-3, 4e-3, 1e-3;
  speeds << 3.0, -1.0, 2.0, 0.5, -4.0;
  coordinates.FromPhysical(angles, speeds, x, p);
  const double energy =
      0.5 * angles.dot(network.StiffnessMatrix() * angles) + 0.5 * speeds.dot(network.Inertias().cwiseProduct(speeds));
  EXPECT_NEAR(0.5 * x.squaredNorm(), energy, 1e-12 * energy);  // round-off of a few dozen products
}

TEST(EnergyCoordinates, RefusesWhatIsNotANetwork) {
  const auto message = [](const Network& network, const MatrixXd& weights) {
    const auto result = EnergyCoordinates::Build(network, weights);
    if (result.ok()) return std::string("accepted");
    EXPECT_EQ(result.failure().exit_code, 2);
    return result.failure().message;
  };
  const Network good = support::StraightChain();
  EXPECT_EQ(message(good, MatrixXd::Zero(5, 1)), "accepted");
  EXPECT_THAT(message({}, MatrixXd()), HasSubstr("at least one inertia"));
  EXPECT_THAT(message(good, MatrixXd::Zero(4, 1)), HasSubstr("torque weights"));
  Network bad = good;
  bad.nodes[1].inertia = 0.0;
  EXPECT_THAT(message(bad, MatrixXd::Zero(5, 1)), HasSubstr("inertia"));
  bad = good;
  bad.edges[0].stiffness = std::nan("");
  EXPECT_THAT(message(bad, MatrixXd::Zero(5, 1)), HasSubstr("stiffness"));
  bad = good;
  bad.edges[0].to = bad.edges[0].from;
  EXPECT_THAT(message(bad, MatrixXd::Zero(5, 1)), HasSubstr("two different"));
}

}  // namespace
}  // namespace dynoproof::mechanics
