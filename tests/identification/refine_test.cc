// A fit on its way: sharp modes make the valleys of chi2 narrow and curved.
#include <gtest/gtest.h>

#include <cmath>

#include "identification/estimator.h"
#include "identification/random_restart.h"
#include "tests/identification/lumped_line.h"
#include "tests/identification/made_record.h"

namespace dynoproof::identification {
namespace {

constexpr std::size_t kRows = 14001;
constexpr double kNoise = 0.003;  // of each signal

class SlowPolish : public LumpedLine {
 protected:
  SlowPolish() {
    time_ = Shared(Times(kRows));
    record_.inputs["T_airgap"] = {time_, Shared(RandomTorque(kRows))};
    record_.end_s = time_->back();
  }

  EffectInstance Softer(double delta) const {
    return {registry_.FindEffect("stiffness_change"), *ParsePlace("shaft:k3"), {delta}};
  }

  /// The record of a machine whose shaft k3 is softer than it should be, with noise.
  EstimationProblem Measured(double delta) { return Measured(Softer(delta), 4); }
  /// That of a machine with an effect, simulated with so many substeps.
  EstimationProblem Measured(const EffectInstance& effect, int substeps) {
    MappedRecord silent = record_;
    for (const char* output : {"T_shaft", "omega_1"})
      silent.outputs[output] = {time_, Shared(std::vector<double>(kRows, 1.0))};
    const EstimationProblem problem(*plan_, {silent}, registry_);
    Hypothesis truth = problem.Nominal();
    truth.effects = {effect};
    Plan plan = problem.PlanOf(truth);
    SetSubsteps(plan, substeps);
    const Result<Eigen::VectorXd> clean = problem.PredictPlan(plan);
    EXPECT_TRUE(clean.ok());
    std::uint64_t stream = 2;
    for (const Channel& channel : problem.channels()) {
      const Eigen::VectorXd rows = clean->segment(channel.begin, channel.count);
      record_.outputs[channel.name] = {time_, Noisy({rows.begin(), rows.end()}, kNoise, stream++)};
    }
    return EstimationProblem(*plan_, {record_}, registry_);
  }

  std::shared_ptr<const std::vector<double>> time_;
  MappedRecord record_;
};

// Nominal values that were driven off beside a wrong size explain the record as well, up to what the prior says of
// them. From there the way to the truth leads along frequencies that must not change by a millionth.
TEST_F(SlowPolish, FindsBackAlongACurvedValley) {
  const EstimationProblem problem = Measured(-0.2);
  Hypothesis wrong = problem.Nominal();
  wrong.effects = {Softer(-0.12)};
  Estimate fit = EstimateAt(problem, wrong);
  for (int k = 0; k < 6; ++k)
    fit = Estimator(problem, WhitenerOf(problem, fit, 0)).Refine(std::move(fit), 4, Moves::kDoubts);
  ASSERT_TRUE(fit.ok()) << fit.broken;
  const double strained = LargestDeviation(problem, fit);
  ASSERT_GT(strained, 2.0) << "no valley to be caught in";
  // Straight steps, damped by the data's own units, leave 2.4 spreads of strain after as many rounds.
  fit = Estimator(problem, WhitenerOf(problem, fit, 0)).Refine(std::move(fit), 8);
  ASSERT_TRUE(fit.ok()) << fit.broken;
  EXPECT_NEAR(fit.hypothesis.effects[0].parameters[0], -0.2, 0.004);
  EXPECT_LT(LargestDeviation(problem, fit), 1.8);
}

// With friction that sticks and slips lies minimum beside minimum, and the way down ends in the nearest one.
TEST_F(SlowPolish, FrictionIsShakenDownToTheTruth) {
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
TEST_F(SlowPolish, StaysInsideItsBounds) {
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
TEST_F(SlowPolish, ADelayWithinASampleHasASlope) {
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
