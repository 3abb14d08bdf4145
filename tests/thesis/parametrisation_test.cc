// Springs and inertias from resonances: round trips through the eigenvalue problem, limits and counts of solutions.
#include "thesis/parametrisation.h"

#include <gtest/gtest.h>

#include "linear/modes.h"
#include "linear/zeros.h"
#include "tests/linear/plants.h"

namespace dynoproof::mechanics {
namespace {

Network ThreeMasses(double I1, double I2, double I3, double k1, double k2) {
  Network network;
  network.nodes = {{"I1", I1}, {"I2", I2}, {"I3", I3}};
  network.edges = {{"k1", 0, 1, k1, 0.0}, {"k2", 1, 2, k2, 0.0}};
  return network;
}

/// The two elastic frequencies [rad/s], rising.
std::pair<double, double> Resonances(const Network& network) {
  const Result<ModalAnalysis> modal = Modes(network);
  EXPECT_TRUE(modal.ok());
  return {modal->omega[1], modal->omega[2]};
}

// Round trips: closed form, then an eigenvalue problem of size 3; conditions up to about 1e3.
constexpr double kRoundTrip = 1e-11;

TEST(Parametrisation, TwoMasses) {
  Network network;
  network.nodes = {{"I1", 24.0}, {"I2", 0.4}};
  network.edges = {{"k", 0, 1, TwoMassStiffness(24.0, 0.4, 2400.0), 0.0}};
  EXPECT_NEAR(Modes(network)->omega[1] / 2400.0, 1.0, 1e-13);
}

TEST(Parametrisation, BothThreeMassTuplesReproduceTheResonances) {
  int solved = 0, refused = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937 random(seed);
    const double I1 = LogUniform(random, 0.1, 20.0), I2 = LogUniform(random, 0.1, 20.0);
    const double I3 = LogUniform(random, 0.1, 20.0);
    const double nu_1 = LogUniform(random, 500.0, 9000.0), nu_2 = LogUniform(random, 500.0, 9000.0);
    const ThreeMassSolution solution = ThreeMassStiffnesses(I1, I2, I3, nu_1, nu_2);
    EXPECT_EQ(solution.first.has_value(), solution.relative_radicand >= 0.0);
    EXPECT_EQ(solution.second.has_value(), solution.relative_radicand >= 0.0);
    if (!solution.first) {
      ++refused;
      continue;
    }
    ++solved;
    for (const ThreeMassSprings& springs : {*solution.first, *solution.second}) {
      EXPECT_GT(springs.k1, 0.0);
      EXPECT_GT(springs.k2, 0.0);
      const auto [low, high] = Resonances(ThreeMasses(I1, I2, I3, springs.k1, springs.k2));
      // Where the radicand is nearly zero the two resonances meet their limit: still well-conditioned backwards.
      EXPECT_NEAR(low / std::min(nu_1, nu_2), 1.0, kRoundTrip);
      EXPECT_NEAR(high / std::max(nu_1, nu_2), 1.0, kRoundTrip);
    }
    EXPECT_GE(solution.first->k1, solution.second->k1);
  }
  EXPECT_GT(solved, 10);
  EXPECT_GT(refused, 10);
}

TEST(Parametrisation, RadicandIsTheReachableDistanceOfResonances) {
  // Equal inertias: nu_2^2/nu_1^2 = 3 with equal springs is the closest that two springs allow.
  EXPECT_NEAR(ThreeMassStiffnesses(1.0, 1.0, 1.0, 1.0, std::sqrt(3.0)).relative_radicand, 0.0, 1e-15);
  EXPECT_LT(ThreeMassStiffnesses(1.0, 1.0, 1.0, 1.0, 1.7).relative_radicand, 0.0);
  EXPECT_GT(ThreeMassStiffnesses(1.0, 1.0, 1.0, 1.0, 1.8).relative_radicand, 0.0);
}

TEST(Parametrisation, WideMiddleLimit) {
  // The limit is approached with 1/I2: 1e-9 of the outer inertias leaves relative errors of that order.
  for (const auto& [nu_1, nu_2] : {std::pair{3000.0, 1000.0}, std::pair{1000.0, 3000.0}}) {
    const ThreeMassSolution limit = WideMiddleLimit(2.0, 5.0, nu_1, nu_2);
    const ThreeMassSolution near = ThreeMassStiffnesses(2.0, 5e9, 5.0, nu_1, nu_2);
    EXPECT_NEAR(near.first->k1 / limit.first->k1, 1.0, 1e-8);
    EXPECT_NEAR(near.first->k2 / limit.first->k2, 1.0, 1e-8);
    EXPECT_NEAR(near.second->k1 / limit.second->k1, 1.0, 1e-8);
    EXPECT_NEAR(near.second->k2 / limit.second->k2, 1.0, 1e-8);
    EXPECT_NEAR(near.relative_radicand, limit.relative_radicand, 1e-8);
  }
  // (2.67) as printed, which needs nu_1 > nu_2.
  EXPECT_EQ(WideMiddleLimit(2.0, 5.0, 3000.0, 1000.0).first->k1, 9e6 * 2.0);
  EXPECT_NE(WideMiddleLimit(2.0, 5.0, 1000.0, 3000.0).first->k1, 1e6 * 2.0);
}

TEST(Parametrisation, SplitRotorFromZeroFindsTheTruthAndOnlySolutions) {
  int two = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937 random(seed);
    const double I1 = LogUniform(random, 1.0, 20.0), I2 = LogUniform(random, 1.0, 20.0);
    const double I3 = LogUniform(random, 0.1, 5.0);
    const double k1 = LogUniform(random, 1e6, 5e7), k2 = LogUniform(random, 1e6, 5e7);
    const auto [nu_1, nu_2] = Resonances(ThreeMasses(I1, I2, I3, k1, k2));
    const double nu_z = CounterOscillatorZero(k1, I1);
    const std::vector<SplitRotor> found = SplitRotorFromZero(nu_1, nu_2, nu_z, I1 + I2, I3);
    ASSERT_FALSE(found.empty()) << seed;
    two += found.size() == 2;
    double nearest = INFINITY;
    for (const SplitRotor& s : found) {
      nearest = std::min(nearest, std::abs(s.I2 / I2 - 1.0));
      EXPECT_NEAR((s.I1 + s.I2) / (I1 + I2), 1.0, 1e-14);
      const Network network = ThreeMasses(s.I1, s.I2, I3, s.k1, s.k2);
      const auto [low, high] = Resonances(network);
      EXPECT_NEAR(low / nu_1, 1.0, 1e-10);  // round trip twice
      EXPECT_NEAR(high / nu_2, 1.0, 1e-10);
      const auto zeros = TransferZeros(network, Eigen::VectorXd::Unit(3, 1), {OutputKind::kEdgeTorque, 1});
      ASSERT_EQ(zeros->zeros.size(), 1u);
      EXPECT_NEAR(std::abs(zeros->zeros[0].s) / nu_z, 1.0, 1e-10);
    }
    // Two roots that nearly meet are known to the square root of the round-off.
    EXPECT_LT(nearest, 1e-6) << seed;
  }
  EXPECT_GT(two, 3);
  EXPECT_TRUE(SplitRotorFromZero(1000.0, 1100.0, 3000.0, 20.0, 0.5).empty());  // no such rotor
}

TEST(Parametrisation, SplitRotorFromProportionalZeroIsUnique) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    std::mt19937 random(seed);
    const double I1 = LogUniform(random, 1.0, 20.0), I2 = LogUniform(random, 1.0, 20.0);
    const double I3 = LogUniform(random, 0.1, 5.0);
    const double k1 = LogUniform(random, 1e6, 5e7), k2 = LogUniform(random, 1e6, 5e7);
    const auto [nu_1, nu_2] = Resonances(ThreeMasses(I1, I2, I3, k1, k2));
    const auto found = SplitRotorFromProportionalZero(nu_1, nu_2, ProportionalInputZero(k1, I1, I2), I1 + I2, I3);
    ASSERT_TRUE(found.has_value()) << seed;
    EXPECT_NEAR(found->I1 / I1, 1.0, 1e-9);  // differences of frequencies: condition up to 1e4
    EXPECT_NEAR(found->I2 / I2, 1.0, 1e-9);
    EXPECT_NEAR(found->k1 / k1, 1.0, 1e-9);
    EXPECT_NEAR(found->k2 / k2, 1.0, 1e-9);
  }
  EXPECT_FALSE(SplitRotorFromProportionalZero(1000.0, 1100.0, 3000.0, 20.0, 0.5).has_value());
}

}  // namespace
}  // namespace dynoproof::mechanics
