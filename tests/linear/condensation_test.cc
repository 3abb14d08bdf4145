#include "linear/condensation.h"

#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "linear/dense.h"
#include "linear/energy_coordinates.h"
#include "linear/modal_form.h"
#include "tests/support/plants.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kHz = 2.0 * std::numbers::pi;

EnergyCoordinates Coordinates() {
  return *EnergyCoordinates::Build(support::StraightChain(), MatrixXd::Identity(5, 1));
}

/// Between the second and the third of the chain's four modes [rad/s].
double Between() {
  const VectorXd w = Coordinates().frequencies();
  return std::sqrt(w[1] * w[2]);
}

/// Torque at one end of the straight chain; the shaft torque before the last inertia, and that inertia's speed.
LinearSystem Chain() {
  const EnergyCoordinates made = Coordinates();
  return made.System({made.EdgeTorque(3), made.Speed(4)});
}

VectorXd GainAt(const LinearSystem& system, double hz) {
  const std::complex<double> s(0.0, kHz * hz);
  const MatrixXcd resolvent = s * MatrixXcd::Identity(system.states(), system.states()) - system.A;
  const Eigen::VectorXcd x = dense::ComplexSolve(resolvent, system.B.col(0).cast<std::complex<double>>());
  return (system.C.cast<std::complex<double>>() * x + system.D.col(0).cast<std::complex<double>>()).cwiseAbs();
}

TEST(Condensation, LosesOnlyTheInertiaOfTheFastModes) {
  const LinearSystem full = Chain();
  const Condensed condensed = Condense(full, Between());
  ASSERT_EQ(condensed.system.states(), full.states() - 4);
  for (const double of_first : {0.001, 0.1, 0.3}) {
    const double w = of_first * Coordinates().frequencies()[0], hz = w / kHz;
    const VectorXd exact = GainAt(full, hz), near = GainAt(condensed.system, hz);
    // The part of the two fast modes in a gain is below the gain here, so that is the largest error.
    const double share = std::pow(w / Coordinates().frequencies()[2], 2);
    for (Eigen::Index i = 0; i < 2; ++i) EXPECT_NEAR(near[i], exact[i], (share + 1e-6) * exact[i]) << hz << " Hz";
  }
}

TEST(Condensation, KeepsAllBelowTheLimitAndTheRigidBody) {
  const LinearSystem full = Chain();
  const Condensed all = Condense(full, kHz * 1e4);
  EXPECT_EQ(all.system.A, full.A);
  EXPECT_EQ(all.system.D, full.D);
  const Condensed none = Condense(full, 0.0);
  EXPECT_EQ(none.system.states(), 1) << "the rigid body's speed is no spring";
}

// What was kept keeps the exact zeros and signs by which a network in energy coordinates is decomposed quickly.
TEST(Condensation, LeavesWhatIsKeptToTheBit) {
  const LinearSystem full = Chain();
  const Condensed condensed = Condense(full, Between());
  EXPECT_EQ(condensed.system.A, MatrixXd(full.A(condensed.kept, condensed.kept)));
}

// A state of all n coordinates, as a simulation starts from, leads to the kept ones and back.
TEST(Condensation, StatesLeadThereAndBack) {
  const LinearSystem full = Chain();
  const Condensed condensed = Condense(full, Between());
  ModalForm form = ModalForm::Build(condensed.system);
  form.Expand(condensed.follows, condensed.kept);
  EXPECT_EQ(form.dropped_states, 4);
  VectorXd x = VectorXd::Zero(full.states()), back, p_back;
  for (const int k : condensed.kept) x[k] = 1.0 + k;
  std::vector<double> state(static_cast<std::size_t>(form.state_size()));
  form.SetState(x, VectorXd::Constant(1, 0.5), state);
  form.GetState(state, back, p_back);
  for (const int k : condensed.kept) EXPECT_NEAR(back[k], x[k], 1e-12 * x.norm());
  EXPECT_EQ(p_back[0], 0.5);
}

}  // namespace
}  // namespace dynoproof::mechanics
