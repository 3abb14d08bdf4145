// Bodies that slide: the same equations as those that turn, to the bit, under other names and units.
#include "model/motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/random.h"
#include "base/units.h"
#include "tests/support/build.h"
#include "tests/support/flatten.h"
#include "tests/support/plan_builder.h"

namespace dynoproof {
namespace {

using testing::Build;
using testing::BuiltIns;
using testing::Differences;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr Motion kSliding = Motion::kTranslation;

/// [plant], or one of its parts, with the keys of sliding. Sections and the names of parts stay.
Value WithKeysOfSliding(const Value& value, bool parts = false) {
  if (!value.is_table()) return value;
  Value renamed;
  static const std::set<std::string> sections = {"inertia", "rotor", "shaft", "load", "torque", "run"};
  for (const Value::Entry& entry : value.table()) {
    const bool section = !parts && sections.contains(entry.key);
    renamed[parts || section ? entry.key : NameIn(kSliding, entry.key)] = WithKeysOfSliding(entry.value, section);
  }
  return renamed;
}

/// The same line of bodies that slide.
Plan Sliding(Plan plan) {
  Value plant = WithKeysOfSliding(*plan.root.Find("plant"));
  plant["motion"] = Value("translation");
  plan.root["plant"] = std::move(plant);
  for (Value::Entry& input : plan.root["input"].table()) {
    if (Value* unit = input.value.Find("unit")) *unit = Value(UnitIn(kSliding, unit->string()));
  }
  for (Value::Entry& output : plan.root["output"].table()) {
    const std::string of = output.value.TextOr("of");
    const std::size_t dot = of.rfind('.') + 1;
    output.value["of"] = Value(of.substr(0, dot) + NameIn(kSliding, of.substr(dot)));
  }
  return plan;
}

std::vector<Plan> Lines() {
  return {testing::LumpedPlan(), testing::SoftPlan(), testing::PlayPlan(), testing::CouplingPlan()};
}

std::unique_ptr<Component> LineOf(const Plan& plan) {
  std::string faults;
  std::unique_ptr<Component> line = Build("plant", *plan.root.Find("plant"), {}, &faults);
  EXPECT_NE(line, nullptr) << faults;
  return line;
}

std::vector<double> Starts(const Effect& effect) {
  std::vector<double> values;
  for (const EffectParameter& parameter : effect.info().parameters) values.push_back(parameter.start);
  return values;
}

void ForEachUse(const std::function<void(const Effect&, const Plan&, const Place&)>& body) {
  for (const Effect* effect : BuiltIns().Effects()) {
    for (const Plan& plan : Lines()) {
      for (const Place& place : effect->Places(plan)) {
        SCOPED_TRACE(effect->info().name + " at " + place.ToString());
        body(*effect, plan, place);
      }
    }
  }
}

TEST(Motion, HasItsOwnNamesAndUnits) {
  const std::map<std::string, std::string> names = {{"stiffness_Nm_per_rad", "stiffness_N_per_m"},
                                                    {"damping_Nms_per_rad", "damping_Ns_per_m"},
                                                    {"k3_Nm_per_rad3", "k3_N_per_m3"},
                                                    {"b2_Nms2_per_rad2", "b2_Ns2_per_m2"},
                                                    {"inertia_kg_m2", "mass_kg"},
                                                    {"T_c_Nm", "T_c_N"},
                                                    {"nominal_torque_Nm", "nominal_force_N"},
                                                    {"initial_twist_rate_rad_per_s", "initial_stretch_rate_m_per_s"},
                                                    {"initial_angle_rad", "initial_position_m"},
                                                    {"relative_angle", "relative_position"},
                                                    {"half_gap_rad", "half_gap_m"},
                                                    {"theta_rad", "theta_rad"},
                                                    {"slices", "slices"},
                                                    {"torque", "force"},
                                                    {"speed", "speed"}};
  for (const auto& [turning, sliding] : names) {
    EXPECT_EQ(NameIn(kSliding, turning), sliding);
    EXPECT_EQ(NameIn(Motion::kRotation, turning), turning);
    // The suffix of the renamed key names the unit that UnitIn() gives. A phase is an angle in either motion.
    if (turning == "theta_rad") continue;
    EXPECT_EQ(UnitOfSuffix(sliding), UnitIn(kSliding, UnitOfSuffix(turning))) << turning;
  }
  EXPECT_EQ(TextIn(kSliding, "damping_Nms_per_rad > 0, or law = \"dead_zone\""),
            "damping_Ns_per_m > 0, or law = \"dead_zone\"");
  EXPECT_TRUE(IsForce("N") && IsForce("N m") && !IsForce("N/m"));
  EXPECT_TRUE(IsSpeed("m/s") && IsSpeed("rad/s") && !IsSpeed("m"));
  EXPECT_EQ(TextIn(kSliding, "usual shaft torque;"), "usual shaft force;");
}

TEST(Motion, KeysOfRotationAreReadWhereTheyAreWritten) {
  const Value old = {{"T_c_Nm", 3.0}}, both = {{"T_c_Nm", 3.0}, {"T_c_N", 4.0}}, none;
  EXPECT_EQ(KeyIn(kSliding, old, "T_c_Nm"), "T_c_Nm");
  EXPECT_EQ(KeyIn(kSliding, both, "T_c_Nm"), "T_c_N");
  EXPECT_EQ(KeyIn(kSliding, none, "T_c_Nm"), "T_c_N");
  EXPECT_EQ(KeyIn(Motion::kRotation, both, "T_c_Nm"), "T_c_Nm");
}

TEST(Motion, ASlidingLineHasPortsOfForceAndPosition) {
  Plan plan = testing::PlayPlan();
  BuiltIns().FindEffect("dahl_friction")->Apply(plan, {"inertia", "I1", ""}, {5.0, 100.0});
  const auto line = LineOf(Sliding(plan));
  ASSERT_NE(line, nullptr);
  std::map<std::string, std::string> units;
  for (const auto* ports : {&line->layout().inputs, &line->layout().outputs, &line->layout().states}) {
    for (const Port& port : *ports) {
      units[port.name] = port.unit;
      EXPECT_THAT(port.unit, Not(HasSubstr("rad"))) << port.name;
      EXPECT_THAT(port.unit, Not(HasSubstr("N m"))) << port.name;
    }
  }
  for (const auto& [name, unit] :
       {std::pair("T_1", "N"), std::pair("k2.force", "N"), std::pair("k2.stretch", "m"), std::pair("k2.rate", "m/s"),
        std::pair("I1.position", "m"), std::pair("I1.speed", "m/s"), std::pair("dahl_friction.d", "m")})
    EXPECT_EQ(units[name], unit) << name;
}

TEST(Motion, ASlidingLineMovesAsATurningOne) {
  for (const Plan& plan : Lines()) {
    const auto turning = LineOf(plan), sliding = LineOf(Sliding(plan));
    ASSERT_TRUE(turning != nullptr && sliding != nullptr);
    const std::size_t n = turning->layout().states.size();
    ASSERT_EQ(sliding->layout().states.size(), n);
    std::vector<double> states(n), inputs(turning->layout().inputs.size(), 3.0);
    std::vector<int> modes(static_cast<std::size_t>(turning->layout().modes));
    turning->Start(inputs, states, modes);
    for (std::size_t i = 0; i < n; ++i) states[i] += 1e-4 * RandomNormal(1, 0, i);
    std::vector<double> of_turning(n), of_sliding(n);
    turning->Derivative({0.0, inputs, states, modes}, of_turning);
    sliding->Derivative({0.0, inputs, states, modes}, of_sliding);
    EXPECT_EQ(of_turning, of_sliding);
    EXPECT_TRUE(std::ranges::any_of(of_turning, [](double rate) { return rate != 0.0; }));
  }
}

TEST(Motion, EffectsFindAndChangeASlidingLineAsATurningOne) {
  int uses = 0;
  ForEachUse([&](const Effect& effect, const Plan& plan, const Place& place) {
    ++uses;
    Plan sliding = Sliding(plan), changed = plan;
    EXPECT_EQ(effect.Places(sliding), effect.Places(plan));
    Magnitudes magnitudes;
    magnitudes.input = 10.0, magnitudes.speed = 2.0, magnitudes.torque = 5.0;
    EXPECT_EQ(effect.Starts(sliding, place, magnitudes), effect.Starts(plan, place, magnitudes));
    effect.Apply(changed, place, Starts(effect));
    effect.Apply(sliding, place, Starts(effect));
    EXPECT_THAT(Differences(Sliding(changed).root, sliding.root), IsEmpty());
    if (effect.ScaledParameter(place).empty()) return;
    const std::string path = effect.ScaledIn(sliding, place);
    ASSERT_NE(sliding.root.FindPath(path), nullptr) << path;
    EXPECT_EQ(sliding.root.FindPath(path)->number(), changed.root.FindPath(effect.ScaledParameter(place))->number());
  });
  EXPECT_GT(uses, 50);
}

TEST(Motion, EffectsHaveItsUnits) {
  ForEachUse([](const Effect& effect, const Plan& plan, const Place& place) {
    const Plan sliding = Sliding(plan);
    for (std::size_t i = 0; i < effect.info().parameters.size(); ++i) {
      const std::string unit = effect.UnitAt(i, place, sliding);
      EXPECT_TRUE(ParseUnit(unit)) << unit;
      if (effect.info().traits.harmonic) continue;
      EXPECT_THAT(unit, Not(HasSubstr("rad")));
      EXPECT_THAT(unit, Not(HasSubstr("N m")));
    }
  });
  const Effect& ripple = *BuiltIns().FindEffect("torque_ripple");
  const Plan sliding = Sliding(testing::LumpedPlan());
  EXPECT_EQ(ripple.UnitAt(0, {"inertia", "I1", ""}, sliding), "N");
  EXPECT_EQ(ripple.UnitAt(1, {"inertia", "I1", ""}, sliding), "rad/m") << "one per turn of an angle in radians";
  EXPECT_EQ(ripple.UnitAt(2, {"inertia", "I1", ""}, sliding), "rad");
  const Plan moved = testing::PlanOf(Value{{"plant", Value{{"type", "moved_body"}, {"body", "rod"}}}});
  EXPECT_EQ(BuiltIns().FindEffect("coulomb_friction")->UnitAt(0, {"inertia", "rod", ""}, moved), "N")
      << "a moved body slides, whatever the plan says";
}

TEST(Motion, NuisancesOfASlidingLineAreThoseOfATurningOne) {
  for (const Plan& plan : Lines()) {
    const auto turning = BuiltIns().PlantOf(plan).nuisances(plan);
    const Plan slides = Sliding(plan);
    const auto sliding = BuiltIns().PlantOf(slides).nuisances(slides);
    ASSERT_EQ(turning.size(), sliding.size());
    for (std::size_t i = 0; i < turning.size(); ++i) {
      const std::string& path = turning[i].path;
      const std::size_t dot = path.rfind('.') + 1;
      EXPECT_TRUE(sliding[i].path == path ||
                  sliding[i].path == path.substr(0, dot) + NameIn(kSliding, path.substr(dot)));
      EXPECT_EQ(sliding[i].spread, turning[i].spread);
      EXPECT_EQ(slides.root.FindPath(sliding[i].path) != nullptr, plan.root.FindPath(path) != nullptr) << path;
    }
  }
}

TEST(Motion, SectionsKeepTheirNames) {
  for (const auto& [name, other] : {std::pair("torque", "force"), {"inertia", "mass"}}) {
    Value plant = *Sliding(testing::LumpedPlan()).root.Find("plant");
    plant[other] = *plant.Find(name);
    plant.Erase(name);
    std::string faults;
    EXPECT_EQ(Build("plant", plant, {}, &faults), nullptr);
    EXPECT_THAT(faults, HasSubstr(std::string("unknown key \"") + other + "\""));
  }
}

TEST(Motion, FaultsAreToldInItsKeys) {
  Value plant = *Sliding(testing::PlayPlan()).root.Find("plant");
  plant["shaft"]["k2"].Erase("damping_Ns_per_m");
  plant["shaft"]["k1"].Erase("stiffness_N_per_m");
  plant["shaft"]["k3"]["half_gap_m"] = Value(0.1);
  plant["initial_speed_m_per_s"] = Value("fast");
  std::string faults;
  EXPECT_EQ(Build("plant", plant, {}, &faults), nullptr);
  EXPECT_THAT(faults, HasSubstr("damping_Ns_per_m > 0, or law"));
  EXPECT_THAT(faults, HasSubstr("unknown key \"half_gap_m\""));
  EXPECT_THAT(faults, HasSubstr("\"initial_speed_m_per_s\" in plant.drive_line \"test\" is a string"));
  EXPECT_THAT(faults, Not(HasSubstr("rad")));
  plant["motion"] = Value("sideways");
  Build("plant", plant, {}, &faults);
  EXPECT_THAT(faults, HasSubstr("\"motion\" in plant.drive_line \"test\" cannot be \"sideways\""));
}

}  // namespace
}  // namespace dynoproof
