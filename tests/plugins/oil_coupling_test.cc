// The coupling's numbers: printed figures, limits, the chain from geometry, fits with known answers.
#include "plugins/law/hydrodynamic_coupling/oil_coupling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace dynoproof::mechanics {
namespace {

using ::testing::HasSubstr;

constexpr OilCoupling kTable42 = {78e3, 0.07, 190.0, 2.2e6};  // Table 4.2

OilCouplingGeometry Geometry() {
  return {.segments = 12,
          .width = 0.125,
          .length = 0.08,
          .inner_radius = 0.11,
          .chamber_volume = 3e-4,
          .gap_height = 1.6e-3,
          .gap_length = 0.03,
          .bulk_modulus = 1e6,
          .density = 870.0,
          .kinematic_viscosity = 50e-6,
          .spring = 78e3};
}

TEST(OilCoupling, GivesThePrintedFiguresAtTheCouplingMode) {
  const DynamicValues at = kTable42.At(73.3);
  EXPECT_NEAR(at.stiffness, 0.0980e6, 50.0);  // half of the last digit
  EXPECT_NEAR(at.damping, 706.0, 0.5);
}

TEST(OilCoupling, LimitsAreThoseOfOpenAndClosedGaps) {
  const double K = 0.07 * 2.2e6;
  EXPECT_EQ(kTable42.At(0.0).stiffness, 78e3);
  EXPECT_DOUBLE_EQ(kTable42.At(0.0).damping, K / 190.0);
  EXPECT_NEAR(kTable42.At(1e-9).stiffness, 78e3, 1e-9);
  EXPECT_DOUBLE_EQ(kTable42.At(1e12).stiffness, 78e3 + K);  // the oil has no time to flow
  EXPECT_NEAR(kTable42.At(1e12).damping, 0.0, 1e-15);
  EXPECT_TRUE(std::isfinite(kTable42.At(1e300).damping));
  for (double nu = 1.0; nu < 1e4; nu *= 1.5) {  // between them monotonic
    EXPECT_GT(kTable42.At(1.5 * nu).stiffness, kTable42.At(nu).stiffness);
    EXPECT_LT(kTable42.At(1.5 * nu).damping, kTable42.At(nu).damping);
  }
}

TEST(OilCouplingChain, LeverArmIsThatOfTheDisplacedOil) {
  // Reciprocity: the power of the torque is the power of the oil, N Dp A (r + l/2) w = k_p Dp w.
  const OilCouplingGeometry g = Geometry();
  EXPECT_NEAR(FromGeometry(g).k_p, g.segments * g.side_area() * g.lever(), 1e-15);
}

TEST(OilCouplingChain, ValuesByHand) {
  const OilCoupling coupling = FromGeometry(Geometry());
  EXPECT_NEAR(coupling.k_p, 12 * 0.125 * (0.0032 + 0.0088), 1e-15);
  EXPECT_NEAR(coupling.kappa_w, 2.0 * 1e6 / 3e-4 * 0.01 * 0.15, 1e-6);
  const double kappa_HP = 0.125 * 4.096e-9 / (12.0 * 0.0435 * 0.03) * (1.0 - 0.63 * 0.0128);
  EXPECT_NEAR(coupling.kappa_p, 2.0 * 1e6 / 3e-4 * kappa_HP, 1e-9);
  EXPECT_EQ(coupling.k_s, 78e3);
}

TEST(OilCouplingChain, ScalesAsThePhysicsSay) {
  const OilCoupling nominal = FromGeometry(Geometry());
  OilCouplingGeometry warm = Geometry();
  warm.kinematic_viscosity *= 0.5;
  EXPECT_DOUBLE_EQ(FromGeometry(warm).kappa_p, 2.0 * nominal.kappa_p);
  EXPECT_EQ(FromGeometry(warm).kappa_w, nominal.kappa_w);
  OilCouplingGeometry airy = Geometry();
  airy.bulk_modulus *= 0.1;  // less stiff, but the damping at rest, K / kappa_p, is the gap's alone
  EXPECT_NEAR(FromGeometry(airy).At(0.0).damping, nominal.At(0.0).damping, 1e-9 * nominal.At(0.0).damping);
}

TEST(OilCouplingChain, WarnsWhereItLeavesItsGround) {
  EXPECT_THAT(CheckValidity(Geometry(), 0.01, 0.1).warnings, ::testing::IsEmpty());
  // Printed bound of (4.13): v = 10 m/s, D_H = 2 mm, 50e-6 m^2/s give 400.
  OilCouplingGeometry thin = Geometry();
  thin.gap_height = 1e-3;
  const double rate = 10.0 * thin.width * thin.gap_height / (thin.side_area() * thin.lever());
  EXPECT_NEAR(CheckValidity(thin, 0.01, rate).reynolds, 400.0, 400.0 * 0.01);
  EXPECT_THAT(CheckValidity(Geometry(), 0.03, 0.1).warnings, ::testing::ElementsAre(HasSubstr("15 % of its volume")));
  const auto fast = CheckValidity(Geometry(), 0.01, 10.0);
  EXPECT_THAT(fast.warnings, ::testing::ElementsAre(HasSubstr("Reynolds number"), HasSubstr("bulk modulus")));
}

/// A table of Table 4.2's own values at 12 frequencies, times (1 + relative noise).
CouplingTable TableOf(double noise) {
  CouplingTable table;
  for (std::uint64_t i = 0; i < 12; ++i) {
    table.nu.push_back(50.0 * static_cast<double>(i));
    const DynamicValues at = kTable42.At(table.nu.back());
    table.stiffness.push_back(at.stiffness * (1.0 + noise * RandomNormal(7, 0, i)));
    table.damping.push_back(at.damping * (1.0 + noise * RandomNormal(7, 1, i)));
  }
  return table;
}

TEST(OilCouplingFit, FindsWhatTheTableWasMadeFrom) {
  const auto fit = FitOilCoupling(TableOf(0.0));
  ASSERT_TRUE(fit.ok()) << fit.failure().ToString();
  EXPECT_NEAR(fit->k_s, 78e3, 78e3 * 1e-9);
  EXPECT_NEAR(fit->oil_stiffness, 154e3, 154e3 * 1e-9);
  EXPECT_NEAR(fit->kappa_p, 190.0, 190.0 * 1e-9);
  EXPECT_LT(fit->rms, 1e-12);
}

TEST(OilCouplingFit, IntervalsHoldTheTruthAndResidualsTheNoise) {
  const auto fit = FitOilCoupling(TableOf(0.02));
  ASSERT_TRUE(fit.ok());
  EXPECT_NEAR(fit->k_s, 78e3, fit->interval[0]);
  EXPECT_NEAR(fit->oil_stiffness, 154e3, fit->interval[1]);
  EXPECT_NEAR(fit->kappa_p, 190.0, fit->interval[2]);
  EXPECT_GT(fit->rms, 0.01);
  EXPECT_LT(fit->rms, 0.03);
  // The relative deviation of each row is the residual: model / table - 1.
  const CouplingTable table = TableOf(0.02);
  const DynamicValues model = OilCoupling{fit->k_s, 1.0, fit->kappa_p, fit->oil_stiffness}.At(table.nu[5]);
  EXPECT_NEAR(fit->stiffness_residual[5], model.stiffness / table.stiffness[5] - 1.0, 1e-12);
  EXPECT_NEAR(fit->damping_residual[5], model.damping / table.damping[5] - 1.0, 1e-12);
}

TEST(OilCouplingFit, IsAMinimum) {
  const CouplingTable table = TableOf(0.05);
  const auto fit = FitOilCoupling(table);
  ASSERT_TRUE(fit.ok());
  const auto cost = [&](double k_s, double K, double kappa) {
    double sum = 0.0;
    for (std::size_t i = 0; i < table.nu.size(); ++i) {
      const DynamicValues at = OilCoupling{k_s, 1.0, kappa, K}.At(table.nu[i]);
      sum += std::pow(at.stiffness / table.stiffness[i] - 1.0, 2) + std::pow(at.damping / table.damping[i] - 1.0, 2);
    }
    return sum;
  };
  const double least = cost(fit->k_s, fit->oil_stiffness, fit->kappa_p);
  for (const double factor : {0.999, 1.001}) {
    EXPECT_GT(cost(fit->k_s * factor, fit->oil_stiffness, fit->kappa_p), least);
    EXPECT_GT(cost(fit->k_s, fit->oil_stiffness * factor, fit->kappa_p), least);
    EXPECT_GT(cost(fit->k_s, fit->oil_stiffness, fit->kappa_p * factor), least);
  }
}

TEST(OilCouplingFit, SaysWhatIsWrongWithATable) {
  const double none = std::nan("");
  EXPECT_THAT(FitOilCoupling({{1.0, 2.0}, {1.0, 1.0}, {1.0, none}}).failure().ToString(), HasSubstr("3 values"));
  EXPECT_THAT(FaultOf({{2.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}), HasSubstr("do not rise"));
  EXPECT_THAT(FaultOf({{1.0}, {-1.0}, {1.0}}), HasSubstr("positive"));
  EXPECT_THAT(FaultOf({{1.0}, {none}, {none}}), HasSubstr("neither"));
  EXPECT_THAT(FaultOf({{}, {}, {}}), HasSubstr("at least one"));
}

TEST(CouplingTable, InterpolatesOverGaps) {
  const double none = std::nan("");
  const CouplingTable table = {{0.0, 10.0, 20.0}, {100.0, none, 300.0}, {none, 50.0, 40.0}};
  EXPECT_EQ(At(table, 5.0).stiffness, 150.0);
  EXPECT_EQ(At(table, 10.0).stiffness, 200.0);
  EXPECT_EQ(At(table, 0.0).damping, 50.0);
  EXPECT_EQ(At(table, 15.0).damping, 45.0);
  EXPECT_EQ(At(table, 99.0).stiffness, 300.0);
}

}  // namespace
}  // namespace dynoproof::mechanics
