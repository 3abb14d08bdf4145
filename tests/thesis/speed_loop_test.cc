// The simplified speed loop and Hurwitz' criterion against numerical roots; the sampled torque loop and its sign.
#include "thesis/speed_loop.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "linear/modes.h"
#include "tests/linear/plants.h"
#include "thesis/torque_loop.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;
using Eigen::VectorXd;

SpeedLoop RandomLoop(unsigned seed) {
  std::mt19937 random(seed);
  SpeedLoop loop{{LogUniform(random, 1.0, 20.0), LogUniform(random, 0.05, 5.0), LogUniform(random, 1e5, 1e7), 0.0},
                 LogUniform(random, 1.0, 3000.0),
                 LogUniform(random, 1.0, 30000.0),
                 LogUniform(random, 0.05, 20.0),
                 LogUniform(random, 1e-4, 5e-3)};
  loop.plant.c = loop.plant.k * LogUniform(random, 1e-6, 1e-3);
  return loop;
}

TEST(SpeedLoop, PrintedClosedLoopFollowsFromTheCorrectedPlant) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const SpeedLoop loop = RandomLoop(seed);
    const ClosedLoop g = CloseLoop(loop);
    for (const Complex s : {Complex(0.0, 30.0), Complex(-3.0, 800.0), Complex(50.0, -2000.0)}) {
      const Complex polynomial = Evaluate(g.numerator, s) / Evaluate(g.denominator, s);
      // Differences of the blocks near resonances cost some digits.
      EXPECT_LT(std::abs(polynomial / ClosedLoopTransfer(loop, s) - 1.0), 1e-9) << seed;
    }
  }
}

TEST(SpeedLoop, BoundIsTheZeroOfItsCoefficient) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SpeedLoop loop = RandomLoop(seed);
    loop.k_V = FeedthroughBound(loop);  // (2.6)
    const double size = loop.k_V * loop.plant.k;
    EXPECT_NEAR(CloseLoop(loop).denominator[3] / size, 0.0, 1e-14);
    loop.k_V *= 1.001;
    EXPECT_FALSE(IsHurwitz(CloseLoop(loop).denominator));
    loop.k_V = FeedthroughBoundFromDamping(loop);
    EXPECT_NEAR(CloseLoop(loop).denominator[2] / (loop.k_V * loop.plant.c), 0.0, 1e-14);
    loop.k_V *= 1.001;
    EXPECT_FALSE(IsHurwitz(CloseLoop(loop).denominator));
  }
}

TEST(Hurwitz, AgreesWithRootsOfRandomLoops) {
  int stable = 0, unstable = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SpeedLoop loop = RandomLoop(seed);
    if (seed % 2 == 0) loop.k_V = -loop.k_V;
    const VectorXd denominator = CloseLoop(loop).denominator;
    const auto roots = PolynomialRoots(denominator);
    ASSERT_TRUE(roots.ok());
    ASSERT_EQ(roots->size(), 5);
    const double rightmost = roots->real().maxCoeff();
    // Too close to the axis for either method to be called right.
    if (std::abs(rightmost) < 1e-9 * roots->cwiseAbs().maxCoeff()) continue;
    EXPECT_EQ(IsHurwitz(denominator), rightmost < 0.0) << seed;
    const VectorXd determinants = HurwitzDeterminants(denominator);
    ASSERT_EQ(determinants.size(), 5);
    EXPECT_EQ((determinants.array() > 0.0).all(), rightmost < 0.0) << seed;
    (rightmost < 0.0 ? stable : unstable) += 1;
  }
  EXPECT_GT(stable, 30);
  EXPECT_GT(unstable, 30);
}

TEST(Hurwitz, SmallPolynomialsByHand) {
  const auto p = [](std::initializer_list<double> c) {
    return VectorXd(Eigen::Map<const VectorXd>(c.begin(), std::ssize(c)));
  };
  EXPECT_TRUE(IsHurwitz(p({1.0, 2.0})));
  EXPECT_FALSE(IsHurwitz(p({1.0, -2.0})));
  EXPECT_TRUE(IsHurwitz(p({-1.0, -2.0})));          // the sign of all does not matter
  EXPECT_TRUE(IsHurwitz(p({0.0, 0.0, 1.0, 2.0})));  // leading zeros neither
  EXPECT_FALSE(IsHurwitz(p({1.0, 0.0, 4.0})));      // roots on the axis
  EXPECT_FALSE(IsHurwitz(p({1.0, 1.0, 0.0})));      // a root at 0
  EXPECT_TRUE(IsHurwitz(p({1.0, 1.0, 1.0, 0.999})));
  EXPECT_FALSE(IsHurwitz(p({1.0, 1.0, 1.0, 1.0})));  // +-j
  EXPECT_FALSE(IsHurwitz(p({1.0, 1.0, 1.0, 1.001})));
  EXPECT_FALSE(IsHurwitz(p({0.0, 0.0})));
  EXPECT_FALSE(IsHurwitz(p({1.0, NAN, 1.0})));
  EXPECT_TRUE(IsHurwitz(p({3.0})));
  EXPECT_FALSE(PolynomialRoots(p({3.0})).ok());
  // (s + 1)(s + 1000)(s + 1e6): roots far apart keep their digits through balancing.
  const auto roots = PolynomialRoots(p({1.0, 1001001.0, 1001001000.0, 1e9}));
  ASSERT_TRUE(roots.ok());
  const VectorXd parts = roots->real();
  std::vector<double> real(parts.begin(), parts.end());
  std::sort(real.begin(), real.end());
  EXPECT_NEAR(real[0] / -1e6, 1.0, 1e-12);
  EXPECT_NEAR(real[1] / -1e3, 1.0, 1e-10);
  EXPECT_NEAR(real[2] / -1.0, 1.0, 1e-8);
}

std::vector<LoopMode> Growing(double feedthrough, int delay) {
  const SoftPlant plant = RoadToRig();
  const auto modes = TorqueLoopModes(plant.network, plant.airgap, plant.k4, {feedthrough, 1e-3, 1e-4, delay});
  EXPECT_TRUE(modes.ok());
  std::vector<LoopMode> growing;
  for (const LoopMode& mode : *modes) {
    if (mode.growth_per_s >= 0.0) growing.push_back(mode);
  }
  return growing;
}

TEST(TorqueLoop, SignOfChapterFiveIsUnstableAtTheFirstTwoResonances) {
  // Figures computed independently from the table, given to 0.1 Hz and 0.1 1/s.
  std::vector<LoopMode> modes = Growing(-9.7, 0);
  ASSERT_EQ(modes.size(), 2u);
  EXPECT_NEAR(modes[0].frequency_hz, 831.7, 0.051);
  EXPECT_NEAR(modes[0].growth_per_s, 14.9, 0.051);
  EXPECT_NEAR(modes[1].frequency_hz, 605.8, 0.051);
  EXPECT_NEAR(modes[1].growth_per_s, 8.2, 0.051);
  modes = Growing(-9.7, 1);
  ASSERT_EQ(modes.size(), 2u);
  EXPECT_NEAR(modes[0].frequency_hz, 603.9, 0.051);
  EXPECT_NEAR(modes[1].frequency_hz, 826.6, 0.051);
}

TEST(TorqueLoop, SignOfChapterTwoIsStable) {
  for (const int delay : {0, 1, 2}) {
    for (const double k_V : {1.0, 4.5, 9.7}) EXPECT_TRUE(Growing(k_V, delay).empty()) << k_V << " " << delay;
  }
}

TEST(TorqueLoop, WithoutFeedthroughThePlantAndTheActuatorRemain) {
  const SoftPlant plant = RoadToRig();
  const auto modes = TorqueLoopModes(plant.network, plant.airgap, plant.k4, {0.0, 1e-3, 1e-4, 0});
  ASSERT_TRUE(modes.ok());
  const Result<ModalAnalysis> modal = Modes(plant.network);
  double nearest_lag = INFINITY;
  for (const LoopMode& mode : *modes) {
    if (mode.frequency_hz == 0.0) nearest_lag = std::min(nearest_lag, std::abs(mode.growth_per_s + 1000.0));
  }
  EXPECT_LT(nearest_lag, 1e-6);  // round-off of the eigenvalue 0.9 over the period: 1e-15 / 1e-4 s and its condition
  for (std::size_t m = 1; m <= 5; ++m) {
    const Complex s = modal->modes[m].damped.first;
    double nearest = INFINITY;
    for (const LoopMode& mode : *modes) {
      nearest = std::min(nearest, std::abs(std::log(mode.z) * 1e4 - s) / std::abs(s));
    }
    EXPECT_LT(nearest, 1e-9);
  }
}

TEST(TorqueLoop, RefusesWhatHasNoMeaning) {
  const SoftPlant plant = RoadToRig();
  EXPECT_FALSE(TorqueLoopModes(plant.network, plant.airgap, 999, {1.0, 1e-3, 1e-4, 0}).ok());
  EXPECT_FALSE(TorqueLoopModes(plant.network, plant.airgap, plant.k4, {1.0, 0.0, 1e-4, 0}).ok());
  EXPECT_FALSE(TorqueLoopModes(plant.network, plant.airgap, plant.k4, {NAN, 1e-3, 1e-4, 0}).ok());
  EXPECT_FALSE(TorqueLoopModes(plant.network, plant.airgap, plant.k4, {1.0, 1e-3, 1e-4, -1}).ok());
}

}  // namespace
}  // namespace dynoproof::mechanics
