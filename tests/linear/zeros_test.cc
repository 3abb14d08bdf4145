// Transmission zeros: the figures of Table A.5, closed forms, and properties over random networks.
#include "linear/zeros.h"

#include <gtest/gtest.h>

#include "linear/modes.h"
#include "linear/zero_dynamics.h"
#include "tests/linear/plants.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;
using Eigen::VectorXd;

ZeroAnalysis Solve(const Network& network, const VectorXd& input, Output output) {
  Result<ZeroAnalysis> zeros = TransferZeros(network, input, output);
  EXPECT_TRUE(zeros.ok()) << zeros.failure().message;
  return *zeros;
}

int CountOscillatory(const ZeroAnalysis& analysis) {
  int count = 0;
  for (const Zero& zero : analysis.zeros) count += zero.oscillatory;
  return count;
}

Network WithoutDamping(Network network) {
  for (Edge& edge : network.edges) edge.damping = 0.0;
  return network;
}

TEST(Zeros, SoftRotorOfTableA5) {
  const SoftPlant plant = HeavyDuty();
  const ZeroAnalysis zeros = Solve(plant.network, plant.airgap, {OutputKind::kEdgeTorque, plant.k4});
  const double expected[] = {401.7, 892.5, 1204.7};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(zeros.zeros[i].frequency_hz, expected[i], 0.051);  // given to 0.1 Hz
    EXPECT_TRUE(zeros.zeros[i].oscillatory);
  }
  // Nothing near 725 Hz: that dip is a minimum of the magnitude.
  EXPECT_GT(zeros.zeros[1].frequency_hz, 800.0);
  // Seven damped shafts lie between the last slice with torque and the flange: each a real zero -k/c, five alike.
  EXPECT_EQ(zeros.relative_degree, 7);
  std::vector<double> real;
  for (const Zero& zero : zeros.zeros) {
    if (!zero.oscillatory) real.push_back(zero.s.real());
  }
  ASSERT_EQ(real.size(), 7u);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(real[i] / (-16.5e6 / 85.6), 1.0, 1e-14);  // one division
  EXPECT_NEAR(real[5] / (-5.1e6 / 18.2), 1.0, 1e-14);
  EXPECT_NEAR(real[6] / (-7.99e6 / 23.0), 1.0, 1e-14);
}

TEST(Zeros, NaiveChainHasNone) {
  const Network chain = StraightChain();
  const ZeroAnalysis zeros = Solve(chain, VectorXd::Unit(5, 0), {OutputKind::kEdgeTorque, 3});
  EXPECT_EQ(CountOscillatory(zeros), 0);
  ASSERT_EQ(zeros.zeros.size(), 2u);                             // k1/c1, k2/c2; c3 = c4 = 0
  EXPECT_NEAR(zeros.zeros[0].s.real(), -17.99e6 / 800.0, 1e-9);  // relative 1e-14
  EXPECT_NEAR(zeros.zeros[1].s.real(), -60.99e6 / 850.4, 1e-9);
  EXPECT_EQ(zeros.relative_degree, 6);  // 8 less two dampers
}

TEST(Zeros, ClosedFormsOfThreeMasses) {
  const double k1 = 3e6, I1 = 12.0, I2 = 8.0;
  Network network;
  network.nodes = {{"I1", I1}, {"I2", I2}, {"I3", 0.4}};
  network.edges = {{"k1", 0, 1, k1, 0.0}, {"k2", 1, 2, 5e6, 0.0}};
  const Output output{OutputKind::kEdgeTorque, 1};
  const auto only_zero = [&](VectorXd input) {
    const ZeroAnalysis zeros = Solve(network, input, output);
    EXPECT_EQ(zeros.zeros.size(), 1u);
    EXPECT_NEAR(zeros.zeros[0].damping_ratio, 0.0, 1e-12);
    return zeros.zeros[0].s.imag();
  };
  // An eigenvalue problem of size 4 at round-off, polished.
  EXPECT_NEAR(only_zero(VectorXd::Unit(3, 1)) / CounterOscillatorZero(k1, I1), 1.0, 1e-12);  // (2.87)
  VectorXd proportional(3);
  proportional << I1 / (I1 + I2), I2 / (I1 + I2), 0.0;
  EXPECT_NEAR(only_zero(proportional) / ProportionalInputZero(k1, I1, I2), 1.0, 1e-12);  // (2.92)
  for (const double kappa1 : {0.1, 0.5, 0.9}) {
    VectorXd split(3);
    split << kappa1, 1.0 - kappa1, 0.0;
    const double nu = only_zero(split);
    EXPECT_NEAR(nu / SplitInputZero(k1, I1, kappa1, 1.0 - kappa1), 1.0, 1e-12);  // (2.93)
    EXPECT_GT(nu, CounterOscillatorZero(k1, I1));
  }
}

TEST(Zeros, DampedCounterOscillator) {
  // Input on I2: the zeros are the eigenvalues of I1 on k1, c1 against a fixed I2, and -k2/c2.
  Network network;
  network.nodes = {{"I1", 2.0}, {"I2", 1.0}, {"I3", 0.5}};
  network.edges = {{"k1", 0, 1, 800.0, 4.0}, {"k2", 1, 2, 900.0, 3.0}};
  const ZeroAnalysis zeros = Solve(network, VectorXd::Unit(3, 1), {OutputKind::kEdgeTorque, 1});
  ASSERT_EQ(zeros.zeros.size(), 2u);
  EXPECT_NEAR(zeros.zeros[0].damping_ratio, 0.05, 1e-13);  // 2 s^2 + 4 s + 800
  EXPECT_NEAR(std::abs(zeros.zeros[0].s), 20.0, 1e-11);
  EXPECT_NEAR(zeros.zeros[1].s.real(), -300.0, 1e-12);
}

TEST(Zeros, BranchBesideThePathBlocksWhereItResonatesClamped) {
  // Input on the left, torque read on the right, a branch of one mass hanging on the middle node: 2 s^2 + 4 s + 800.
  Network network;
  network.nodes = {{"left", 1.0}, {"middle", 3.0}, {"right", 0.5}, {"branch", 2.0}};
  network.edges = {{"k1", 0, 1, 700.0, 0.0}, {"k2", 1, 2, 900.0, 0.0}, {"kb", 1, 3, 800.0, 4.0}};
  const ZeroAnalysis zeros = Solve(network, VectorXd::Unit(4, 0), {OutputKind::kEdgeTorque, 1});
  ASSERT_EQ(zeros.zeros.size(), 1u);
  EXPECT_NEAR(std::abs(zeros.zeros[0].s), 20.0, 1e-12);  // closed form at round-off
  EXPECT_NEAR(zeros.zeros[0].damping_ratio, 0.05, 1e-14);
  EXPECT_EQ(zeros.relative_degree, 4);  // 8 - 2 poles besides the rigid motion, two zeros
}

TEST(Zeros, MeshedStructureOfTableA4) {
  const Network network = Alternative();
  VectorXd input(5);
  input << 23.534, 0.285, 0.475, 0.0, 0.0;
  input /= input.sum();
  const ZeroAnalysis zeros = Solve(network, input, {OutputKind::kEdgeTorque, 4});
  EXPECT_EQ(CountOscillatory(zeros), 3);
  // I4 hangs on I2 alone: clamped at I2 it blocks at sqrt(k24/I4), s^2 I4 + s c24 + k24.
  bool found = false;
  for (const Zero& zero : zeros.zeros) found = found || std::abs(std::abs(zero.s) - std::sqrt(0.29e6 / 0.045)) < 1e-6;
  EXPECT_TRUE(found);
}

class RandomZeros : public testing::TestWithParam<unsigned> {};

TEST_P(RandomZeros, TransferVanishesThereAndOrdersAddUp) {
  const unsigned seed = GetParam();
  const int n = 4 + static_cast<int>(seed % 7);
  Network network = RandomTree(seed, n, seed % 2 == 0);
  if (seed % 3 == 0) network.edges.push_back({"mesh", n - 1, 0, 3e6, 20.0});
  if (seed % 4 == 0) network.edges.push_back({"ground", 1, kGround, 1e6, 10.0});
  std::mt19937 random(seed + 1000);
  VectorXd input = VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) input[i] = random() % 2 == 0 ? 0.0 : LogUniform(random, 0.1, 1.0);
  input[static_cast<int>(seed) % n] += 0.3;
  for (const Output output : {Output{OutputKind::kEdgeTorque, n - 2}, Output{OutputKind::kEdgeTorque, 0},
                              Output{OutputKind::kSpeed, n - 1}, Output{OutputKind::kAngle, 0}}) {
    const ZeroAnalysis zeros = Solve(network, input, output);
    const TransferFunction transfer = *TransferFunction::Build(network, input, output);
    for (const Zero& zero : zeros.zeros) {
      if (!zero.oscillatory) continue;
      double around = 0.0;
      for (const Complex turn : {Complex(1.0, 0.0), Complex(0.0, 1.0), Complex(-1.0, 0.0), Complex(0.0, -1.0)}) {
        around = std::max(around, std::abs(transfer.At(zero.s * (1.0 + 1e-3 * turn))));
      }
      // A simple zero known to 1e-9 leaves 1e-6 of the value 1e-3 beside it.
      EXPECT_LT(std::abs(transfer.At(zero.s)), 1e-6 * around) << "seed " << seed << " s " << zero.s;
    }
    // None is missing: plain projection, which follows no shafts, knows no others. A speed has the zeros of its angle.
    std::vector<Complex> roots;
    const OutputKind kind = output.kind == OutputKind::kSpeed ? OutputKind::kAngle : output.kind;
    ASSERT_FALSE(ProjectedRoots(network, input, {kind, output.index}, roots).has_value());
    const std::vector<Complex> poles = Modes(network)->DampedEigenvalues();
    int slow = 0;
    for (const Complex& s : roots) {
      // Fast damped zeros crowd at the -k/c of the shafts, where plain projection is ill-conditioned.
      if (s.imag() < 1.0 || -s.real() > 0.3 * std::abs(s)) continue;
      ++slow;
      double nearest = INFINITY;
      for (const Zero& zero : zeros.zeros) nearest = std::min(nearest, std::abs(zero.s - s) / std::abs(s));
      // The projection knows the cancelled ones as well: they are poles.
      for (const Complex& pole : poles) nearest = std::min(nearest, std::abs(pole - s) / std::abs(s));
      EXPECT_LT(nearest, 1e-7) << "seed " << seed << " s " << s;  // polished both; double zeros to the root of 1e-16
    }
    int listed = 0;
    for (const Zero& zero : zeros.zeros) listed += zero.s.imag() >= 1.0 && zero.damping_ratio <= 0.3;
    EXPECT_EQ(listed + zeros.cancelled / 2, slow) << "seed " << seed;
    // G falls by 10^degree a decade far above all poles and zeros.
    const Complex s(0.0, 1e9);
    const double slope = std::log10(std::abs(transfer.BySparseLu(s)) / std::abs(transfer.BySparseLu(10.0 * s)));
    EXPECT_NEAR(slope, zeros.relative_degree, 0.02) << "seed " << seed;  // 1/s of poles at 1e5 to 1e7
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomZeros, testing::Range(1u, 41u));

TEST(Zeros, FactorsAgreeWithPlainProjection) {
  // The same roots without following the shafts back.
  const Network network = RandomTree(5, 8, true);
  const VectorXd input = VectorXd::Unit(8, 2) + 0.5 * VectorXd::Unit(8, 4);
  const Output output{OutputKind::kEdgeTorque, 5};
  const ZeroAnalysis zeros = Solve(network, input, output);
  std::vector<Complex> roots;
  ASSERT_FALSE(ProjectedRoots(network, input, output, roots).has_value());
  for (const Zero& zero : zeros.zeros) {
    double nearest = INFINITY;
    for (const Complex& s : roots) nearest = std::min(nearest, std::abs(s - zero.s) / std::abs(s));
    EXPECT_LT(nearest, zero.oscillatory ? 1e-9 : 1e-4);  // real roots are not polished; these are ill-conditioned
  }
}

TEST(RelativeDegree, NaiveChainIsFlatOfAnyLength) {
  for (const int n : {2, 4, 30, 100}) {
    const Network chain = RandomTree(static_cast<unsigned>(n), n, true);
    const Output last{OutputKind::kEdgeTorque, n - 2};
    EXPECT_EQ(*RelativeDegree(chain, VectorXd::Unit(n, 0), last), 2 * (n - 1));
    EXPECT_TRUE(*IsFlatOutput(chain, VectorXd::Unit(n, 0), last));
    EXPECT_TRUE(*IsFlatOutput(chain, VectorXd::Unit(n, 0), {OutputKind::kAngle, n - 1}));
    if (n < 4) continue;
    // Input on the second inertia: two steps less, one pair of zeros (thesis Fig. 2.22).
    EXPECT_EQ(*RelativeDegree(chain, VectorXd::Unit(n, 1), last), 2 * (n - 1) - 2);
    EXPECT_FALSE(*IsFlatOutput(chain, VectorXd::Unit(n, 1), last));
    EXPECT_EQ(CountOscillatory(Solve(WithoutDamping(chain), VectorXd::Unit(n, 1), last)), 1);
  }
}

TEST(Zeros, NotReached) {
  Network network;
  network.nodes = {{"a", 1.0}, {"b", 1.0}, {"c", 1.0}, {"d", 1.0}};
  network.edges = {{"ab", 0, 1, 10.0, 0.1}, {"cd", 2, 3, 10.0, 0.1}};
  EXPECT_FALSE(TransferZeros(network, VectorXd::Unit(4, 0), {OutputKind::kEdgeTorque, 1}).ok());
  EXPECT_FALSE(RelativeDegree(network, VectorXd::Unit(4, 0), {OutputKind::kEdgeTorque, 1}).ok());
  // Torques in proportion to inertia turn everything alike: no shaft is strained.
  EXPECT_FALSE(TransferZeros(network, VectorXd::Ones(4), {OutputKind::kEdgeTorque, 0}).ok());
}

}  // namespace
}  // namespace dynoproof::mechanics
