// Effects start where they say themselves, those of a plugin as well as those that are built in.
#include "diagnosis/candidates.h"

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

TEST(CandidatesFor, AnEffectStartsWhereItSays) {
  Registry registry;
  RegisterBuiltIns(registry);
  registry.Add(std::make_unique<ShaftLag>());
  Diagnostics diagnostics;
  const std::optional<Plan> plan = LoadPlan("scenarios/diagnose/heavy_duty_lumped.toml", {}, diagnostics);
  ASSERT_TRUE(plan) << diagnostics.Format();
  MappedRecord record;
  record.inputs["T_airgap"] = {Shared(Times(201)), Shared(RandomTorque(201))};
  record.outputs["T_shaft"] = record.inputs["T_airgap"];
  record.end_s = 0.02;
  const EstimationProblem problem(*plan, {record}, registry);
  const std::vector<Candidate> candidates = CandidatesFor(problem, MagnitudesOf(problem));
  const auto starts_of = [&](const std::string& name) {
    const auto found = std::find_if(candidates.begin(), candidates.end(),
                                    [&](const Candidate& candidate) { return candidate.effect->info().name == name; });
    return found == candidates.end() ? std::vector<std::vector<double>>{} : found->starts;
  };
  EXPECT_EQ(starts_of("shaft_lag"), (std::vector<std::vector<double>>{{0.01, 0.25}}));
  EXPECT_GT(starts_of("actuator_lag").size(), 1U);
}

}  // namespace
}  // namespace dynoproof::diagnosis
