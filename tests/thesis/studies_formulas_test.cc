// Studies of formulas and data sheets: what the ledger's parameters do not vary.
#include "thesis/studies_formulas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/registry.h"

namespace dynoproof {
namespace {

double Of(const std::string& study, const Value& parameters) {
  const Result<Figure> figure = FormulaStudies().at(study)(testing::FullRegistry(), parameters);
  EXPECT_TRUE(figure.ok()) << study;
  return figure.ok() ? figure->value : std::nan("");
}

/// The error of (5.22) is that of sin(x) = x, which falls with the square of N.
TEST(Formulas, PlainInterpolationErrsByTheSmallAngleAlone) {
  const double coarse = Of("plain_interpolation", Value{{"N", 128.0}}),
               fine = Of("plain_interpolation", Value{{"N", 512.0}});
  EXPECT_NEAR(coarse / fine, 16.0, 0.05);  // terms of the fourth order: 3e-3
  EXPECT_EQ(Of("plain_interpolation", Value{{"undefined", true}}), 1.0);
}

/// Its entries are half the coefficients of its cosines: 0.25, 0.04, and nothing beyond.
TEST(Formulas, WindowHeightIsThatOfTheBlackmanWindow) {
  EXPECT_NEAR(Of("window_height", Value{{"offset", 2.0}}), 0.04, 1e-12);
  EXPECT_NEAR(Of("window_height", Value{{"offset", 3.0}}), 0.0, 1e-12);
}

TEST(Formulas, RatedTorqueIsPowerOverAngularSpeed) {
  EXPECT_NEAR(Of("rated_torque", Value{{"power_kW", 2.0 * std::numbers::pi}, {"speed_rpm", 60.0}}), 1.0, 1e-12);
}

TEST(Formulas, OutsideBoundsCountsWhatIsOutside) {
  const auto outside = [](double least, double most) {
    return Of("outside_bounds",
              Value{{"scenario", "heavy_duty/straight_chain_setup_1"}, {"least", least}, {"most", most}});
  };
  EXPECT_EQ(outside(22.5, 25.5), 0.0);
  EXPECT_EQ(outside(26.0, 27.0), 1.0);  // I1 is 25.082 kg m^2
}

}  // namespace
}  // namespace dynoproof
