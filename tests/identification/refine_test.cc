// A fit on its way: sharp modes make the valleys of chi2 narrow and curved.
#include <gtest/gtest.h>

#include <cmath>

#include "identification/estimator.h"
#include "identification/random_restart.h"
#include "tests/identification/driven_line.h"

namespace dynoproof::identification {
namespace {

constexpr double kNoise = 0.003;  // of each signal

class SlowRefine : public DrivenLine {
 protected:
  SlowRefine() : DrivenLine(14001) {}

  EffectInstance Softer(double delta) const {
    return {registry_.FindEffect("stiffness_change"), *ParsePlace("shaft:k3"), {delta}};
  }

  /// The record of a machine whose shaft k3 is softer than it should be, with noise.
  EstimationProblem Measured(double delta) { return Measured(Softer(delta), 4); }
  EstimationProblem Measured(const EffectInstance& effect, int substeps) { return Measure({effect}, substeps, kNoise); }
};

// Nominal values that were driven off beside a wrong size explain the record as well, up to what the prior says of
// them. From there the way to the truth leads along frequencies that must not change by a millionth.
TEST_F(SlowRefine, FindsBackAlongACurvedValley) {
  const EstimationProblem problem = Measured(-0.2);
  Hypothesis wrong = problem.Nominal();
  wrong.effects = {Softer(-0.12)};
  Estimate fit = EstimateAt(problem, wrong);
  for (int k = 0; k < 6; ++k)
    fit = Estimator(problem, WhitenerOf(problem, fit, 0)).Refine(std::move(fit), 4, {.moves = Moves::kNuisances});
  ASSERT_TRUE(fit.ok()) << fit.broken;
  const double strained = LargestDeviation(problem, fit);
  ASSERT_GT(strained, 2.0) << "no valley to be caught in";
  // Straight steps, damped by the data's own units, leave 2.4 spreads of strain after as many rounds.
  fit = Estimator(problem, WhitenerOf(problem, fit, 0)).Refine(std::move(fit), 8);
  ASSERT_TRUE(fit.ok()) << fit.broken;
  EXPECT_NEAR(fit.hypothesis.effects[0].parameters[0], -0.2, 0.004);
  EXPECT_LT(LargestDeviation(problem, fit), 1.8);
}

// Slopes of another point near by lead to the same place for fewer runs, and slopes that mislead are replaced.
TEST_F(SlowRefine, SlopesThatAreKnownLeadToTheSamePlace) {
  const EstimationProblem problem = Measured(-0.05);
  const Result<NuisanceModel> nominal = LineariseNuisances(problem, problem.Nominal(), FreedomOf(problem, {}));
  ASSERT_TRUE(nominal.ok());
  NuisanceModel wrong = *nominal;
  wrong.jacobian *= -1.0;
  Hypothesis start = problem.Nominal();
  start.effects = {Softer(-0.045)};
  const Estimate cold = EstimateAt(problem, start);
  const Estimator estimator(problem, WhitenerOf(problem, cold, 0));
  const Estimate differences = estimator.Refine(cold, 8);
  Estimate known = cold, misled = cold;
  TakeSlopes(problem, *nominal, problem, known);
  TakeSlopes(problem, wrong, problem, misled);
  known = estimator.Refine(known, 8, {.slopes = Slopes::kKnown});
  misled = estimator.Refine(misled, 8, {.slopes = Slopes::kKnown});
  for (const Estimate* fit : {&known, &misled}) {
    ASSERT_TRUE(fit->ok()) << fit->broken;
    EXPECT_NEAR(fit->chi2, differences.chi2, 0.5) << "half of what one parameter gains by chance";
  }
  EXPECT_LT(known.simulations, differences.simulations);
}

// A part holds the first rows of each channel, and needs no other slopes.
TEST_F(SlowRefine, SlopesOfTheWholeAreThoseOfItsParts) {
  const EstimationProblem problem = Measured(-0.05), part = problem.Part(0.1);
  const Result<NuisanceModel> whole = LineariseNuisances(problem, problem.Nominal(), FreedomOf(problem, {}));
  const Result<NuisanceModel> own = LineariseNuisances(part, part.Nominal(), FreedomOf(part, {}));
  ASSERT_TRUE(whole.ok() && own.ok());
  Estimate fit = EstimateAt(part, part.Nominal());
  TakeSlopes(problem, *whole, part, fit);
  ASSERT_EQ(fit.nuisances.jacobian.cols(), own->jacobian.cols());
  EXPECT_LE((fit.nuisances.jacobian - own->jacobian).norm(), 1e-9 * own->jacobian.norm());
}

// With friction that sticks and slips lies minimum beside minimum, and the way down ends in the nearest one.
TEST_F(SlowRefine, FrictionIsShakenDownToTheTruth) {
  const EffectInstance truth = {registry_.FindEffect("coulomb_friction"), *ParsePlace("inertia:I4"), {15.4}};
  const EstimationProblem problem = Measured(truth, 32);
  Hypothesis beside = problem.Nominal();
  beside.effects = {truth};
  const Estimate true_one = EstimateAt(problem, beside);
  beside.effects[0].parameters = {15.398};
  const Estimator estimator(problem, WhitenerOf(problem, true_one, 0));
  const Estimate caught = estimator.Refine(EstimateAt(problem, beside), 20);
  ASSERT_TRUE(caught.ok()) << caught.broken;
  const Estimate found = Restarted(problem, estimator, caught, 12);
  EXPECT_LT(found.chi2, caught.chi2 - 100.0);  // 413 of 27755: what no number of a richer law may be thanked for
  EXPECT_NEAR(found.hypothesis.effects[0].parameters[0], 15.4, 0.004);
}

// A parameter at its bound that wants further out stays there, and the others find their best without it.
TEST_F(SlowRefine, StaysInsideItsBounds) {
  const EstimationProblem problem = Measured(-0.2);
  Hypothesis start = problem.Nominal();
  start.effects = {{registry_.FindEffect("viscous_friction"), *ParsePlace("inertia:I3"), {0.0}}};
  Estimate fit = EstimateAt(problem, start);
  fit = Estimator(problem, WhitenerOf(problem, fit, 0)).Refine(std::move(fit), 6);
  ASSERT_TRUE(fit.ok()) << fit.broken;
  EXPECT_GE(fit.hypothesis.effects[0].parameters[0], 0.0);
  const Estimate alone =
      Estimator(problem, WhitenerOf(problem, fit, 0)).Refine(EstimateAt(problem, problem.Nominal()), 6);
  EXPECT_LE(WhitenerOf(problem, fit, 0)(problem.measured() - fit.predicted).squaredNorm(),
            1.02 * WhitenerOf(problem, fit, 0)(problem.measured() - alone.predicted).squaredNorm());
}

// The engine counts time in whole nanoseconds: differences must not fall between two of them.
TEST_F(SlowRefine, ADelayWithinASampleHasASlope) {
  const EstimationProblem problem = Measured(0.0);
  const auto delayed = [&](double delay_s) {
    Hypothesis at = problem.Nominal();
    at.effects = {{registry_.FindEffect("actuator_delay"), *ParsePlace("input:T_airgap"), {delay_s}}};
    return at;
  };
  constexpr double kDelay_s = 7e-5, kFar_s = 1e-6;
  Estimate fit = EstimateAt(problem, delayed(kDelay_s));
  fit.nuisances = *LineariseNuisances(problem, fit.hypothesis, fit.nuisances.freedom);
  const Whitener whitener = WhitenerOf(problem, fit, 0);
  Estimator(problem, whitener).Derive(fit);
  const Result<Eigen::VectorXd> before = problem.Predict(delayed(kDelay_s - kFar_s)),
                                after = problem.Predict(delayed(kDelay_s + kFar_s));
  ASSERT_TRUE(before.ok() && after.ok());
  const Eigen::VectorXd slope = whitener(*after - *before) / (2.0 * kFar_s);
  EXPECT_LT((fit.jacobian.col(0) - slope).norm(), 0.03 * slope.norm());  // rounding: 2 %
}

}  // namespace
}  // namespace dynoproof::identification
