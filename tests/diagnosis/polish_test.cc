// A model that is named is fitted to the minimum itself, in the substeps that its scenario asks for.
#include "diagnosis/polish.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/contest.h"
#include "diagnosis/contestant.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;

/// A record of a plan with an effect, and the model that has it, fitted in the free run as a contest does.
class Named {
 public:
  Named(Plan searched, const Plan& made, double noise, const std::vector<std::string>& outputs,
        const std::string& effect, const std::string& at)
      : levels_(*Levels::Of(searched, {RecordOf(made, noise, outputs)}, testing::BuiltIns(), 0.0, 10'000)),
        null_(NullHypothesis(searched, false, *levels_, testing::BuiltIns())),
        named_(null_.hypothesis.With(*testing::BuiltIns().FindEffect(effect), *ParsePlace(at), Magnitudes{})) {
    for (Contestant* one : {&null_, &named_}) {
      one->levels.resize(levels_->size());
      for (estimation::Estimate& fit : one->levels) fit.broken = "not fitted";
    }
  }

  /// As where a contest ends: about values of the effect.
  void FitFrom(double value, const estimation::EstimatorOptions& how) {
    Eigen::VectorXd q = named_.hypothesis.start();
    q[0] = named_.hypothesis.parameters()[0].CoordinateOf(value);
    named_.levels[level()] = estimation::Fit(named_.hypothesis, (*levels_)[level()], q, how);
    ASSERT_TRUE(named_.Holds(level())) << fit().broken;
  }

  void Polish(const Plan& as) { diagnosis::Polish(named_, null_, *levels_, level(), as); }
  const estimation::Estimate& fit() const { return named_.levels[level()]; }
  double value() const { return named_.hypothesis.parameters()[0].ValueAt(fit().q[0]); }
  int substeps() const { return SubstepsOf(named_.hypothesis.nominal()); }

 private:
  std::size_t level() const { return levels_->free_run(); }
  std::unique_ptr<Levels> levels_;
  Contestant null_, named_;
};

/// An inertia and the stiffness beside it nearly make up for each other: where one is a few per cent off and the other follows, the
/// record changes by less than its noise.
TEST(Polish, FindsTheMinimumOfNumbersThatMakeUpForEachOther) {
  const Plan plan = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.5"});
  const Plan made = WithEffect(plan, "inertia_change", "inertia:I3", {0.145});
  Named named(plan, made, 0.0, {"T_shaft", "omega_1"}, "inertia_change", "inertia:I3");
  named.FitFrom(0.16, {.renewals = 6, .of_excess = 1e-3, .near = true});
  const double before = named.fit().criterion, off = std::abs(named.value() - 0.145);
  named.Polish(plan);
  EXPECT_LT(named.fit().criterion, 0.1 * before);
  EXPECT_LT(std::abs(named.value() - 0.145), 0.1 * off);
}

/// A lag of the substeps that a search takes is another one.
TEST(Polish, SimulatesInTheSubstepsOfTheScenario) {
  const Plan plan = Scenario("scenarios/diagnose/charge_air.toml", {"run.duration_s=40.0"});
  Plan coarse = plan;
  SetSubsteps(coarse, 1);
  constexpr double kLag_s = 0.11;
  Named named(coarse, WithEffect(plan, "actuator_lag", "input:u_1", {kLag_s}), 0.0, {"p_ch", "p_s"}, "actuator_lag",
              "input:u_1");
  named.FitFrom(kLag_s, {.renewals = 6, .near = true});
  EXPECT_GT(std::abs(named.value() / kLag_s - 1.0), 1e-3);
  named.Polish(plan);
  EXPECT_EQ(named.substeps(), SubstepsOf(plan));
  EXPECT_LT(std::abs(named.value() / kLag_s - 1.0), 1e-5);
}

/// A motor that cogs, fitted in its free run from these values.
Contestant FittedRipple(const Plan& plan, const Levels& levels, const std::vector<double>& from) {
  Contestant ripple(NullHypothesis(plan, false, levels, testing::BuiltIns())
                        .With(*testing::BuiltIns().FindEffect("torque_ripple"), *ParsePlace("inertia:rotor"), {}));
  ripple.levels.resize(levels.size());
  Eigen::VectorXd q = ripple.hypothesis.start();
  for (std::size_t i = 0; i < from.size(); ++i)
    q[static_cast<Eigen::Index>(i)] = ripple.hypothesis.parameters()[i].CoordinateOf(from[i]);
  ripple.levels[levels.free_run()] = estimation::Fit(ripple.hypothesis, levels[levels.free_run()], q);
  EXPECT_TRUE(ripple.Holds(levels.free_run())) << ripple.levels[levels.free_run()].broken;
  return ripple;
}

/// Three periods of a cogging motor tell its order to a few per cent, thirty to a tenth of that.
TEST(FitToAll, TellsByTheWholeOfARecordWhatItsFirstPartHardlyTells) {
  constexpr double kOrder = 90.4, kPart_s = 20.0, kWhole_s = 200.0;
  const Plan plan = estimation::HeldMotor(200);
  const std::vector<MappedRecord> records = {estimation::Slower(
      RecordOf(WithEffect(plan, "torque_ripple", "inertia:rotor", {0.1, kOrder, 0.5}), 0.3, {"F"}), 25)};
  const auto levels = *Levels::Of(plan, records, testing::BuiltIns(), 0.0, 4000, nullptr, kPart_s);
  const std::size_t level = levels->free_run();
  Contestant ripple = FittedRipple(plan, *levels, {0.08, 90.0, 0.6});
  const estimation::Parameter& order = ripple.hypothesis.parameters()[1];
  const Eigen::VectorXd part = ripple.levels[level].q;
  const Eigen::VectorXd of_part = HalfIntervalOf(ripple.levels[level], levels->data(), ripple.hypothesis);

  EXPECT_GT(FitToAll(ripple, *levels, level, records, plan, testing::BuiltIns()), 0.0);

  ASSERT_TRUE(ripple.to_all.has_value());
  EXPECT_EQ(ripple.levels[level].q, part) << "levels remain what the search has compared";
  const auto& [of_all, half] = *ripple.to_all;
  const double truth = order.CoordinateOf(kOrder);
  EXPECT_LT(std::abs(of_all[1] - truth), 0.2 * of_part[1]);
  EXPECT_LT(std::abs(of_all[1] - truth), 1.5 * half[1]);  // three standard errors
  EXPECT_LT(half[1], 0.1 * of_part[1]) << "as the power 3/2 of the length, " << std::pow(kWhole_s / kPart_s, -1.5);
}

TEST(FitToAll, LeavesAnExactModelAsItIsWhereASearchHasSeenEverything) {
  const Plan plan = estimation::HeldMotor(20);
  const std::vector<double> truth = {0.1, 30.0, 0.5};
  const std::vector<MappedRecord> records = {
      RecordOf(WithEffect(plan, "torque_ripple", "inertia:rotor", truth), 0.05, {"F"})};
  const auto levels = *Levels::Of(plan, records, testing::BuiltIns(), 0.0, 4000);
  Contestant ripple = FittedRipple(plan, *levels, truth);
  ASSERT_TRUE(IsExact(ripple.levels[levels->free_run()]));
  EXPECT_EQ(FitToAll(ripple, *levels, levels->free_run(), records, plan, testing::BuiltIns()), 0.0);
  EXPECT_FALSE(ripple.to_all.has_value());
}

}  // namespace
}  // namespace dynoproof::diagnosis
