// The pressure loops: the lag that (6.21) makes, stability bounds crossed by sweeping, the planned reference.
#include "thesis/pressure_loops.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plugins/physics/gas_flow.h"
#include "thesis/speed_loop.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;

Complex At(const TransferPolynomials& loop, Complex s) {
  return Evaluate(loop.numerator, s) / Evaluate(loop.denominator, s);
}

/// The same loop from its blocks, w = (k_P + k_I/s)(r - y) + k_F r and C s y = w - outflow y.
Complex FromBlocks(double C, const PiGains& g, double outflow, Complex s) {
  const Complex feedback = g.k_P + g.k_I / s, plant = 1.0 / (C * s + outflow);
  return plant * (feedback + g.k_F) / (1.0 + plant * feedback);
}

TEST(VolumeLoop, IsAFirstOrderLagWithTheGainsOfThePrint) {
  for (const auto& [volume, f_n] : {std::pair(0.4, 0.5), std::pair(1.2, 1.0 / 6.0), std::pair(0.02, 7.0)}) {
    const double C = volume / (287.05 * 320.0), v_n = 2.0 * std::numbers::pi * f_n;
    const PiGains gains = FirstOrderLagGains(C, v_n);
    for (double w = 1e-3 * v_n; w < 1e4 * v_n; w *= 1.7) {
      const Complex s(0.0, w), lag = v_n / (s + v_n);
      EXPECT_LT(std::abs(At(VolumeLoop(C, gains), s) - lag) / std::abs(lag), 1e-9);  // the goal; 1e-15 is seen
      EXPECT_LT(std::abs(FromBlocks(C, gains, 0.0, s) - lag) / std::abs(lag), 1e-9);
    }
  }
}

TEST(VolumeLoop, FollowsFromItsBlocksWithAnEngineThatPumps) {
  const PiGains gains{3e-5, 4e-5, -1e-5};
  for (double w = 1e-2; w < 1e3; w *= 2.0) {
    const Complex s(0.1, w), blocks = FromBlocks(4e-6, gains, 2e-6, s);
    EXPECT_LT(std::abs(At(VolumeLoop(4e-6, gains, 2e-6), s) - blocks) / std::abs(blocks), 1e-13);
  }
}

/// (6.8) with (6.10): at the planned supply pressure the flap passes what the engine takes, at every charge pressure.
TEST(PressureSurplus, LetsTheFlapPassWhatTheEnginePumps) {
  const Gas air;
  const double area = FlapArea::Cosine(1e-5, 9e-3).Area(25.0), swept = 0.198;
  const double K = PressureSurplus(swept, area, air.R * air.theta);
  EXPECT_LT(K, 1.0);
  for (const double p_ch : {1.5e5, 3.5e5, 4.2e5}) {
    const double pumped = swept * p_ch / (air.R * air.theta);
    EXPECT_NEAR(OrificeFlow(air, area, (1.0 + K) * p_ch, p_ch) / pumped, 1.0, 1e-12);
  }
}

Regulator Sample() {
  return {0.5, 2e4, 400.0, 0.02, 10e5 / std::sqrt(2.0 * 518.0 * 300.0) * 0.02, 518.0 * 300.0 / 0.02};
}

TEST(Regulator, HasTheIndependentlyComputedFigures) {
  EXPECT_NEAR(LeastStiffness(Sample()), 6969.0, 0.5);
  const auto roots = PolynomialRoots(RegulatorPolynomial(Sample()));
  ASSERT_TRUE(roots.ok());
  EXPECT_NEAR(roots->real().minCoeff(), -766.8, 0.05);
  EXPECT_NEAR(roots->real().maxCoeff(), -16.6, 0.05);
  EXPECT_NEAR(roots->imag().maxCoeff(), 119.4, 0.05);
}

TEST(Regulator, LoopFollowsFromItsBlocks) {
  const Regulator r = Sample();
  const PiGains gains{0.7, 11.0, 1.0};
  for (double w = 0.1; w < 1e4; w *= 2.0) {
    const Complex s(0.0, w), plant = RegulatorPolynomial(r)[3] / Evaluate(RegulatorPolynomial(r), s);
    const Complex feedback = gains.k_P + gains.k_I / s;
    const Complex blocks = plant * (feedback + gains.k_F) / (1.0 + plant * feedback);
    EXPECT_LT(std::abs(At(RegulatorLoop(r, gains), s) - blocks) / std::abs(blocks), 1e-11) << w;
  }
}

/// Where does the largest real part change its sign? By bisection of the eigenvalues; `unstable` lies on one side.
template <class Part>
double Crossing(double stable, double unstable, const Part& part) {
  EXPECT_LT(part(stable), 0.0);
  EXPECT_GT(part(unstable), 0.0);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (stable + unstable);
    (part(middle) < 0.0 ? stable : unstable) = middle;
  }
  return 0.5 * (stable + unstable);
}

// Eigenvalues of a companion matrix are good to about 1e-12 of its norm, 1e-9 of the slow real part: the crossing too.
constexpr double kCrossing = 1e-8;

TEST(Regulator, CrossesTheAxisExactlyAtTheLeastStiffness) {
  for (const double c_s : {100.0, 400.0, 900.0}) {
    Regulator r = Sample();
    r.c_s = c_s;
    const double bound = LeastStiffness(r), found = Crossing(3.0 * bound, 0.3 * bound, [&r](double k_s) {
                                              r.k_s = k_s;
                                              return LargestRealPart(RegulatorPolynomial(r));
                                            });
    EXPECT_NEAR(found / bound, 1.0, kCrossing);
  }
}

TEST(Regulator, LoopCrossesTheAxisExactlyAtTheLargestGains) {
  const Regulator r = Sample();
  const double largest_P = LargestProportionalGain(r);
  EXPECT_NEAR(Crossing(0.2 * largest_P, 3.0 * largest_P,
                       [&r](double k_P) {
                         return LargestRealPart(RegulatorLoop(r, {k_P, 1e-9, 1.0}).denominator);
                       }) /
                  largest_P,
              1.0, 1e-6);  // k_I = 1e-9 shifts it by about that over the room left
  for (const double k_P : {0.0, 0.4, 1.2}) {
    const double largest_I = LargestIntegralGain(r, k_P);
    EXPECT_NEAR(Crossing(0.1 * largest_I, 5.0 * largest_I,
                         [&](double k_I) {
                           return LargestRealPart(RegulatorLoop(r, {k_P, k_I, 1.0}).denominator);
                         }) /
                    largest_I,
                1.0, kCrossing);
  }
  // With the gains of the practice, (6.39), and in the stiffness.
  const double k_I = 0.9 * LargestIntegralGain(r, 0.0);
  EXPECT_LT(LargestRealPart(RegulatorLoop(r, {0.0, k_I, 1.0}).denominator), 0.0);
  const double k_s = Crossing(r.k_s, 0.5 * r.k_s, [&](double stiffness) {
    Regulator softer = r;
    softer.k_s = stiffness;
    return LargestRealPart(RegulatorLoop(softer, {0.0, k_I, 1.0}).denominator);
  });
  EXPECT_NEAR(k_s, LeastStiffness(r) + k_I * r.c_s, 1e-4);
}

TEST(LargestRealPart, OfNothingIsNoNumber) {
  EXPECT_TRUE(std::isnan(LargestRealPart(Eigen::VectorXd::Zero(3))));
  EXPECT_TRUE(std::isnan(LargestRealPart(Eigen::VectorXd::Constant(2, std::nan("")))));
}

}  // namespace
}  // namespace dynoproof::mechanics
