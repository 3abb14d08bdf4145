// The candidates that a contest carries on beside those that remove most at its first look.
#include "diagnosis/carried_along.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "diagnosis/contest.h"
#include "diagnosis/first_look.h"
#include "diagnosis/policy.h"
#include "diagnosis/trial.h"
#include "identification/estimation_problem.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;

class CarriedAlong : public ::testing::Test {
 protected:
  explicit CarriedAlong(const char* file = "scenarios/diagnose/heavy_duty_lumped.toml")
      : plan_(Scenario(file, {"run.duration_s=0.3"})) {}

  Contestant Looked(const char* effect, const char* at, double value) const {
    const auto model = null_.hypothesis.With(*testing::BuiltIns().FindEffect(effect), *ParsePlace(at), magnitudes_);
    Eigen::VectorXd from = StartFrom(model, null_.hypothesis, null_.levels[first_].q);
    from[0] = model.parameters()[0].CoordinateOf(value);
    return FitOnce(model, from, null_, *levels_, first_, 2);
  }

  Plan plan_;
  MappedRecord record_ =
      RecordOf(WithEffect(plan_, "constant_load", "inertia:I4", {120.0}), 0.01, {"T_shaft", "omega_1"});
  std::unique_ptr<Levels> levels_ = *Levels::Of(plan_, {record_}, testing::BuiltIns(), 0.0, 1000);
  Magnitudes magnitudes_ = MagnitudesOf(EstimationProblem(plan_, {record_}, testing::BuiltIns()));
  std::size_t first_ = levels_->free_run();  // a short memory forgets a load
  Contestant null_ = NullOf(plan_, false, *levels_, testing::BuiltIns());
};

TEST_F(CarriedAlong, WhatRemovesMostIsTriedAtItsOtherPlaces) {
  const Contestant leader = Looked("constant_load", "inertia:I5", 100.0),
                   other = Looked("viscous_friction", "inertia:I1", 0.1);
  ASSERT_GE(leader.share, policy::kMost);
  ASSERT_LT(other.share, leader.share);
  std::vector<Contestant> ranked = {leader, other};
  const std::size_t kept = WithItsOtherPlaces(ranked, 1, null_, *levels_, first_, magnitudes_);
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(kept);
  EXPECT_GT(
      std::count_if(ranked.begin(), end, [](const auto& one) { return one.Name() == "constant_load@inertia:I4"; }), 0)
      << "its true place";
  for (auto one = ranked.begin() + 1; one != end; ++one) {
    EXPECT_EQ(one->effect().info().name, "constant_load") << one->Name();
    EXPECT_LE(1.0 - one->share, policy::kFarBehind * (1.0 - leader.share)) << one->Name();
  }
  EXPECT_EQ(end->Name(), other.Name()) << "stays behind those";
}

class BesideASoftRotor : public CarriedAlong {
 protected:
  BesideASoftRotor() : CarriedAlong("scenarios/diagnose/heavy_duty_soft.toml") {}
};

TEST_F(BesideASoftRotor, ARotorAndAnInertiaAreOtherPlacesOfOneEffect) {
  std::vector<Contestant> ranked = {Looked("constant_load", "rotor:I1", 100.0)};
  ASSERT_GE(ranked.front().share, policy::kMost);
  const std::size_t kept = WithItsOtherPlaces(ranked, 1, null_, *levels_, first_, magnitudes_);
  EXPECT_EQ(std::count_if(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(kept),
                          [](const auto& one) { return one.Name() == "constant_load@inertia:I4"; }),
            1);
}

TEST_F(CarriedAlong, WhatRemovesLittleIsTriedNowhereElse) {
  std::vector<Contestant> ranked = {Looked("viscous_friction", "inertia:I1", 0.1)};
  ASSERT_LT(ranked.front().share, policy::kMost);
  EXPECT_EQ(WithItsOtherPlaces(ranked, 1, null_, *levels_, first_, magnitudes_), 1U);
  EXPECT_EQ(ranked.size(), 1U);
}

}  // namespace
}  // namespace dynoproof::diagnosis
