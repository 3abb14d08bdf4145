#include "estimation/parameter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dynoproof::estimation {
namespace {

Parameter With(bool logarithmic, double reference, double scale) {
  Parameter parameter;
  parameter.logarithmic = logarithmic;
  parameter.reference = reference;
  parameter.scale = scale;
  return parameter;
}

TEST(Parameter, CoordinatesAreDeviations) {
  const Parameter inertia = With(true, 2.0, 0.01), speed = With(false, -3.0, 100.0);
  EXPECT_EQ(inertia.ValueAt(0.0), 2.0);
  EXPECT_DOUBLE_EQ(inertia.ValueAt(1.0), 2.0 * std::exp(0.01));
  EXPECT_EQ(speed.ValueAt(-0.5), -53.0);
  for (const Parameter* one : {&inertia, &speed}) {
    for (const double q : {-3.0, -1e-6, 0.0, 0.4, 3.0}) EXPECT_NEAR(one->CoordinateOf(one->ValueAt(q)), q, 1e-13);
  }
}

TEST(Parameter, ANegativeNumberKeepsItsSign) {
  const Parameter one = With(true, -2.0, 0.5);
  EXPECT_LT(one.ValueAt(2.0), one.ValueAt(-2.0));
  EXPECT_NEAR(one.CoordinateOf(-4.0), std::log(2.0) / 0.5, 1e-15);
}

}  // namespace
}  // namespace dynoproof::estimation
