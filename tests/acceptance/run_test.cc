// `dynoproof run` from outside: exit codes, results, files (contract, "Commands" and "JSON of run").
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <pugixml.hpp>
#include <set>

#include "tests/support/program.h"
#include "trace/trace_io.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Run, PassesAndTellsEverythingTheContractNames) {
  const Bench bench;
  const Outcome run = bench.Call({"run", "line.toml", "--json", "result.json"});
  EXPECT_EQ(run.exit, 0) << run.Both();
  const nlohmann::json document = nlohmann::json::parse(ReadBytes(bench / "result.json"));
  EXPECT_EQ(document.at("exit"), 0);
  ASSERT_EQ(document.at("scenarios").size(), 1u);
  const nlohmann::json& scenario = document.at("scenarios")[0];
  EXPECT_EQ(scenario.at("id"), "line");
  EXPECT_EQ(scenario.at("verdict"), "pass");
  EXPECT_EQ(scenario.at("trace"), "out/line.h5");
  EXPECT_TRUE(scenario.at("figures").is_object());
  for (const auto& [name, figure] : scenario.at("figures").items()) {
    EXPECT_TRUE(figure.at("value").is_number()) << name;
    EXPECT_TRUE(figure.at("unit").is_string()) << name;
  }
  ASSERT_EQ(scenario.at("checks").size(), 2u);
  for (const nlohmann::json& check : scenario.at("checks")) {
    EXPECT_EQ(check.at("verdict"), "pass");
    EXPECT_LE(check.at("value").get<double>(), check.at("limit").get<double>());
    EXPECT_GE(check.at("value").get<double>(), 0.0);
    for (const char* key : {"name", "kind", "unit", "origin", "explanation"})
      EXPECT_TRUE(check.at(key).is_string()) << key;
    EXPECT_NE(check.at("origin"), "");
  }
}

TEST(Run, WritesTheTraceThatTheContractDescribes) {
  const Bench bench;
  ASSERT_EQ(bench.Call({"run", "line.toml", "--out", "there/deep", "--set", "run.seed=7"}).exit, 0);
  const Result<trace::Trace> trace = trace::ReadTrace(bench / "there/deep/line.h5");
  ASSERT_TRUE(trace.ok()) << trace.failure().ToString();
  ASSERT_EQ(trace->time.size(), 501u);  // 0.05 s at 10 kHz, both ends
  EXPECT_EQ(trace->time.front(), 0.0);
  EXPECT_DOUBLE_EQ(trace->time.back(), 0.05);
  const trace::Signal* torque = trace->Find("T_shaft");
  ASSERT_NE(torque, nullptr);
  EXPECT_EQ(torque->unit, "N m");
  EXPECT_EQ(torque->nominal, 100.0);
  EXPECT_EQ(torque->interpolation, trace::Interpolation::kLinear);
  const trace::Signal* command = trace->Find("T_airgap");
  ASSERT_NE(command, nullptr);
  EXPECT_EQ(command->interpolation, trace::Interpolation::kHold);
  const trace::Signal* hull = trace->Find("T_shaft_hull_upper");
  ASSERT_NE(hull, nullptr);
  EXPECT_GT(hull->time_base, 0u) << "another rate has a time base of its own";
  EXPECT_THAT(trace->scenario, HasSubstr("seed = 7")) << "the resolved scenario, overrides included";
  for (const char* key : {"version", "commit", "compiler", "cpu", "solver"}) {
    EXPECT_TRUE(trace->provenance.Text(key)) << key;
  }
  EXPECT_EQ(trace->provenance.Counter("seed"), 7);
}

TEST(Run, WritesTheSameBytesAgain) {
  const Bench bench;
  for (const char* solver : {"realtime", "reference"}) {
    ASSERT_EQ(bench.Call({"run", "line.toml", "--solver", solver, "--out", "a"}).exit, 0);
    ASSERT_EQ(bench.Call({"run", "line.toml", "--solver", solver, "--out", "b", "--jobs", "2"}).exit, 0);
    const std::string first = ReadBytes(bench / "a/line.h5");
    EXPECT_GT(first.size(), 3u * 8 * 501);
    EXPECT_TRUE(first == ReadBytes(bench / "b/line.h5")) << solver;
  }
}

TEST(Run, GivesJUnitOneCasePerCheck) {
  const Bench bench;
  bench.Write("bad.toml", Bench::kLine);
  const Outcome run =
      bench.Call({"run", "bad.toml", "--set", "check.1.nrmse=1e-30", "--junit", "j.xml", "--markdown", "m.md"});
  EXPECT_EQ(run.exit, 1) << run.Both();
  pugi::xml_document document;
  ASSERT_TRUE(document.load_file((bench / "j.xml").c_str()));
  const pugi::xml_node suite = document.child("testsuites").child("testsuite");
  EXPECT_STREQ(suite.attribute("name").value(), "bad");
  EXPECT_EQ(suite.attribute("tests").as_int(), 2);
  EXPECT_EQ(suite.attribute("failures").as_int(), 1);
  std::set<std::string> names;
  int failed = 0;
  for (const pugi::xml_node test : suite.children("testcase")) {
    names.insert(test.attribute("name").value());
    if (test.child("failure")) ++failed;
  }
  EXPECT_EQ(names.size(), 2u);
  EXPECT_EQ(failed, 1);
  EXPECT_THAT(ReadBytes(bench / "m.md"), HasSubstr("bad"));
}

TEST(Run, KeepsTablesOffStdoutWhenJsonGoesThere) {
  const Bench bench;
  const Outcome run = bench.Call({"run", "line.toml", "--json", "-"});
  EXPECT_EQ(run.exit, 0);
  EXPECT_FALSE(nlohmann::json::parse(run.out, nullptr, false).is_discarded()) << run.out;
  EXPECT_THAT(run.err, HasSubstr("worst check"));
  const Outcome plain = bench.Call({"run", "line.toml"});
  EXPECT_THAT(plain.out, HasSubstr("worst check"));
  EXPECT_EQ(plain.err, "") << "no progress off a terminal";
}

TEST(Run, ColoursOnlyATerminalThatWantsIt) {
  const Bench bench;
  const std::vector<std::string> arguments = {"run", "line.toml", "--set", "check.1.nrmse=1e-30"};
  const std::string colour = "\033[1;31m";
  EXPECT_THAT(bench.Call(arguments).Both(), Not(HasSubstr("\033")));
  EXPECT_THAT(bench.Call(arguments, {.terminal = true}).out, HasSubstr(colour));
  EXPECT_THAT(bench.Call(arguments, {.environment = {{"NO_COLOR", "1"}}, .terminal = true}).out,
              Not(HasSubstr(colour)));
  EXPECT_THAT(bench.Call({"run", "none"}, {.terminal = true}).out, HasSubstr(colour));
  EXPECT_THAT(bench.Call({"run", "none"}, {.environment = {{"NO_COLOR", "1"}}, .terminal = true}).out,
              Not(HasSubstr(colour)));
}

TEST(Run, TakesOverridesAndChecksThem) {
  const Bench bench;
  const nlohmann::json nominal = bench.Json({"modes", "line.toml"});
  const nlohmann::json heavy = bench.Json({"modes", "line.toml", "--set", "plant.inertia.I3=0.6"});
  EXPECT_LT(heavy["modes"][1]["frequency_hz"].get<double>(), 0.99 * nominal["modes"][1]["frequency_hz"].get<double>());
  const Outcome wrong = bench.Call({"run", "line.toml", "--set", "plant.inertia.I3=-1", "--set", "run.solver=fast"});
  EXPECT_EQ(wrong.exit, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--set:1:18: error: \"I3\""));
  EXPECT_THAT(wrong.err, HasSubstr("--set:2:12: error: \"solver\""));
  EXPECT_FALSE(std::filesystem::exists(bench / "out")) << "files are validated before anything runs";
}

TEST(Run, FailsWithOneWhenACheckFallsShort) {
  const Bench bench;
  const Outcome run = bench.Call({"run", "line.toml", "--set", "check.1.nrmse=1e-30"});
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("FAILED line: held_input_exponential T_shaft"));
  EXPECT_THAT(run.out, HasSubstr("--set check.1.nrmse=1e-30")) << "how to do it again";
}

TEST(Run, NeverPassesWhenNothingIsChecked) {
  const Bench bench;
  const Outcome run = bench.Call({"run", "line.toml", "--set", "check=[]"});
  EXPECT_EQ(run.exit, 1) << run.Both();
  EXPECT_THAT(run.err, HasSubstr("nothing was compared"));
}

TEST(Run, BreaksWithThreeWhenTheStateIsNotFinite) {
  const Bench bench;
  const nlohmann::json document = bench.Json(
      {"run", "line.toml", "--set", "input.T_airgap.source.amplitude=1e308", "--set", "plant.inertia.I1=1e-3"});
  EXPECT_EQ(document["exit"], 3);
  EXPECT_EQ(document["scenarios"][0]["verdict"], "broken");
}

TEST(Run, IsTwoForBadUse) {
  const Bench bench;
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"rnu"},
                                             {"run", "--jobs", "0"},
                                             {"run", "--jobs"},
                                             {"run", "--frobnicate"},
                                             {"run", "line.toml", "--solver", "fast"},
                                             {"run", "line.toml", "--map", "m.toml"},
                                             {"modes"},
                                             {"validate"},
                                             {"compare", "a.h5"},
                                             {"new", "thing", "x"},
                                             {"new", "law", "Bad Name"},
                                             {"describe", "nobody"}}) {
    const Outcome outcome = bench.Call(arguments);
    EXPECT_EQ(outcome.exit, 2) << ::testing::PrintToString(arguments) << outcome.Both();
    EXPECT_NE(outcome.err, "");
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(Run, SuggestsTheIdThatWasMeant) {
  const Bench bench;
  const Outcome outcome = bench.Call({"run", "r2r/soft_rotr_setup_1"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("did you mean \"r2r/soft_rotor_setup_1\"?"));
}

TEST(Run, SuggestsTheKeyThatWasMeant) {
  const Bench bench;
  std::string text = Bench::kLine;
  text.replace(text.find("damping_Nms"), 7, "dampng");
  bench.Write("wrong.toml", text);
  const Outcome outcome = bench.Call({"run", "line.toml", "wrong.toml"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("wrong.toml:18:1: error: unknown key \"dampng_Nms_per_rad\""));
  EXPECT_THAT(outcome.err, HasSubstr("did you mean \"damping_Nms_per_rad\"?"));
  EXPECT_FALSE(std::filesystem::exists(bench / "out/line.h5")) << "one faulty file: none runs";
}

TEST(Run, RefusesTwoScenariosOfOneId) {
  const Bench bench;
  bench.Write("a/same.toml", Bench::kLine);
  bench.Write("b/same.toml", Bench::kLine);
  EXPECT_EQ(bench.Call({"run", "a/same.toml", "b/same.toml"}).exit, 2) << "one trace would overwrite the other";
}

TEST(Run, GivesTheWorstExitOfSeveral) {
  const Bench bench;
  bench.Write("all/good.toml", Bench::kLine);
  std::string text = Bench::kLine;
  text.replace(text.find("nrmse = 1e-9"), 12, "nrmse = 1e-30");
  bench.Write("all/short.toml", text);
  const nlohmann::json document = bench.Json({"run", "all", "--jobs", "2"});
  EXPECT_EQ(document["exit"], 1);
  ASSERT_EQ(document["scenarios"].size(), 2u);
  EXPECT_EQ(document["scenarios"][0]["verdict"], "pass");
  EXPECT_EQ(document["scenarios"][1]["verdict"], "fail");
}

TEST(Everything, HasHelpWithExamples) {
  const Bench bench;
  for (const char* command : {"run", "modes", "list", "describe", "validate", "new", "compare", "bless"}) {
    const Outcome outcome = bench.Call({command, "--help"});
    EXPECT_EQ(outcome.exit, 0) << command;
    EXPECT_THAT(outcome.out, HasSubstr("Examples:")) << command;
    EXPECT_THAT(outcome.out, HasSubstr("--json")) << command;
    EXPECT_THAT(outcome.out, HasSubstr("--plugin")) << command;
  }
  EXPECT_EQ(bench.Call({"--help"}).exit, 0);
  EXPECT_EQ(bench.Call({"--version"}).exit, 0);
}

/// An example that fails as it is typed teaches that failing is usual.
TEST(Help, TheExampleOfRunThatChangesAValuePassesAsTyped) {
  const Bench bench;
  const std::string help = bench.Call({"run", "--help"}).out;
  const std::size_t set = help.find(" --set ", help.find("Examples:"));
  ASSERT_NE(set, std::string::npos) << help;
  const std::size_t begin = help.rfind("dynoproof ", set) + 10;
  const std::string words = help.substr(begin, help.find('\n', set) - begin);
  const Outcome run = bench.Call({"-c", "'" + std::string(DYNOPROOF_PROGRAM) + "' " + words}, {.program = "bash"});
  EXPECT_EQ(run.exit, 0) << words << "\n" << run.Both();
}

TEST(NewScenario, PassesValidateAndRunAsItIs) {
  const Bench bench;
  ASSERT_EQ(bench.Call({"new", "scenario", "my_line"}).exit, 0);
  EXPECT_EQ(bench.Call({"validate", "my_line.toml"}).exit, 0);
  EXPECT_EQ(bench.Call({"modes", "my_line.toml"}).exit, 0);
  const Outcome run = bench.Call({"run", "my_line.toml"});
  EXPECT_EQ(run.exit, 0) << run.Both();
  EXPECT_TRUE(std::filesystem::exists(bench / "out/my_line.h5"));
  const std::string text = ReadBytes(bench / "my_line.toml");
  EXPECT_EQ(bench.Call({"new", "scenario", "my_line"}).exit, 2) << "never over somebody's work";
  EXPECT_EQ(ReadBytes(bench / "my_line.toml"), text);
}

TEST(Validate, AcceptsEveryShippedScenarioAndCountsFaults) {
  const Bench bench;
  const Outcome list = bench.Call({"list", "--json", "-"});
  ASSERT_EQ(list.exit, 0);
  std::vector<std::string> arguments = {"validate"};
  const nlohmann::json listed = nlohmann::json::parse(list.out);
  for (const nlohmann::json& scenario : listed["scenarios"]) arguments.push_back(scenario["id"]);
  ASSERT_GT(arguments.size(), 10u);
  EXPECT_EQ(bench.Call(arguments).exit, 0);
  bench.Write("wrong.toml", "[run]\nduration_s = -1\nperid_s = 1\n");
  const nlohmann::json document = bench.Json({"validate", "line.toml", "wrong.toml"});
  EXPECT_EQ(document["exit"], 2);
  EXPECT_EQ(document["files"][0]["valid"], true);
  EXPECT_EQ(document["files"][1]["valid"], false);
  EXPECT_EQ(document["files"][1]["diagnostics"][0]["line"], 2);
}

TEST(Run, DoesNotComputeAgainWhatItHasKept) {
  const Bench bench;
  const std::string kept = "out/kept/line.reference.h5";
  const nlohmann::json first = bench.Json({"run", "line.toml", "--kept", "out/kept"}).at("scenarios")[0];
  EXPECT_FALSE(first.contains("notes"));
  EXPECT_TRUE(std::filesystem::exists(bench / kept));
  const nlohmann::json second = bench.Json({"run", "line.toml", "--kept", "out/kept"}).at("scenarios")[0];
  EXPECT_THAT(second.at("notes").back(), "`reference` was not computed again: its samples are those of " + kept);
  EXPECT_EQ(second.at("checks"), first.at("checks"));
  EXPECT_EQ(second.at("figures"), first.at("figures"));
  const nlohmann::json other =
      bench.Json({"run", "line.toml", "--kept", "out/kept", "--set", "plant.inertia.I3=0.7"}).at("scenarios")[0];
  EXPECT_THAT(other.dump(), Not(HasSubstr("not computed again"))) << "another inertia is another run";
}

TEST(Run, TakesOverNothingInACiRun) {
  const Bench bench;
  const Outcome run =
      bench.Call({"run", "line.toml", "--kept", "kept"}, {.folder = {}, .environment = {{"CI", "true"}}});
  EXPECT_EQ(run.exit, 2) << run.Both();
  EXPECT_THAT(run.err, HasSubstr("--kept: error: is for a person"));
  EXPECT_FALSE(std::filesystem::exists(bench / "kept"));
}

}  // namespace
}  // namespace dynoproof::test
