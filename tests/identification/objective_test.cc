// The two misfits that need a run.
#include "identification/objective.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

namespace dynoproof::identification {
namespace {

class Misfits : public LumpedLine {
 protected:
  Misfits() : problem_(*plan_, {LineRecord({}, RandomTorque(10001), kNoise)}, registry_) {}

  /// Mean square of what is missed with the stiffness of the measuring flange `factor` times what it is.
  double Missed(const Objective& objective, double factor) const {
    Plan plan = *plan_;
    Value* key = plan.root.FindPath("plant.shaft.k4.stiffness_Nm_per_rad");
    *key = Value(factor * key->number());
    const Result<Eigen::VectorXd> error = objective.Of(plan);
    EXPECT_TRUE(error.ok());
    EXPECT_EQ(error->size(), objective.size());
    return error->squaredNorm() / static_cast<double>(error->size());
  }

  static constexpr double kNoise = 0.01;
  EstimationProblem problem_;
};

TEST_F(Misfits, AtTheTruthTheFreeRunMissesTheNoiseAndTheSpectrumItsScatter) {
  EXPECT_NEAR(std::sqrt(Missed(*FreeRunObjective(problem_), 1.0)), kNoise, 0.05 * kNoise);
  // Where there is noise alone a band's power scatters as that of 29 independent lines, half of that in amplitude.
  EXPECT_LT(std::sqrt(Missed(*SpectrumObjective(problem_), 1.0)), 1.1 * 0.5 / std::sqrt(29.0));
}

TEST_F(Misfits, ASpectrumGetsWorseTheFartherOffOneIs) {
  const std::unique_ptr<Objective> spectrum = SpectrumObjective(problem_);
  double nearer = Missed(*spectrum, 1.0);
  for (const double factor : {0.98, 0.95, 0.9, 0.8, 0.6}) {
    const double here = Missed(*spectrum, factor);
    EXPECT_GT(here, 1.05 * nearer) << factor;
    nearer = here;
  }
}

}  // namespace
}  // namespace dynoproof::identification
