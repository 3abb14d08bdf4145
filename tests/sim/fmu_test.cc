// A plant that another tool exported: two bodies on a shaft in a unit of their own, beside the drive line of the same numbers; and what is
// told of files that are no such units.
#include <gmock/gmock.h>
#include <zip.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/support/build.h"
#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"
#include "tests/support/temp_dir.h"

namespace dynoproof::testing {
namespace {

using ::testing::HasSubstr;

constexpr const char* kDescription = R"xml(<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="line" guid="{line}" numberOfEventIndicators="0">
  <ModelExchange modelIdentifier="line"/>
  <TypeDefinitions><SimpleType name="Torque"><Real unit="N.m" nominal="5"/></SimpleType></TypeDefinitions>
  <ModelVariables>
    <ScalarVariable name="T" valueReference="0" causality="input"><Real declaredType="Torque" start="0"/></ScalarVariable>
    <ScalarVariable name="A" valueReference="1"><Real unit="rad"/></ScalarVariable>
    <ScalarVariable name="B" valueReference="2"><Real unit="rad"/></ScalarVariable>
    <ScalarVariable name="w_A" valueReference="3"><Real unit="rad/s"/></ScalarVariable>
    <ScalarVariable name="w_B" valueReference="4" causality="output"><Real unit="rad/s"/></ScalarVariable>
    <ScalarVariable name="der(A)" valueReference="5"><Real derivative="2"/></ScalarVariable>
    <ScalarVariable name="der(B)" valueReference="6"><Real derivative="3"/></ScalarVariable>
    <ScalarVariable name="der(w_A)" valueReference="7"><Real derivative="4"/></ScalarVariable>
    <ScalarVariable name="der(w_B)" valueReference="8"><Real derivative="5"/></ScalarVariable>
    <ScalarVariable name="T_shaft" valueReference="9" causality="output"><Real declaredType="Torque"/></ScalarVariable>
    <ScalarVariable name="I_A" valueReference="10" causality="parameter" variability="fixed"><Real start="0.2"/></ScalarVariable>
    <ScalarVariable name="I_B" valueReference="11" causality="parameter" variability="fixed"><Real start="0.3"/></ScalarVariable>
    <ScalarVariable name="k" valueReference="12" causality="parameter" variability="fixed"><Real start="500"/></ScalarVariable>
    <ScalarVariable name="c" valueReference="13" causality="parameter" variability="fixed"><Real start="0.5"/></ScalarVariable>
    <ScalarVariable name="b" valueReference="14" causality="parameter" variability="fixed"><Real start="0.1"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="5" dependencies=""/><Unknown index="10" dependencies="2 3 4 5"/></Outputs>
    <Derivatives><Unknown index="6"/><Unknown index="7"/><Unknown index="8"/><Unknown index="9"/></Derivatives>
  </ModelStructure>
</fmiModelDescription>)xml";

class Fmu : public ::testing::Test {
 protected:
  /// A unit of that description, with the library or without one; its path.
  std::string UnitWith(const std::string& description, bool library = true, const char* more = nullptr) {
    const std::string path = (folder_ / ("line" + std::to_string(++units_) + ".fmu")).string();
    std::ifstream in(DYNOPROOF_LINE_UNIT, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    int code = 0;
    zip_t* archive = zip_open(path.c_str(), ZIP_CREATE, &code);
    EXPECT_NE(archive, nullptr);
    const auto add = [&](const char* name, const std::string& content) {
      zip_file_add(archive, name, zip_source_buffer(archive, content.data(), content.size(), 0), 0);
    };
    if (!description.empty()) add("modelDescription.xml", description);
    if (library) add("binaries/linux64/line.so", bytes);
    if (more != nullptr) add(more, "out");
    EXPECT_EQ(zip_close(archive), 0);
    return path;
  }

  Plan PlanWith(const std::string& unit) const {
    Plan plan = TwoBodiesPlan();
    plan.root["plant"] = Value{{"type", "fmu"}, {"file", unit}, {"parameter", Value{{"k", 500.0}, {"b", 0.1}}}};
    plan.root["output"]["T_shaft"]["of"] = Value("plant.T_shaft");
    plan.root["output"]["w_B"]["of"] = Value("plant.w_B");
    return plan;
  }

  static std::string FaultsOf(Value table) {
    std::string faults;
    table["type"] = Value("fmu");
    EXPECT_EQ(Build("plant", table, {}, &faults), nullptr);
    return faults;
  }

  static double Distance(const std::vector<double>& a, const std::vector<double>& b) {
    double apart = 0.0, largest = 0.0;
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
      apart = std::max(apart, std::abs(a[k] - b[k]));
      largest = std::max(largest, std::abs(a[k]));
    }
    return a.size() == b.size() && largest > 0.0 ? apart / largest : HUGE_VAL;
  }

  test::TempDir folder_;
  int units_ = 0;
};

std::string Without(std::string text, const std::string& what, const std::string& by = "") {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST_F(Fmu, MovesAsTheDriveLineOfItsNumbers) {
  const Plan unit = PlanWith(UnitWith(kDescription));
  for (const char* solver : {"reference", "realtime"}) {
    const Samples line = RunPlan(TwoBodiesPlan(), solver), other = RunPlan(unit, solver);
    ASSERT_EQ(other.outputs.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_LT(Distance(line.outputs[i], other.outputs[i]), 1e-8) << solver << " " << i;
  }
}

TEST_F(Fmu, TakesParametersStartsAndEffects) {
  Plan unit = PlanWith(UnitWith(kDescription)), line = TwoBodiesPlan();
  line.root["plant"]["shaft"]["k"]["initial_twist_rad"] = Value(0.01);
  line.root["plant"]["shaft"]["k"]["stiffness_Nm_per_rad"] = Value(650.0);
  unit.root["plant"]["start"] = Value{{"A", 0.01}};
  BuiltIns().FindEffect("parameter_change")->Apply(unit, *ParsePlace("parameter:k"), {0.3});
  const auto expected = RunPlan(line, "reference").outputs, found = RunPlan(unit, "reference").outputs;
  EXPECT_LT(Distance(expected[0], found[0]), 1e-8);
  EXPECT_GT(std::abs(found[0][0]), 6.0) << "it begins twisted";
  EXPECT_GT(Distance(RunPlan(TwoBodiesPlan(), "reference").outputs[0], found[0]), 0.1);
}

/// Its own description says what a port is, and what follows an input at once.
TEST_F(Fmu, HasThePortsOfItsDescription) {
  std::string faults;
  const auto plant = Build("plant", Value{{"type", "fmu"}, {"file", UnitWith(kDescription)}}, {}, &faults);
  ASSERT_NE(plant, nullptr) << faults;
  const Layout& layout = plant->layout();
  ASSERT_EQ(layout.inputs.size(), 1U);
  EXPECT_EQ(layout.inputs[0].unit, "N m") << "of its declared type, in our writing";
  EXPECT_EQ(layout.inputs[0].nominal, 5.0);
  ASSERT_EQ(layout.outputs.size(), 5U) << "four states, and no state twice";
  EXPECT_EQ(layout.outputs[4].name, "T_shaft");
  EXPECT_FALSE(plant->FeedsThrough(0, 4));
  const auto unknown =
      Build("plant", Value{{"type", "fmu"}, {"file", UnitWith(Without(kDescription, " dependencies=\"2 3 4 5\""))}});
  ASSERT_NE(unknown, nullptr);
  EXPECT_TRUE(unknown->FeedsThrough(0, 4)) << "it may depend on all";
}

TEST_F(Fmu, TellsWhatIsNoUnitOrNotTakenByOne) {
  const auto file = [](const std::string& path) { return Value{{"file", path}}; };
  EXPECT_THAT(FaultsOf(file("/nowhere/line.fmu")), HasSubstr("there is no such file"));
  const std::string text = (folder_ / "text.fmu").string();
  std::ofstream(text) << "no archive";
  EXPECT_THAT(FaultsOf(file(text)), HasSubstr("a unit is a zip file"));
  EXPECT_THAT(FaultsOf(file(UnitWith(""))), HasSubstr("no modelDescription.xml"));
  EXPECT_THAT(FaultsOf(file(UnitWith(Without(kDescription, "fmiVersion=\"2.0\"", "fmiVersion=\"3.0\"")))),
              HasSubstr("\"3.0\""));
  EXPECT_THAT(FaultsOf(file(UnitWith(Without(kDescription, "ModelExchange", "CoSimulation")))),
              HasSubstr("no unit for model exchange"));
  EXPECT_THAT(FaultsOf(file(UnitWith(Without(kDescription, "Indicators=\"0\"", "Indicators=\"2\"")))),
              HasSubstr("2 event indicators"));
  EXPECT_THAT(FaultsOf(file(UnitWith(kDescription, false))), HasSubstr("does not load"));
  EXPECT_THAT(FaultsOf(file(UnitWith(Without(kDescription, "guid=\"{line}\"", "guid=\"other\"")))),
              HasSubstr("cannot be instantiated"));
  EXPECT_THAT(FaultsOf(file(UnitWith(kDescription, true, "../../out.txt"))), HasSubstr("leads out of it"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path().parent_path() / "out.txt"));
  const std::string unit = UnitWith(kDescription);
  EXPECT_THAT(FaultsOf({{"file", unit}, {"parameter", Value{{"I_a", 1.0}}}}), HasSubstr("did you mean \"I_A\"?"));
  EXPECT_THAT(FaultsOf({{"file", unit}, {"start", Value{{"x", 1.0}}}}), HasSubstr("it has: A, B, w_A, w_B"));
  EXPECT_THAT(FaultsOf({{"file", unit}, {"parameter", Value{{"I_A", -1.0}}}}), HasSubstr("does not initialize"));
}

/// A library of which a byte has changed would run as whatever it is then.
TEST_F(Fmu, WithAChangedByteIsRefused) {
  const std::string unit = UnitWith(kDescription);
  std::ifstream in(unit, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  int refused = 0;
  for (std::size_t at = whole.size() / 10; at < whole.size() / 2; at += whole.size() / 50) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 4);
    const std::string path = (folder_ / "changed.fmu").string();
    std::ofstream(path, std::ios::binary) << changed;
    EXPECT_THAT(FaultsOf({{"file", path}}), HasSubstr("cannot be unpacked")) << at;
    ++refused;
  }
  EXPECT_GE(refused, 20);
}

/// Rates are NaN where the unit refuses a state.
TEST_F(Fmu, ThatRefusesAStateGivesNoNumber) {
  const auto plant = Build("plant", Value{{"type", "fmu"}, {"file", UnitWith(kDescription)}});
  ASSERT_NE(plant, nullptr);
  const double input = 1.0, states[] = {0.0, 0.0, HUGE_VAL, 0.0};
  double rates[4];
  plant->Derivative({0.0, {&input, 1}, states, {}}, rates);
  EXPECT_TRUE(std::ranges::all_of(rates, [](double rate) { return std::isnan(rate); }));
}

}  // namespace
}  // namespace dynoproof::testing
