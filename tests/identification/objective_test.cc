// The two misfits that need a run.
#include "identification/objective.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

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

/// The same line driven a third as hard: an error of one size is missed alike in both records.
TEST_F(Misfits, ANewtonMetreWeighsAlikeInAllRecords) {
  std::vector<double> small = RandomTorque(10001);
  for (double& torque : small) torque /= 3.0;
  const EstimationProblem both(*plan_, {LineRecord({}, RandomTorque(10001), 0.0), LineRecord({}, small, 0.0)},
                               registry_);
  ASSERT_EQ(both.channels()[0].name, both.channels()[both.channels().size() / 2].name);
  Plan off = *plan_;
  Value* key = off.root.FindPath("plant.shaft.k4.stiffness_Nm_per_rad");
  *key = Value(1.1 * key->number());
  const Result<Eigen::VectorXd> missed = FreeRunObjective(both)->Of(off), predicted = both.PredictPlan(off);
  ASSERT_TRUE(missed.ok() && predicted.ok());
  const Eigen::VectorXd error = both.measured() - *predicted;
  std::map<std::string, double> weight;
  for (const ComparedOutput& c : both.channels()) {
    const double own = missed->segment(c.begin, c.count).norm() / error.segment(c.begin, c.count).norm();
    const auto known = weight.emplace(c.name, own).first;
    EXPECT_NEAR(own, known->second, 1e-9 * own) << c.name;
  }
  EXPECT_EQ(weight.size() * 2, both.channels().size());
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
