// How far a parameter may lie off: what a covariance knows, and what it does not.
#include "diagnosis/reach.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/diagnosis/line_record.h"
#include "tests/diagnosis/lumped_line.h"

namespace dynoproof::diagnosis {
namespace {

constexpr std::size_t kRows = 7001;
constexpr double kNoise = 0.003;  // of each signal

class SlowReach : public LumpedLine {
 protected:
  /// 0.7 s of a line that no engine code simulated, with noise; driven forward by so much on the whole.
  Study Measured(const blind::IndependentLine& line, double forward_Nm = 0.0) const {
    std::vector<double> torque = blind::IndependentTorque(kRows, 7, 300.0, 0.0);
    for (double& value : torque) value += forward_Nm;
    return Study(*plan_, {LineRecord(line, std::move(torque), kNoise)}, registry_);
  }

  /// At its place, with its covariance.
  Fit FitOf(const Study& study, const char* effect, const char* place, std::vector<double> parameters) const {
    Hypothesis at = study.Nominal();
    at.effects = {{registry_.FindEffect(effect), *ParsePlace(place), std::move(parameters)}};
    Fit fit = FitAt(study, at);
    fit = ToItsPlace(study, Fitter(study, WhitenerOf(study, fit, 0)).Polish(std::move(fit), 8));
    Fitter(study, WhitenerOf(study, fit)).Derive(fit);
    return fit;
  }
};

// One look to either side is enough.
TEST_F(SlowReach, IsWhatTheCovarianceSaysWhereChi2IsAParabola) {
  blind::IndependentLine line;
  line.load[2] = [](double speed) { return -5.0 * speed; };
  const Study study = Measured(line);
  const Fit fit = FitOf(study, "viscous_friction", "inertia:I3", {4.0});
  ASSERT_TRUE(fit.ok()) << fit.broken;
  int simulations = 0;
  const std::vector<Reach> reach = ReachOf(study, fit, simulations);
  ASSERT_EQ(reach.size(), 1U);
  const double half = 1.96 * std::sqrt(fit.covariance(0, 0));
  EXPECT_NEAR(reach[0].below, half, 1e-3 * half);
  EXPECT_NEAR(reach[0].above, half, 1e-3 * half);
  EXPECT_EQ(simulations, 2);
}

// Where the inertia hardly goes, and slowly, dry friction passes for viscous friction. Differences do not show it: how
// often the inertia sticks changes in each of them, and in each another way.
TEST_F(SlowReach, GoesAsFarAsOneKindOfFrictionPassesForTheOther) {
  constexpr double kDry_Nm = 9.0, kViscous = 0.3;  // of the rarer direction
  blind::IndependentLine line;
  line.load[4] = FrictionByDirection(21.0, kDry_Nm, 1.2, kViscous);
  const Study study = Measured(line, 50.0);
  const Fit fit = FitOf(study, "asymmetric_friction", "inertia:I5", {21.0, kDry_Nm, 1.2, 8.0});
  ASSERT_TRUE(fit.ok()) << fit.broken;
  const double found = fit.hypothesis.effects[0].parameters[3], half = 1.96 * std::sqrt(fit.covariance(3, 3));
  ASSERT_GT(std::abs(found - kViscous), half) << "the covariance knows it by itself";
  int simulations = 0;
  const std::vector<Reach> reach = ReachOf(study, fit, simulations);
  EXPECT_LT(found - reach[3].below, kViscous);
  EXPECT_GT(found + reach[3].above, kViscous);
}

TEST_F(SlowReach, WhatIsHeldStays) {
  blind::IndependentLine line;
  line.load[2] = [](double speed) { return -5.0 * speed; };
  const Study study = Measured(line);
  Hypothesis at = study.Nominal();
  at.effects = {{registry_.FindEffect("series_elasticity"), *ParsePlace("inertia:I4"), {2e7, 50.0}}};
  const Fit before = FitAt(study, at);
  const Fit after = Fitter(study, WhitenerOf(study, before, 0)).Polish(before, 4, Moves::kAll, 0);
  ASSERT_TRUE(after.ok()) << after.broken;
  EXPECT_NEAR(after.hypothesis.effects[0].parameters[0], 2e7, 1.0);  // through its logarithm and back
  EXPECT_NE(after.hypothesis.effects[0].parameters[1], 50.0);
}

}  // namespace
}  // namespace dynoproof::diagnosis
