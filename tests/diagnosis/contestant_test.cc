// Which effect a fitted model names, and which effects it could do without.
#include "diagnosis/contestant.h"

#include <gtest/gtest.h>

#include <initializer_list>

#include "diagnosis/contest.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;

/// Friction at the first body and a dead zone of the drive, with such numbers.
class Pair : public ::testing::Test {
 protected:
  Pair()
      : plan_(Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.1"})),
        levels_(*Levels::Of(plan_, {RecordOf(plan_, 0.01, {"T_shaft"})}, testing::BuiltIns(), 0.0, 10'000)) {}

  Contestant With(double friction_Nm, double width_Nm) {
    const Registry& registry = testing::BuiltIns();
    Contestant one(NullHypothesis(plan_, false, *levels_, registry)
                       .With(*registry.FindEffect("coulomb_friction"), *ParsePlace("inertia:I1"), Magnitudes{})
                       .With(*registry.FindEffect("actuator_dead_zone"), *ParsePlace("input:T_airgap"), Magnitudes{}));
    one.levels.resize(1);
    estimation::Estimate& fit = one.levels[0];
    fit.q = one.hypothesis.start();
    const std::initializer_list<double> values = {friction_Nm, width_Nm};
    for (Eigen::Index i = 0; i < 2; ++i)
      fit.q[i] = one.hypothesis.parameters()[static_cast<std::size_t>(i)].CoordinateOf(values.begin()[i]);
    fit.jacobian = Eigen::MatrixXd::Identity(fit.q.size() + 1, fit.q.size());
    return one;
  }

  Contestant Nominal(bool released) const {
    Contestant one(NullHypothesis(plan_, released, *levels_, testing::BuiltIns()));
    one.levels.resize(1);
    one.levels[0].q = one.hypothesis.start();
    return one;
  }

  /// How well the two numbers are known [standard deviations from doing nothing], and whether they make up for each other.
  static void Know(Contestant& one, double friction, double width, bool alike) {
    estimation::Estimate& fit = one.levels[0];
    fit.jacobian(0, 0) = friction / fit.q[0];
    fit.jacobian(1, 1) = width / fit.q[1];
    if (!alike) return;
    fit.jacobian.col(1) = fit.jacobian.col(0) * fit.q[0] / fit.q[1];
    fit.jacobian(fit.q.size(), 1) = 1e-3;
  }

 private:
  Plan plan_;
  std::unique_ptr<Levels> levels_;
};

/// Three deviations of a prior off, and a decade where it is let go.
TEST_F(Pair, TellsWhichNominalValuesLieOnTheirBounds) {
  for (const bool released : {false, true}) {
    Contestant one = Nominal(released);
    EXPECT_TRUE(NominalValuesOnBounds(one, 0).empty());
    const estimation::Parameter& second = one.hypothesis.parameters()[1];
    EXPECT_EQ(second.prior, !released);
    const double decade = second.reference / 10.0;
    one.levels[0].q[1] = released ? second.CoordinateOf(decade) : -3.0;
    EXPECT_EQ(NominalValuesOnBounds(one, 0), std::vector<std::size_t>{1}) << second.name;
    one.levels[0].q[1] = released ? second.CoordinateOf(1.001 * decade) : -2.999;
    EXPECT_TRUE(NominalValuesOnBounds(one, 0).empty());
  }
  Contestant effect = With(3.0, 5.0);
  effect.levels[0].q[0] = effect.hypothesis.upper()[0];
  EXPECT_TRUE(NominalValuesOnBounds(effect, 0).empty()) << "a number of an effect is no nominal value";
}

std::vector<std::size_t> IdleOnesOf(const Contestant& one) {
  std::vector<std::size_t> which;
  for (const Idle& idle : IdleEffects(one, 0)) which.push_back(idle.effect);
  return which;
}

TEST_F(Pair, OfEffectsThatShowHasNoIdleOne) {
  Contestant one = With(3.0, 5.0);
  Know(one, 10.0, 10.0, false);
  EXPECT_TRUE(IdleOnesOf(one).empty());
}

TEST_F(Pair, TellsWhichEffectComesToNothing) {
  const Contestant no_friction = With(0.0, 5.0);
  EXPECT_EQ(IdleOnesOf(no_friction), std::vector<std::size_t>{0});
  Contestant hardly = With(3.0, 5.0);
  Know(hardly, 10.0, 2.0, false);
  EXPECT_EQ(IdleOnesOf(hardly), std::vector<std::size_t>{1});
}

/// Each of the two could be left out, the other would follow.
TEST_F(Pair, OfEffectsThatMakeUpForEachOtherHasTwoIdleOnes) {
  Contestant one = With(3.0, 5.0);
  Know(one, 10.0, 10.0, true);
  EXPECT_EQ(IdleOnesOf(one), (std::vector<std::size_t>{0, 1}));
  const Eigen::VectorXd q = one.levels[0].q, without = IdleEffects(one, 0)[0].q;
  EXPECT_EQ(without[0], 0.0);
  EXPECT_NEAR(without[1], 2.0 * q[1], 1e-3 * q[1]);
}

TEST_F(Pair, NamesItsLastEffectAlone) {
  EXPECT_TRUE(NamesSomething(With(0.0, 5.0), 0));
  EXPECT_FALSE(NamesSomething(With(3.0, 0.0), 0));
  EXPECT_FALSE(NamesSomething(With(3.0, 5.0), 1)) << "it was never fitted there";
}

}  // namespace
}  // namespace dynoproof::diagnosis
