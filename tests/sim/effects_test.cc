// Every effect at every place of a lumped and a soft line: it changes the run, and both solvers agree on the changed
// run.
#include <cmath>
#include <map>

#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

namespace dynoproof::testing {
namespace {

Plan Driven(Plan plan) {
  plan.root["run"] = Value{{"duration_s", 0.1}, {"reference", Value{{"relative_tolerance", 1e-9}}}};
  plan.root["plant"].Erase("load");
  Value& input = plan.root["input"]["T_airgap"];
  input.Erase("actuator");
  input["nominal"] = Value(1000.0);
  // Above the start values of saturations and dead zones; an offset lets the line turn one way, so that friction shows,
  // backwards, so that a rectified sensor does.
  input["source"] = Value{{"type", "multisine"}, {"low_Hz", 5.0}, {"high_Hz", 800.0}, {"lines", 40},
                          {"rms", 800.0},        {"seed", 3},     {"offset", -300.0}};
  plan.root["output"]["T_shaft"].Erase("sensor");
  plan.root["output"]["T_shaft"]["nominal"] = Value(1000.0);
  return plan;
}

/// The plan with the effect at its start values; where these are too small to show in 0.1 s, larger.
Plan With(const Effect& effect, const Place& place, const Plan& plan) {
  const std::map<std::string, double> larger = {{"constant_load", 50.0},
                                                {"cubic_stiffness", 1e13},
                                                {"quadratic_drag", 30.0},
                                                {"sensor_drift", 1.0},
                                                {"sensor_offset", 1.0}};
  std::vector<double> values;
  for (const EffectParameter& parameter : effect.info().parameters) values.push_back(parameter.start);
  if (const auto it = larger.find(effect.info().name); it != larger.end()) values[0] = it->second;
  Plan changed = plan;
  effect.Apply(changed, place, values);
  return changed;
}

/// Motion through a gap is chaotic: only its first 5 ms, with the first contacts, say something.
constexpr double kBeforeChaos_s = 5e-3;

TEST(SlowEffects, ChangeTheRunAlikeInBothSolvers) {
  int tried = 0;
  for (const Plan& plan : {Driven(LumpedPlan()), Driven(SoftPlan())}) {
    const Samples nominal = RunPlan(plan, "realtime");
    for (const Effect* effect : BuiltIns().Effects()) {
      const std::vector<Place> places = effect->Places(plan);
      if (places.empty()) continue;
      // The last place: the far end of the line, or the last output. The others differ in numbers only.
      const std::string what = effect->info().name + " at " + places.back().ToString();
      Plan changed = With(*effect, places.back(), plan);
      const bool chaotic = effect->info().name == "backlash";
      if (chaotic) changed.root["run"]["duration_s"] = Value(kBeforeChaos_s);
      const Samples realtime = RunPlan(changed, "realtime"), reference = RunPlan(changed, "reference");
      ASSERT_EQ(realtime.outputs.size(), nominal.outputs.size()) << what;
      double change = 0.0, distance = 0.0;
      for (std::size_t i = 0; i < nominal.outputs.size(); ++i) {
        const std::vector<double>& before = nominal.outputs[i];
        change =
            std::max(change, Nrmse({before.begin(), before.begin() + realtime.outputs[i].size()}, realtime.outputs[i]));
        distance = std::max(distance, Nrmse(reference.outputs[i], realtime.outputs[i]));
      }
      EXPECT_GT(change, 1e-7) << what << " changes nothing";
      // Two per cent: dry friction that sticks and slips within 0.1 s; smooth effects lie orders below.
      EXPECT_LT(distance, 0.02) << what;
      ++tried;
    }
  }
  EXPECT_GE(tried, 40);
}

}  // namespace
}  // namespace dynoproof::testing
