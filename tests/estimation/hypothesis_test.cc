#include "estimation/hypothesis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <tuple>

#include "estimation/estimator.h"
#include "estimation/predictor.h"
#include "experiment/drive_by_record.h"
#include "scenario/load.h"
#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::estimation {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::Not;

TEST(Hypothesis, OfNothingIsThePlan) {
  const Hypothesis nothing(FourMasses(0.1));
  EXPECT_EQ(nothing.Name(), "nominal");
  EXPECT_TRUE(nothing.parameters().empty());
  EXPECT_EQ(ToToml(nothing.At(Eigen::VectorXd()).root), ToToml(FourMasses(0.1).root));
}

TEST(Hypothesis, AnEffectTakesThePlaceOfTheNumberThatItScales) {
  const Registry& registry = testing::BuiltIns();
  const Hypothesis free = Hypothesis(FourMasses(0.1)).WithNominalValuesFree(registry);
  const auto named = [](const char* name) { return Contains(Field(&Parameter::name, name)); };
  EXPECT_THAT(free.parameters(), named("plant.shaft.k2.stiffness_Nm_per_rad"));
  const Hypothesis softer = free.With(*registry.FindEffect("stiffness_change"), *ParsePlace("shaft:k2"), Magnitudes());
  EXPECT_EQ(softer.Name(), "stiffness_change@shaft:k2");
  EXPECT_EQ(softer.of_effects(), 1u);
  EXPECT_THAT(softer.parameters(), Not(named("plant.shaft.k2.stiffness_Nm_per_rad")));
  EXPECT_EQ(softer.parameters().size(), free.parameters().size());
  // Effects' numbers come first; at q the plan has them both.
  Eigen::VectorXd q = softer.start();
  q[0] = softer.parameters()[0].CoordinateOf(-0.1);
  const auto inertia = std::ranges::find(softer.parameters(), "plant.inertia.I1", &Parameter::name);
  ASSERT_NE(inertia, softer.parameters().end());
  q[inertia - softer.parameters().begin()] = inertia->CoordinateOf(2.5);
  const Plan moved = softer.At(q);
  EXPECT_NEAR(moved.root.NumberOr("plant.shaft.k2.stiffness_Nm_per_rad", 0.0), 0.9 * 5.76e6, 1.0);
  EXPECT_NEAR(moved.root.NumberOr("plant.inertia.I1", 0.0), 2.5, 1e-12);
}

// The neutral limit is 1e7, a start some 500: as a share of the way between them a search could not even say 513 and a half.
TEST(Hypothesis, WhatDoesNothingWhereNumbersEndCountsByItsLogarithm) {
  const Registry& registry = testing::BuiltIns();
  const Hypothesis free(FourMasses(0.1));
  for (const auto& [effect, at, value] :
       {std::tuple("actuator_saturation", "input:T", 513.5), std::tuple("series_elasticity", "inertia:I2", 1.3e7)}) {
    const Hypothesis with = free.With(*registry.FindEffect(effect), *ParsePlace(at), Magnitudes());
    const Parameter& number = with.parameters()[0];
    const double q = number.CoordinateOf(value);
    EXPECT_NEAR(number.ValueAt(q + number.step) / value - 1.0, number.step, 1e-2 * number.step) << effect;
    EXPECT_NEAR(number.ValueAt(q) / value, 1.0, 1e-12) << effect;
    ASSERT_TRUE(number.neutral) << effect;
    EXPECT_GT(number.CoordinateOf(*number.neutral) - q, 1.0) << effect;
    EXPECT_LE(number.CoordinateOf(*number.neutral), with.upper()[0] + 1e-12) << effect;
  }
}

TEST(Hypothesis, APhaseThatStartsAtZeroIsAsLargeAsItsCircle) {
  const Registry& registry = testing::BuiltIns();
  const Hypothesis free(FourMasses(0.1));
  const Hypothesis with = free.With(*registry.FindEffect("torque_ripple"), *ParsePlace("inertia:I2"), Magnitudes());
  ASSERT_THAT(with.parameters()[2].name, ::testing::EndsWith(" theta"));
  EXPECT_GT(with.parameters()[2].scale, 0.1) << "rad: a step of a fit is a share of it";
}

TEST(Hypothesis, ReleasedNumbersHaveADecadeAndNoPrior) {
  const Registry& registry = testing::BuiltIns();
  const Hypothesis kept = Hypothesis(FourMasses(0.1)).WithNominalValuesFree(registry);
  const Hypothesis one = kept.WithReleased("plant.inertia.I4");
  for (std::size_t i = 0; i < kept.parameters().size(); ++i) {
    const bool released = kept.parameters()[i].name == "plant.inertia.I4";
    EXPECT_EQ(one.parameters()[i].prior, !released) << kept.parameters()[i].name;
    if (!released) continue;
    EXPECT_NEAR(one.parameters()[i].lower, 0.0081, 1e-12);
    EXPECT_NEAR(one.parameters()[i].upper, 0.81, 1e-12);
  }
  // Bounds of coordinates hold the start, which is the plan as it stands.
  EXPECT_TRUE((one.lower().array() < one.start().array()).all() && (one.start().array() < one.upper().array()).all());
  EXPECT_EQ(ToToml(one.At(one.start()).root), ToToml(FourMasses(0.1).root));
}

TEST(Hypothesis, TheStartOfARecordIsAParameter) {
  Plan plan = FourMasses(0.3);
  Plan moving = plan;
  moving.root["plant"]["initial_speed_rad_per_s"] = Value(3.0);
  EXPECT_TRUE(Hypothesis(plan).WithStartFree(0, testing::BuiltIns()).parameters().empty()) << "none in the plan";
  plan.root["of_record"]["0"]["start"]["plant"]["initial_speed_rad_per_s"] = Value(2.5);
  const Hypothesis hypothesis = Hypothesis(plan).WithStartFree(0, testing::BuiltIns());
  ASSERT_EQ(hypothesis.parameters().size(), 1u);
  const DataSet data({RecordOf(moving, 0.01, {"T_shaft", "omega_1"})}, plan);
  const Result<LinearModel> model = LinearModel::Of(StartingInto(plan, 0), data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  const Predictor free(data, *model, testing::BuiltIns(), std::nullopt, nullptr);
  const Estimate fit = Fit(hypothesis, free, hypothesis.start());
  ASSERT_TRUE(fit.ok()) << fit.broken;
  const double deviation = std::sqrt(Sandwich(fit, data, hypothesis)(0, 0)) * hypothesis.parameters()[0].scale;
  EXPECT_NEAR(hypothesis.parameters()[0].ValueAt(fit.q[0]), 3.0, 4.0 * deviation);
  EXPECT_LT(deviation, 0.01);
}

}  // namespace
}  // namespace dynoproof::estimation
