// Several numbers of a line are wrong at once: which they are, and that one which lacks a law is not taken for such a line.
#include "diagnosis/changed_numbers.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "diagnosis/contest.h"
#include "diagnosis/trial.h"
#include "identification/estimation_problem.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;

const char* const kScenario = "scenarios/diagnose/heavy_duty_lumped.toml";

class ChangedNumbers : public ::testing::Test {
 protected:
  /// Fits the line to a record of `truth`, under its priors and with its numbers let go.
  void LookAt(const Plan& truth, double noise = 0.005) {
    record_ = RecordOf(truth, noise, {"T_shaft", "omega_1"});
    Result<std::unique_ptr<Levels>> levels = Levels::Of(plan_, {record_}, testing::BuiltIns(), 0.0, 10'000);
    ASSERT_TRUE(levels.ok()) << levels.failure().ToString();
    levels_ = *std::move(levels);
    contest_.contestants.push_back(NullOf(plan_, false, *levels_, testing::BuiltIns()));
    released_.emplace(NullOf(plan_, true, *levels_, testing::BuiltIns()));
  }

  Contest ByChanges(const Contestant& exact) const {
    const EstimationProblem problem(plan_, {record_}, testing::BuiltIns());
    return CompeteByChanges(contest_, exact, *levels_, MagnitudesOf(problem), testing::BuiltIns(), 3);
  }

  Plan plan_ = Scenario(kScenario, {"run.duration_s=0.5"});
  MappedRecord record_;
  std::unique_ptr<Levels> levels_;
  Contest contest_;
  std::optional<Contestant> released_;
};

TEST_F(ChangedNumbers, AreFoundTogether) {
  Plan truth = plan_;
  std::map<std::string, double> relative;
  for (const auto& [path, by] : {std::pair("plant.shaft.k2.stiffness_Nm_per_rad", -0.12),
                                 std::pair("plant.shaft.k3.stiffness_Nm_per_rad", 0.1)}) {
    Value* value = truth.root.FindPath(path);
    ASSERT_NE(value, nullptr) << path;
    *value = Value(value->number() * (1.0 + by));
    relative[path] = by;
  }
  LookAt(truth);
  const std::optional<Contestant> exact = ByNumbersAlone(contest_.null(), *released_, *levels_);
  ASSERT_TRUE(exact);
  std::set<std::string> far;
  for (const auto& [path, off] : FarFromPriors(*exact, contest_.null(), *levels_)) far.insert(path);
  for (const auto& [path, by] : relative) EXPECT_TRUE(far.contains(path)) << path;
  const Contest found = ByChanges(*exact);
  ASSERT_EQ(found.contestants.size(), 2U) << "the nominal model, and the two changes";
  const Contestant& both = found.contestants[1];
  ASSERT_EQ(both.hypothesis.effects().size(), 2U) << both.Name();
  const estimation::Estimate& fit = both.levels[levels_->free_run()];
  const Eigen::VectorXd errors = estimation::Sandwich(fit, levels_->data(), both.hypothesis).diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto& [effect, place] = both.hypothesis.effects()[static_cast<std::size_t>(i)];
    const estimation::Parameter& delta = both.hypothesis.parameters()[static_cast<std::size_t>(i)];
    ASSERT_TRUE(relative.contains(effect->ScaledParameter(place))) << both.Name();
    const double hidden = relative[effect->ScaledParameter(place)];
    EXPECT_NEAR(delta.ValueAt(fit.q[i]), hidden, 4.0 * delta.scale * errors[i]) << both.Name();
    EXPECT_LT(delta.scale * errors[i], 0.2 * std::abs(hidden)) << "then the record says something of it";
  }
}

TEST_F(ChangedNumbers, DoNotStandForFrictionThatIsMissing) {
  LookAt(WithEffect(plan_, "coulomb_friction", "inertia:I5", {30.0}));
  ASSERT_FALSE(contest_.null().Holds(levels_->free_run()) && IsExact(contest_.null().levels[levels_->free_run()]))
      << "friction shows in this record";
  EXPECT_FALSE(ByNumbersAlone(contest_.null(), *released_, *levels_));
}

}  // namespace
}  // namespace dynoproof::diagnosis
