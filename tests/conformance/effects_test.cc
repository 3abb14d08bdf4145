// What every effect promises, asked of the whole registry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "base/random.h"
#include "base/units.h"
#include "tests/support/build.h"
#include "tests/support/flatten.h"
#include "tests/support/plan_builder.h"

namespace dynoproof {
namespace {

using testing::Build;
using testing::BuildLaw;
using testing::BuiltIns;
using testing::Differences;

/// What an effect leaves of the plan at its neutral strengths.
enum class Neutral {
  kByPlace,     // a load of no torque, a stage that changes nothing, or the plan as it was
  kSameTorque,  // another law of the shaft, of the same torque
  kNone,        // there is no such strength, or it is a test of its own in tests/plugins/effects_test.cc
};

/// What is asked of one effect.
struct Row {
  std::vector<std::string> parameters;
  Neutral neutral = Neutral::kByPlace;
  bool scales = false;                    // it multiplies one number of the plan and says which: ScaledParameter()
  std::vector<std::string> touches = {};  // of the plan, where that is more than its place and a load of its name
};

// All effects, by the names of the contract, with their parameters. A new effect is one row here.
const std::map<std::string, Row> kContract = {
    {"viscous_friction", {{"b"}}},
    {"coulomb_friction", {{"T_c"}}},
    {"stribeck_friction", {{"T_c", "T_s", "w_s"}}},
    {"asymmetric_friction", {{"T_c_pos", "T_c_neg", "b_pos", "b_neg"}}},
    {"dahl_friction", {{"F_c", "sigma"}}},
    {"constant_load", {{"T_0"}}},
    {"quadratic_drag", {{"b2"}}},
    {"torque_ripple", {{"A", "n", "theta"}}},
    {"inertia_change", {.parameters = {"delta"}, .scales = true}},
    {"stiffness_change", {.parameters = {"delta"}, .scales = true}},
    {"damping_change", {.parameters = {"delta"}, .scales = true}},
    {"parameter_change", {.parameters = {"delta"}, .scales = true}},
    {"distributed_inertia",
     {.parameters = {"I", "k_rotor", "c_rotor"},
      .neutral = Neutral::kNone,
      .touches = {"plant.", "output.omega_1.of"}}},
    {"series_elasticity",
     {.parameters = {"k", "c"},
      .neutral = Neutral::kNone,
      .touches = {"plant.inertia.", "plant.shaft.", "plant.run.R."}}},
    {"cubic_stiffness", {.parameters = {"k3"}, .neutral = Neutral::kSameTorque}},
    {"backlash", {.parameters = {"a"}, .neutral = Neutral::kSameTorque}},
    {"gap_change", {.parameters = {"delta"}, .scales = true}},
    {"contact_free_damping", {.parameters = {"c_f"}, .neutral = Neutral::kSameTorque}},
    {"oil_dynamics", {.parameters = {"k_s", "kappa_p", "k_p_kappa_w"}, .neutral = Neutral::kNone}},
    {"viscosity_drift", {.parameters = {"delta", "tau"}, .neutral = Neutral::kSameTorque}},
    {"actuator_lag", {{"tau"}}},
    {"actuator_delay", {{"t_d"}}},
    {"actuator_gain", {{"g"}}},
    {"actuator_saturation", {{"limit"}}},
    {"actuator_dead_zone", {{"width"}}},
    {"actuator_harmonic", {{"h2", "h3"}}},
    {"sensor_gain", {{"g"}}},
    {"sensor_offset", {{"o"}}},
    {"sensor_delay", {{"t_d"}}},
    {"sensor_lag", {{"tau"}}},
    {"sensor_drift", {{"slope"}}},
    {"sensor_rectified", {.parameters = {}, .neutral = Neutral::kNone}},
    {"leakage", {{"A_leak"}}},
    {"flow_area_error", {{"g"}}},
    {"actuator_hysteresis", {{"width"}}},
    {"valve_stiction", {{"F_c"}}},
    {"supply_droop", {{"slope"}}},
};

// Plans on which each of these effects has a place between them.
std::vector<Plan> SamplePlans() {
  return {testing::LumpedPlan(), testing::SoftPlan(), testing::PlayPlan(),     testing::CouplingPlan(),
          testing::AirPlan(),    testing::GasPlan(),  testing::EquationsPlan()};
}

std::vector<double> Starts(const Effect& effect) {
  std::vector<double> values;
  for (const EffectParameter& parameter : effect.info().parameters) values.push_back(parameter.start);
  return values;
}

/// The neutral value of each parameter, the start for shape parameters.
std::vector<double> Neutrals(const Effect& effect) {
  std::vector<double> values = Starts(effect);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double neutral = effect.info().parameters[i].neutral;
    if (!std::isnan(neutral)) values[i] = neutral;
  }
  return values;
}

/// Every effect at every place of the sample plans.
void ForEachUse(const std::function<void(const Effect&, const Plan&, const Place&)>& body) {
  for (const auto& [name, row] : kContract) {
    const Effect* effect = BuiltIns().FindEffect(name);
    ASSERT_NE(effect, nullptr) << name;
    int places = 0;
    for (const Plan& plan : SamplePlans()) {
      for (const Place& place : effect->Places(plan)) {
        SCOPED_TRACE(name + " at " + place.ToString());
        body(*effect, plan, place);
        ++places;
      }
    }
    EXPECT_GT(places, 0) << name;
  }
}

TEST(Effects, HaveTheNamesAndParametersOfTheContract) {
  for (const auto& [name, row] : kContract) {
    const Effect* effect = BuiltIns().FindEffect(name);
    ASSERT_NE(effect, nullptr) << name;
    std::vector<std::string> names;
    for (const EffectParameter& parameter : effect->info().parameters) names.push_back(parameter.name);
    EXPECT_EQ(names, row.parameters) << name;
  }
}

TEST(Effects, DeclareParametersThatAFitCanUse) {
  for (const Effect* effect : BuiltIns().Effects()) {
    SCOPED_TRACE(effect->info().name);
    EXPECT_FALSE(effect->info().law.empty());
    EXPECT_FALSE(effect->info().description.empty());
    for (const EffectParameter& p : effect->info().parameters) {
      SCOPED_TRACE(p.name);
      EXPECT_TRUE(ParseUnit(p.unit)) << p.unit;
      EXPECT_FALSE(p.description.empty());
      EXPECT_TRUE(std::isfinite(p.lower) && std::isfinite(p.upper));
      EXPECT_LT(p.lower, p.upper);
      EXPECT_GE(p.start, p.lower);
      EXPECT_LE(p.start, p.upper);
      EXPECT_TRUE(std::isnan(p.neutral) || (p.neutral >= p.lower && p.neutral <= p.upper));
    }
  }
}

TEST(Effects, HaveNoPlaceOnUnsuitablePlans) {
  Plan bare = testing::LumpedPlan();
  bare.root.Erase("plant");
  bare.root.Erase("input");
  bare.root.Erase("output");
  Plan broken = testing::LumpedPlan();
  broken.root["plant"]["load"] = Value(5.0);
  for (const auto& [name, row] : kContract) {
    const Effect* effect = BuiltIns().FindEffect(name);
    ASSERT_NE(effect, nullptr);
    EXPECT_TRUE(effect->Places(testing::PressurePlan()).empty()) << name;
    EXPECT_TRUE(effect->Places(bare).empty()) << name;
    for (const Place& place : effect->Places(broken)) {
      EXPECT_TRUE(place.kind == "input" || place.kind == "output") << name << " on a plan whose loads are a number";
    }
  }
}

TEST(Effects, LeaveAllElseUntouched) {
  ForEachUse([](const Effect& effect, const Plan& plan, const Place& place) {
    Plan changed = plan;
    effect.Apply(changed, place, Starts(effect));
    std::vector<std::string> allowed;
    if (place.kind == "input")
      allowed = {"input." + place.name + ".actuator."};
    else if (place.kind == "output")
      allowed = {"output." + place.name + ".sensor."};
    else if (const Row& row = kContract.at(effect.info().name); !row.touches.empty())
      allowed = row.touches;
    else
      allowed = {"plant." + place.kind + "." + place.name, "plant.load." + effect.info().name + "."};
    for (const std::string& path : Differences(plan.root, changed.root)) {
      EXPECT_TRUE(std::any_of(allowed.begin(), allowed.end(), [&](const std::string& a) {
        return path.starts_with(a);
      })) << path;
    }
  });
}

TEST(Effects, AtOtherStrengthsChangeThePlan) {
  ForEachUse([](const Effect& effect, const Plan& plan, const Place& place) {
    Plan changed = plan, stronger = plan;
    effect.Apply(changed, place, Starts(effect));
    EXPECT_FALSE(Differences(plan.root, changed.root).empty());
    for (std::size_t i = 0; i < effect.info().parameters.size(); ++i) {  // every parameter reaches the plan
      std::vector<double> values = Starts(effect);
      const EffectParameter& p = effect.info().parameters[i];
      values[i] = p.start < 0.5 * (p.lower + p.upper) ? p.start + 0.125 * (p.upper - p.lower)
                                                      : p.start - 0.125 * (p.upper - p.lower);
      Plan other = plan;
      effect.Apply(other, place, values);
      EXPECT_FALSE(Differences(changed.root, other.root).empty()) << p.name;
    }
  });
}

TEST(Effects, TwiceAtOnePlaceKeepTheFirst) {
  ForEachUse([](const Effect& effect, const Plan& plan, const Place& place) {
    if (!effect.info().name.ends_with("friction") && place.kind != "input" && place.kind != "output") return;
    Plan once = plan, twice = plan;
    effect.Apply(once, place, Starts(effect));
    effect.Apply(twice, place, Starts(effect));
    effect.Apply(twice, place, Starts(effect));
    std::map<std::string, std::string> flat_once, flat_twice;
    testing::Flatten(once.root, "", flat_once);
    testing::Flatten(twice.root, "", flat_twice);
    EXPECT_GT(flat_twice.size(), flat_once.size());
    if (place.kind == "output") return;  // there the second goes between the first and the noise
    for (const auto& [path, text] : flat_once) EXPECT_EQ(flat_twice[path], text) << path;
  });
}

/// What a law adds over a plan where it is not, or over the law that was there: the torque at a view.
double TorqueOf(const Value& table, const LawView& seen) {
  const std::unique_ptr<Law> law = BuildLaw(table);
  if (law == nullptr) return std::nan("");
  std::vector<double> states(law->layout().states.size(), 0.0);
  std::vector<int> modes(static_cast<std::size_t>(law->layout().modes), 0);
  law->Start(seen.twist, seen.rate, states, modes);
  std::vector<double> rates(states.size(), 0.0);
  LawView view = seen;
  view.states = states;
  view.modes = modes;
  law->Derivative(view, rates);
  double sum = law->Torque(view);
  for (const double rate : rates) sum += rate;  // a state that moves would show later
  return sum;
}

TEST(Effects, AtTheNeutralStrengthAreTheNominalModel) {
  // A split joint is rigid in the limit only, a run of lumps is no rotor at any value, oil moves at every value:
  // tests/plugins/effects_test.cc.
  ForEachUse([&](const Effect& effect, const Plan& plan, const Place& place) {
    const Neutral kind = kContract.at(effect.info().name).neutral;
    if (kind == Neutral::kNone) return;
    Plan neutral = plan;
    effect.Apply(neutral, place, Neutrals(effect));
    const Value* load = neutral.root.FindPath("plant.load." + effect.info().name);
    const Value* shaft = neutral.root.FindPath("plant.shaft." + place.name);
    const std::string chain = place.kind + "." + place.name + (place.kind == "input" ? ".actuator" : ".sensor");
    if (load != nullptr) {
      for (std::uint64_t i = 0; i < 50; ++i) {
        const LawView view{0.0, RandomNormal(5, 0, i), 100 * RandomNormal(5, 1, i), RandomNormal(5, 2, i), {}, {}};
        EXPECT_EQ(TorqueOf(*load, view), 0.0);
      }
    } else if (kind == Neutral::kSameTorque) {
      for (std::uint64_t i = 0; i < 50; ++i) {
        const LawView view{
            0.1 * static_cast<double>(i), 0.01 * RandomNormal(5, 0, i), RandomNormal(5, 1, i), 0.0, {}, {}};
        EXPECT_EQ(TorqueOf(*shaft, view), TorqueOf(*plan.root.FindPath("plant.shaft." + place.name), view));
      }
    } else if (place.kind == "input" || place.kind == "output") {
      const Value::Array& stages = neutral.root.FindPath(chain)->array();
      const std::size_t last = place.kind == "output" && stages.size() > 1 ? stages.size() - 2 : stages.size() - 1;
      const auto stage = Build(place.kind == "input" ? "actuator" : "sensor", stages[last], {.nominal = 1000.0});
      ASSERT_NE(stage, nullptr);
      EXPECT_EQ(stage->delay_s(), 0.0);
      EXPECT_TRUE(stage->layout().states.empty());
      for (std::uint64_t i = 0; i < 50; ++i) {
        const double in = 1e4 * RandomNormal(5, 3, i);
        EXPECT_EQ(testing::OutputOf(*stage, 0.7, {&in, 1}), in);
      }
    } else {
      EXPECT_THAT(Differences(plan.root, neutral.root), ::testing::IsEmpty());
    }
  });
}

TEST(Effects, MakePlansThatStillBuild) {
  ForEachUse([](const Effect& effect, const Plan& plan, const Place& place) {
    Plan changed = plan;
    EffectUse use{effect.info().name, place.ToString(), Value(), {}};
    for (const EffectParameter& p : effect.info().parameters) use.parameters[p.name] = Value(p.start);
    Diagnostics diagnostics;
    ASSERT_TRUE(ApplyEffect(BuiltIns(), use, changed, diagnostics)) << diagnostics.Format();
    std::string faults;
    EXPECT_NE(Build("plant", *changed.root.Find("plant"), {}, &faults), nullptr) << faults;
    for (const auto& [name, input] : ReadInputs(changed, diagnostics)) {
      for (const Value& stage : input.actuator) EXPECT_NE(Build("actuator", stage, {}, &faults), nullptr) << faults;
    }
    for (const auto& [name, output] : ReadOutputs(changed, diagnostics)) {
      for (const Value& stage : output.sensor) EXPECT_NE(Build("sensor", stage, {}, &faults), nullptr) << faults;
    }
    EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.Format();
  });
}

TEST(Effects, DeclareTraitsThatTheirParametersBearOut) {
  for (const Effect* effect : BuiltIns().Effects()) {
    SCOPED_TRACE(effect->info().name);
    const EffectTraits& traits = effect->info().traits;
    const std::vector<EffectParameter>& parameters = effect->info().parameters;
    EXPECT_TRUE(!traits.harmonic || parameters.size() == 3U);
    for (const std::string& plainer : traits.refines) EXPECT_NE(BuiltIns().FindEffect(plainer), nullptr) << plainer;
  }
}

TEST(Effects, OfferStarts) {
  Magnitudes magnitudes;
  magnitudes.torque = 300.0;
  ForEachUse([&](const Effect& effect, const Plan& plan, const Place& place) {
    const Points starts = effect.Starts(plan, place, magnitudes);
    EXPECT_FALSE(starts.empty());
    for (const std::vector<double>& start : starts) {
      EXPECT_EQ(start.size(), effect.info().parameters.size());
      EXPECT_TRUE(std::all_of(start.begin(), start.end(), [](double value) { return std::isfinite(value); }));
    }
  });
}

TEST(Effects, ThatScaleAParameterChangeNothingElse) {
  std::set<std::string> scaling;
  ForEachUse([&](const Effect& effect, const Plan& plan, const Place& place) {
    const std::string path = effect.ScaledParameter(place);
    if (path.empty()) return;
    scaling.insert(effect.info().name);
    Plan changed = plan;
    effect.Apply(changed, place, {0.25});
    EXPECT_EQ(Differences(plan.root, changed.root), std::vector<std::string>{path});
    EXPECT_DOUBLE_EQ(changed.root.FindPath(path)->number(), 1.25 * plan.root.FindPath(path)->number());
  });
  for (const auto& [name, row] : kContract) EXPECT_EQ(scaling.contains(name), row.scales) << name;
}

TEST(Plants, DeclareNuisanceParametersOfTheirPlans) {
  for (const Plan& plan : SamplePlans()) {
    const PlantTraits& plant = BuiltIns().PlantOf(plan);
    ASSERT_TRUE(plant.nuisances);
    int known = 0;
    for (const NuisanceParameter& one : plant.nuisances(plan)) {
      SCOPED_TRACE(one.path);
      EXPECT_GT(one.spread, 0.0);
      EXPECT_FALSE(one.reason.empty());
      EXPECT_FALSE(one.relative && one.initial);
      known += plan.root.FindPath(one.path) != nullptr ? 1 : 0;
    }
    EXPECT_GT(known, 0);
    for (const MeasuredStart& start : plant.measured_starts) EXPECT_NE(plan.root.FindPath(start.path), nullptr);
  }
}

}  // namespace
}  // namespace dynoproof
