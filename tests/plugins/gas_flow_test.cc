// Flow functions and flaps: values by hand, limits, both directions, inverses.
#include "plugins/physics/gas_flow.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dynoproof::mechanics {
namespace {

TEST(FlowFunction, HasTheValuesOfItsFormula) {
  EXPECT_EQ(FlowFunction(1.0), 0.0);
  EXPECT_NEAR(FlowFunction(1.25), std::sqrt(2.0 * 0.8 * 0.2), 1e-15);
  EXPECT_NEAR(FlowFunction(2.0), std::sqrt(0.5), 1e-15);
  EXPECT_EQ(FlowFunction(2.0), FlowFunction(50.0));
  // Choked air, textbook: sqrt(1.4) (2/2.4)^3.
  EXPECT_NEAR(IsentropicFlowFunction(5.0, 1.4), std::sqrt(1.4) * std::pow(2.0 / 2.4, 3.0), 1e-14);
  // Subcritical by the printed form of any textbook.
  const double x = 1.0 / 1.3;
  EXPECT_NEAR(IsentropicFlowFunction(1.3, 1.4), std::sqrt(7.0 * (std::pow(x, 2.0 / 1.4) - std::pow(x, 2.4 / 1.4))),
              1e-14);
}

TEST(FlowFunction, ReachesTheChokeWithLevelSlope) {
  const double h = 1e-4, critical = std::pow(1.2, 3.5);
  // Second order at the choke: the rest is curvature times h^2.
  EXPECT_LT(std::abs(FlowFunction(2.0) - FlowFunction(2.0 - h)), 1e-8);
  EXPECT_LT(std::abs(IsentropicFlowFunction(critical, 1.4) - IsentropicFlowFunction(critical - h, 1.4)), 1e-8);
}

TEST(FlowFunction, ApproximationIsThreePerCentHigh) {
  // sqrt(1/2) / 0.684731 = 1.03268: where both are choked, and nowhere more.
  EXPECT_NEAR(FlowFunctionDeviation(1.4), std::sqrt(0.5) / (std::sqrt(1.4) * std::pow(2.0 / 2.4, 3.0)) - 1.0, 1e-12);
  EXPECT_NEAR(FlowFunctionDeviation(1.4), 0.0327, 1e-4);
}

TEST(OrificeFlow, IsMirroredAndDefinedEverywhere) {
  for (const bool exact : {false, true}) {
    Gas gas;
    gas.isentropic = exact;
    const double forward = OrificeFlow(gas, 1e-3, 3e5, 2.5e5);
    EXPECT_GT(forward, 0.0);
    EXPECT_EQ(OrificeFlow(gas, 1e-3, 2.5e5, 3e5), -forward);
    EXPECT_EQ(OrificeFlow(gas, 1e-3, 3e5, 3e5), 0.0);
    EXPECT_EQ(OrificeFlow(gas, 0.0, 3e5, 1e5), 0.0);
    EXPECT_EQ(OrificeFlow(gas, 1e-3, 0.0, 0.0), 0.0);
    EXPECT_EQ(OrificeFlow(gas, 1e-3, -5.0, -7.0), 0.0);
    EXPECT_EQ(OrificeFlow(gas, 1e-3, 3e5, 0.0), OrificeFlow(gas, 1e-3, 3e5, 1e5));  // a vacuum: choked
    EXPECT_EQ(OrificeFlow(gas, 1e-3, 3e5, -1.0), OrificeFlow(gas, 1e-3, 3e5, 1e5));
    EXPECT_TRUE(std::isnan(OrificeFlow(gas, 1e-3, std::nan(""), 1e5)));
    EXPECT_TRUE(std::isnan(OrificeFlow(gas, 1e-3, 1e5, std::nan(""))));
  }
}

TEST(OrificeFlow, IsTheFlowFunction) {
  const Gas gas;
  for (const double to : {0.9e5, 1.4e5, 1.6e5, 2.0e5, 2.7e5, 2.9999e5}) {
    const double printed = 2e-3 * 3e5 / std::sqrt(gas.R * gas.theta) * FlowFunction(3e5 / to);
    EXPECT_NEAR(OrificeFlow(gas, 2e-3, 3e5, to) / printed, 1.0, 1e-11) << to;  // 1 - to/3e5 keeps 11 digits
  }
}

TEST(FlapArea, CosineAndTableAreInvertedOverTheirRange) {
  const FlapArea flaps[] = {FlapArea::Cosine(1e-5, 9e-3), FlapArea::Cosine(0.0, 1e-3).Times(1.3),
                            FlapArea::Table({5.0, 20.0, 90.0}, {0.0, 1e-4, 8e-3}).Times(0.5)};
  for (const FlapArea& flap : flaps) {
    double before = -1.0;
    for (double u = 5.0; u <= 90.0; u += 0.5) {
      const double area = flap.Area(u);
      EXPECT_GT(area, before);
      EXPECT_NEAR(flap.Position(area), u, 1e-9);  // asin near 5 %: 1e-16 of an area of 1e-3 of the largest
      before = area;
    }
  }
  EXPECT_NEAR(flaps[0].Area(25.0), 1e-5 + 9e-3 * (1.0 - std::cos(std::acos(-1.0) / 8.0)), 1e-18);
  EXPECT_NEAR(flaps[0].Area(100.0), 9.01e-3, 1e-17);
}

TEST(FlapArea, OutsideCountsAsTheNearestEnd) {
  const FlapArea cosine = FlapArea::Cosine(1e-5, 9e-3), table = FlapArea::Table({5.0, 90.0}, {1e-5, 8e-3});
  EXPECT_EQ(cosine.Area(-7.0), cosine.Area(0.0));
  EXPECT_EQ(cosine.Area(130.0), cosine.Area(100.0));
  EXPECT_EQ(cosine.Position(0.0), 0.0);
  EXPECT_NEAR(cosine.Position(1.0), 100.0, 1e-12);
  EXPECT_EQ(table.Area(-7.0), 1e-5);
  EXPECT_EQ(table.Area(99.0), 8e-3);
  EXPECT_EQ(table.Position(0.0), 5.0);
  EXPECT_EQ(table.Position(1.0), 90.0);
}

}  // namespace
}  // namespace dynoproof::mechanics
