// Effects start where they say themselves, those of a plugin as well as those that are built in.
#include "diagnosis/trial.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "experiment/prepare.h"
#include "scenario/load.h"
#include "tests/identification/made_record.h"

namespace dynoproof::diagnosis {
namespace {

/// A plugin's effect of two numbers, whose name ends as that of a built-in one of one number.
class ShaftLag : public Effect {
 public:
  ShaftLag() {
    info_ = {"shaft_lag", "", "a shaft whose torque follows its twist late", {}};
    info_.parameters = {{"tau", "s", "time constant", 0.0, 1.0, 0.0, 0.01}, {"share", "1", "", 0.0, 1.0, 0.0, 0.25}};
  }
  std::vector<Place> Places(const Plan&) const override { return {{"shaft", "k1", ""}}; }
  void Apply(Plan&, const Place&, const std::vector<double>&) const override {}
};

/// The lumped line with a record of T_shaft alone.
class TrialsOfALine : public ::testing::Test {
 protected:
  /// On top of the plan, or of the plan with an effect at its first place.
  std::vector<Trial> Trials(const std::string& base_effect = "") {
    Diagnostics diagnostics;
    const std::optional<Plan> plan = LoadPlan("scenarios/diagnose/heavy_duty_lumped.toml", {}, diagnostics);
    if (!plan) throw std::runtime_error(diagnostics.Format());
    MappedRecord record;
    record.inputs["T_airgap"] = {Shared(Times(2001)), Shared(RandomTorque(2001))};
    record.outputs["T_shaft"] = record.inputs["T_airgap"];
    record.end_s = 0.2;
    const Result<std::unique_ptr<Levels>> levels = Levels::Of(*plan, {record}, registry_, 0.0, 1000);
    if (!levels.ok()) throw std::runtime_error(levels.failure().ToString());
    const EstimationProblem problem(*plan, {record}, registry_);
    const Magnitudes magnitudes = MagnitudesOf(problem);
    estimation::Hypothesis base(*plan);
    if (const Effect* effect = registry_.FindEffect(base_effect))
      base = base.With(*effect, effect->Places(*plan).at(0), magnitudes);
    return TrialsOf(base, **levels, magnitudes, registry_);
  }
  Registry registry_;
};

TEST_F(TrialsOfALine, AnEffectStartsWhereItSays) {
  RegisterBuiltIns(registry_);
  registry_.Add(std::make_unique<ShaftLag>());
  const std::vector<Trial> trials = Trials();
  const auto trial_of = [&](const std::string& name) {
    return std::ranges::find_if(trials, [&](const Trial& trial) { return trial.effect->info().name == name; });
  };
  const auto lag = trial_of("shaft_lag");
  ASSERT_NE(lag, trials.end());
  ASSERT_EQ(lag->starts.size(), 1U);
  EXPECT_DOUBLE_EQ(lag->hypothesis.parameters()[0].ValueAt(lag->starts[0][0]), 0.01);
  EXPECT_DOUBLE_EQ(lag->hypothesis.parameters()[1].ValueAt(lag->starts[0][1]), 0.25);
  ASSERT_NE(trial_of("actuator_lag"), trials.end());
  EXPECT_GT(trial_of("actuator_lag")->starts.size(), 1U);
}

TEST_F(TrialsOfALine, OfWhatNoRecordHasThereIsNone) {
  RegisterBuiltIns(registry_);
  std::vector<std::string> places;
  for (const Trial& trial : Trials()) {
    if (trial.effect->info().name == "sensor_gain") places.push_back(trial.place.ToString());
  }
  EXPECT_EQ(places, std::vector<std::string>{"output:T_shaft"}) << "omega_1 is an output of the scenario alone";
}

TEST_F(TrialsOfALine, WhereACauseHasTakenAPlaceAwayThereIsNone) {
  RegisterBuiltIns(registry_);
  const auto changed = [](const std::vector<Trial>& trials) {
    return std::ranges::count_if(trials,
                                 [](const Trial& trial) { return trial.effect->info().name == "inertia_change"; });
  };
  // The lumps of one rotor are no inertias beside it any more.
  const std::vector<Trial> alone = Trials(), beside = Trials("distributed_inertia");
  EXPECT_LT(changed(beside), changed(alone));
  EXPECT_GT(changed(beside), 0);
  for (const Trial& trial : beside) {
    Eigen::VectorXd q = trial.hypothesis.start();
    if (!trial.starts.empty()) q.segment(trial.own(), trial.starts.front().size()) = trial.starts.front();
    EXPECT_FALSE(trial.hypothesis.At(q).root.table().empty()) << trial.hypothesis.Name();
  }
}

}  // namespace
}  // namespace dynoproof::diagnosis
