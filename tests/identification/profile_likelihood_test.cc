// How far a parameter may lie off: what a covariance knows, and what it does not.
#include "identification/profile_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

namespace dynoproof::identification {
namespace {

constexpr std::size_t kRows = 7001;
constexpr double kNoise = 0.003;  // of each signal

class SlowReach : public LumpedLine {
 protected:
  /// 0.7 s of a line that no engine code simulated, with noise; driven forward by so much on the whole.
  EstimationProblem Measured(const blind::IndependentLine& line, double forward_Nm = 0.0) const {
    std::vector<double> torque = blind::IndependentTorque(kRows, 7, 300.0, 0.0);
    for (double& value : torque) value += forward_Nm;
    return EstimationProblem(*plan_, {LineRecord(line, std::move(torque), kNoise)}, registry_);
  }

  /// At its place, with its covariance.
  Estimate FitOf(const EstimationProblem& problem, const char* effect, const char* place,
                 std::vector<double> parameters) const {
    Hypothesis at = problem.Nominal();
    at.effects = {{registry_.FindEffect(effect), *ParsePlace(place), std::move(parameters)}};
    Estimate fit = EstimateAt(problem, at);
    fit = Converged(problem, Estimator(problem, WhitenerOf(problem, fit, 0)).Refine(std::move(fit), 8));
    Estimator(problem, WhitenerOf(problem, fit)).Derive(fit);
    return fit;
  }
};

// One look to either side is enough.
TEST_F(SlowReach, IsWhatTheCovarianceSaysWhereChi2IsAParabola) {
  blind::IndependentLine line;
  line.load[2] = [](double speed) { return -5.0 * speed; };
  const EstimationProblem problem = Measured(line);
  const Estimate fit = FitOf(problem, "viscous_friction", "inertia:I3", {4.0});
  ASSERT_TRUE(fit.ok()) << fit.broken;
  const double before_s = problem.context().allowance->simulations();
  const std::vector<Reach> reach = ProfileIntervalOf(problem, fit);
  ASSERT_EQ(reach.size(), 1U);
  const double simulated_s = problem.context().allowance->simulations() - before_s;
  const double half = 1.96 * std::sqrt(fit.covariance(0, 0));
  EXPECT_NEAR(reach[0].below, half, 1e-3 * half);
  EXPECT_NEAR(reach[0].above, half, 1e-3 * half);
  EXPECT_NEAR(simulated_s, 2.0 * problem.records().front().end_s, 1e-9);
}

// Where the inertia hardly goes, and slowly, dry friction passes for viscous friction. Differences do not show it: how
// often the inertia sticks changes in each of them, and in each another way.
TEST_F(SlowReach, GoesAsFarAsOneKindOfFrictionPassesForTheOther) {
  constexpr double kDry_Nm = 9.0, kViscous = 0.3;  // of the rarer direction
  blind::IndependentLine line;
  line.load[4] = FrictionByDirection(21.0, kDry_Nm, 1.2, kViscous);
  const EstimationProblem problem = Measured(line, 50.0);
  // A search comes to rest where the last bit of a sine leads it. Held far off, all else fitted, this number is where
  // some of them have ended.
  Hypothesis at = problem.Nominal();
  at.effects = {{registry_.FindEffect("asymmetric_friction"), *ParsePlace("inertia:I5"), {21.0, kDry_Nm, 1.2, 8.0}}};
  Estimate fit = EstimateAt(problem, at);
  fit = Estimator(problem, WhitenerOf(problem, fit, 0)).Refine(std::move(fit), 8, {.held = 3});
  Estimator(problem, WhitenerOf(problem, fit)).Derive(fit);
  ASSERT_TRUE(fit.ok()) << fit.broken;
  const double found = fit.hypothesis.effects[0].parameters[3], half = 1.96 * std::sqrt(fit.covariance(3, 3));
  ASSERT_GT(std::abs(found - kViscous), half) << "the covariance knows it by itself";
  const std::vector<Reach> reach = ProfileIntervalOf(problem, fit);
  EXPECT_LT(found - reach[3].below, kViscous);
  EXPECT_GT(found + reach[3].above, kViscous);
}

TEST_F(SlowReach, WhatIsHeldStays) {
  blind::IndependentLine line;
  line.load[2] = [](double speed) { return -5.0 * speed; };
  const EstimationProblem problem = Measured(line);
  Hypothesis at = problem.Nominal();
  at.effects = {{registry_.FindEffect("series_elasticity"), *ParsePlace("inertia:I4"), {2e7, 50.0}}};
  const Estimate before = EstimateAt(problem, at);
  const Estimate after = Estimator(problem, WhitenerOf(problem, before, 0)).Refine(before, 4, {.held = 0});
  ASSERT_TRUE(after.ok()) << after.broken;
  EXPECT_NEAR(after.hypothesis.effects[0].parameters[0], 2e7, 1.0);  // through its logarithm and back
  EXPECT_NE(after.hypothesis.effects[0].parameters[1], 50.0);
}

}  // namespace
}  // namespace dynoproof::identification
