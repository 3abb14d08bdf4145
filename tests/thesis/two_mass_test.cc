// Two masses: the closed forms of chapter 2 against the transfer functions of the network, and their order.
#include "thesis/two_mass.h"

#include <gtest/gtest.h>

#include <numbers>

#include "linear/frequency_response.h"
#include "thesis/speed_loop.h"

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

Network NetworkOf(const TwoMass& p) {
  Network network;
  network.nodes = {{"I1", p.I1}, {"I2", p.I2}};
  network.edges = {{"k", 0, 1, p.k, p.c}};
  return network;
}

const TwoMass kPlant{4.8, 0.2, 2e6, 60.0};

TEST(TransferFunction, TwoMassesHaveTheirClosedForms) {
  const VectorXd input = VectorXd::Unit(2, 0);
  const TransferFunction torque = Build(NetworkOf(kPlant), input, {OutputKind::kEdgeTorque, 0});
  const TransferFunction speed = Build(NetworkOf(kPlant), input, {OutputKind::kSpeed, 0});
  const TransferFunction angle = Build(NetworkOf(kPlant), input, {OutputKind::kAngle, 0});
  for (const Complex s : {Complex(0.0, 1e-4), Complex(0.0, 10.0), Complex(-5.0, 3000.0), Complex(200.0, 0.0)}) {
    // Both sides are a dozen operations without cancellation.
    EXPECT_LT(std::abs(torque.At(s) / ShaftTorqueTransfer(kPlant, s) - 1.0), 1e-13);
    EXPECT_LT(std::abs(speed.At(s) / SpeedTransfer(kPlant, s) - 1.0), 1e-13);
    EXPECT_LT(std::abs(angle.At(s) * s / SpeedTransfer(kPlant, s) - 1.0), 1e-13);
  }
}

TEST(PracticalResonances, TwoMassesMatchTheClosedForm) {
  for (const double c : {0.0, 60.0, 600.0, 3000.0}) {
    const TwoMass plant{4.8, 0.2, 2e6, c};
    const TransferFunction transfer = Build(NetworkOf(plant), VectorXd::Unit(2, 0), {OutputKind::kEdgeTorque, 0});
    const auto found = PracticalResonances(transfer, 0.0, 5000.0);
    ASSERT_TRUE(found.ok());
    ASSERT_EQ(found->size(), 1u) << c;
    const double nu = ShaftTorqueResonance(plant);
    EXPECT_NEAR((*found)[0].frequency_hz * kTwoPi / nu, 1.0, 1e-6);  // what the function promises
    EXPECT_EQ((*found)[0].unbounded, c == 0.0);
    if (c > 0.0) {
      EXPECT_NEAR((*found)[0].gain / ShaftTorqueGain(plant, nu), 1.0, 1e-9);
    }
  }
}

TEST(TwoMass, FormulasOfTheThesis) {
  const auto [s1, s2] = Eigenvalues(kPlant);
  const double m = 1.0 / 4.8 + 1.0 / 0.2;
  EXPECT_NEAR((s1 * s2).real() / (kPlant.k * m), 1.0, 1e-14);
  EXPECT_NEAR((s1 + s2).real() / (-kPlant.c * m), 1.0, 1e-14);
  EXPECT_EQ(*DampedFrequency(kPlant), s1.imag());
  // (2.14) divides c^2 by 4, (2.17) by 2: the order of the three frequencies.
  EXPECT_LT(*TwistResonance(kPlant), ShaftTorqueResonance(kPlant));
  EXPECT_LT(ShaftTorqueResonance(kPlant), *DampedFrequency(kPlant));
  const double nu = *TwistResonance(kPlant);
  for (const double aside : {0.9999, 1.0001}) EXPECT_LT(TwistGain(kPlant, nu * aside), TwistGain(kPlant, nu));
  const TwoMass overdamped{1.0, 1.0, 100.0, 50.0};  // s^2 + 100 s + 200
  EXPECT_FALSE(DampedFrequency(overdamped).has_value());
  EXPECT_FALSE(TwistResonance(overdamped).has_value());
  EXPECT_NEAR(Eigenvalues(overdamped).first.real(), -50.0 + std::sqrt(2300.0), 1e-13);
}

}  // namespace
}  // namespace dynoproof::mechanics
