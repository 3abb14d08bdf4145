// What a user meets whatever the command: the document of --json, suggestions, commands to paste, Ctrl-C.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Words = std::vector<std::string>;

/// The words of the command behind `label` in a text, as a shell splits them.
std::string CommandBehind(const std::string& text, const std::string& label) {
  const std::size_t begin = text.find(label + "dynoproof ");
  if (begin == std::string::npos) throw std::runtime_error("no \"" + label + "dynoproof\" in\n" + text);
  const std::size_t from = begin + label.size() + std::string("dynoproof ").size();
  return text.substr(from, text.find('\n', from) - from);
}

/// Pastes a command line into a shell.
Outcome Paste(const Bench& bench, const std::string& command) {
  return bench.Call({"-c", "'" + std::string(DYNOPROOF_PROGRAM) + "' " + command}, {.program = "bash"});
}

TEST(JsonAnswer, IsThereWhateverHappens) {
  const Bench bench;
  bench.Write("broken.toml", "title = \n");
  bench.Write("columns.csv", "t,a\n0,1\n0.1,2\n0.2,3\n");
  bench.Write("none.csv", "t,T_airgap\n0,1\n0.0001,2\n0.0002,3\n");
  bench.Write("campaign.toml", "title = \n");
  struct Case {
    Words words;
    int exit;
  };
  for (const Case& one :
       std::vector<Case>{{{"run", "nobody"}, 2},
                         {{"run", "broken.toml"}, 2},
                         {{"run", "line.toml", "--data", "columns.csv"}, 2},
                         {{"run", "line.toml", "--frobnicate"}, 2},
                         {{"run", "line.toml", "--jobs", "0"}, 2},
                         {{"rnu", "line.toml"}, 2},
                         {{}, 2},
                         {{"describe", "nobody"}, 2},
                         {{"describe", "line.toml"}, 0},
                         {{"list"}, 0},
                         {{"validate", "line.toml"}, 0},
                         {{"validate", "broken.toml"}, 2},
                         {{"modes", "broken.toml"}, 2},
                         {{"modes", "line.toml"}, 0},
                         {{"bless", "line.toml"}, 2},
                         {{"diagnose", "line.toml"}, 2},
                         {{"diagnose", "line.toml", "--data", "nobody.csv"}, 2},
                         {{"diagnose", "line.toml", "--data", "none.csv"}, 4},
                         {{"identify", "line.toml", "--data", "nobody.csv", "--free", "plant.inertia.I1"}, 2},
                         {{"identify", "line.toml", "--data", "none.csv", "--free", "plant.inertia.I1"}, 4},
                         {{"check-data", "nobody.csv"}, 2},
                         {{"compare", "a.h5", "b.h5"}, 2},
                         {{"coupling", "line.toml"}, 2},
                         {{"bench", "line.toml"}, 4},
                         {{"history", "show", "--db", "none.sqlite"}, 2},
                         {{"sweep", "campaign.toml"}, 2},
                         {{"new", "law", "Bad Name"}, 2},
                         {{"reproduce", "nobody"}, 2}}) {
    Words words = one.words;
    words.insert(words.end(), {"--json", "-"});
    const Outcome outcome = bench.Call(words);
    EXPECT_EQ(outcome.exit, one.exit) << ::testing::PrintToString(words) << outcome.Both();
    const nlohmann::json document = nlohmann::json::parse(outcome.out, nullptr, false);
    ASSERT_TRUE(document.is_object()) << ::testing::PrintToString(words) << outcome.Both();
    EXPECT_EQ(document.value("exit", -1), one.exit) << ::testing::PrintToString(words);
    ASSERT_TRUE(document.contains("diagnostics")) << document;
    if (one.exit == 0) continue;
    ASSERT_FALSE(document["diagnostics"].empty()) << ::testing::PrintToString(words) << outcome.Both();
    EXPECT_NE(document["diagnostics"][0]["message"], "");
    EXPECT_THAT(outcome.err, HasSubstr(document["diagnostics"][0]["message"].get<std::string>()))
        << "the same is said on stderr";
  }
}

TEST(JsonAnswer, IsThereWhenARunFailsUnexpectedly) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer needs all addresses";
#endif
  const Bench bench;
  // 100 GB are more than the test gives: no command foresees that.
  std::ofstream(bench / "huge.toml").put('t');
  std::filesystem::resize_file(bench / "huge.toml", 100'000'000'000);  // takes no room: it is all hole
  const std::string command = "ulimit -v 1000000; '" + std::string(DYNOPROOF_PROGRAM) + "' validate huge.toml --json -";
  const Outcome outcome = bench.Call({"-c", command}, {.program = "bash"});
  EXPECT_EQ(outcome.exit, 3) << outcome.Both();
  const nlohmann::json document = nlohmann::json::parse(outcome.out, nullptr, false);
  ASSERT_TRUE(document.is_object()) << outcome.Both();
  EXPECT_EQ(document["exit"], 3);
  EXPECT_FALSE(document["diagnostics"].empty());
}

TEST(JsonAnswer, HoldsPlaceAndHintOfAFault) {
  const Bench bench;
  std::string text = Bench::kLine;
  text.replace(text.find("damping_Nms"), 7, "dampng");
  bench.Write("wrong.toml", text);
  const nlohmann::json document = bench.Json({"run", "wrong.toml"});
  ASSERT_EQ(document["diagnostics"].size(), 1u) << document;
  const nlohmann::json& fault = document["diagnostics"][0];
  EXPECT_EQ(fault["severity"], "error");
  EXPECT_EQ(fault["file"], "wrong.toml");
  EXPECT_EQ(fault["line"], 18);
  EXPECT_THAT(fault["hint"].get<std::string>(), HasSubstr("damping_Nms_per_rad"));
}

TEST(JsonAnswer, OfASingleRunOfACampaign) {
  const Bench bench;
  bench.Write("campaign.toml", R"(title = "inertia"
scenario = "line.toml"

[[axis]]
key = "plant.inertia.I3"
list = [0.4, 0.6]

[figure.T_peak]
of = "T_shaft"
take = "peak"
at_most = 1e6
)");
  const nlohmann::json document = bench.Json({"sweep", "campaign.toml", "--run", "1"});
  EXPECT_EQ(document["run"], 1) << document;
  EXPECT_EQ(document["axes"]["plant.inertia.I3"], 0.6);
  EXPECT_EQ(document["verdict"], "pass");
  EXPECT_GT(document["figures"]["T_peak"]["value"], 0.0);
  EXPECT_EQ(document["exit"], 0);
}

TEST(Usage, SuggestsWhatWasMeant) {
  const Bench bench;
  for (const auto& [words, meant] :
       std::vector<std::pair<Words, std::string>>{{{"rnu", "line.toml"}, "\"run\""},
                                                  {{"chek-data", "a.csv"}, "\"check-data\""},
                                                  {{"run", "line.toml", "--jbos", "2"}, "\"--jobs\""},
                                                  {{"run", "line.toml", "--solvr=reference"}, "\"--solver\""},
                                                  {{"identify", "line.toml", "--dta", "a.csv"}, "\"--data\""},
                                                  {{"history", "shw"}, "\"show\""}}) {
    const Outcome outcome = bench.Call(words);
    EXPECT_EQ(outcome.exit, 2);
    EXPECT_THAT(outcome.err, HasSubstr("did you mean " + meant)) << ::testing::PrintToString(words);
  }
  EXPECT_THAT(bench.Call({"frobnicate"}).err, HasSubstr("commands: run, modes"));
}

TEST(Usage, TakesNoOptionForAValue) {
  const Bench bench;
  bench.Write("line.toml", Bench::kLine);
  for (const Words& words :
       std::vector<Words>{{"run", "line.toml", "--json", "--verbose"}, {"run", "line.toml", "--set", "--quiet"}}) {
    const Outcome outcome = bench.Call(words);
    EXPECT_EQ(outcome.exit, 2) << outcome.Both();
    EXPECT_THAT(outcome.err, HasSubstr(words[2] + ": a value is missing: " + words[3] + " is the next option"));
    EXPECT_FALSE(std::filesystem::exists(bench / words[3])) << "nobody wants a file of that name";
  }
}

TEST(Again, WorksWhenPasted) {
  const Bench bench;
  bench.Write("my lines/it's mine.toml", Bench::kLine);
  for (const Words& more : std::vector<Words>{{}, {"--solver", "reference"}, {"--set", "title=\"not as 'it' was\""}}) {
    Words words = {"run", "my lines/it's mine.toml", "--set", "check.0.nrmse=1e-30", "--set", "check.1.nrmse=1e-30"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome first = bench.Call(words);
    ASSERT_EQ(first.exit, 1) << first.Both();
    const Outcome pasted = Paste(bench, CommandBehind(first.out, "again  "));
    EXPECT_EQ(pasted.exit, 1) << pasted.Both();
    EXPECT_EQ(pasted.out, first.out);
  }
  // By id where that names the scenario.
  const Outcome known = bench.Call({"run", "r2r/soft_rotor_setup_1", "--set", "run.duration_s=0.01"});
  EXPECT_THAT(known.out, HasSubstr("again  dynoproof run r2r/soft_rotor_setup_1 --set run.duration_s=0.01\n"));
}

TEST(Again, OfACampaignWorksWhenPasted) {
  const Bench bench;
  bench.Write("two words.toml", R"(title = "inertia"
scenario = "line.toml"

[[axis]]
key = "input.T_airgap.source.amplitude"
list = [50.0]

[figure.T_peak]
of = "T_shaft"
take = "peak"
at_most = 1e-6
)");
  const Outcome swept = bench.Call({"sweep", "two words.toml", "--out", "some out"});
  const Outcome single = Paste(bench, CommandBehind(swept.out, "again: "));
  EXPECT_EQ(single.exit, 1) << swept.Both() << single.Both();
  const Outcome alone = Paste(bench, CommandBehind(single.out, "scenario: "));
  EXPECT_EQ(alone.exit, 0) << alone.Both() << "the limit is the campaign's, not the scenario's";
}

TEST(Run, InterruptedSaysWhatIsDone) {
  const Bench bench;
  bench.Write("a.toml", Bench::kLine);
  std::string text = Bench::kLine;
  text.replace(text.find("duration_s = 0.05"), 17, "duration_s = 1000.0\nsolver = \"reference\"");
  bench.Write("b.toml", text);
  std::thread killer([&] {
    const std::filesystem::path done = bench / "out/a.h5";
    for (int i = 0; i < 30000 && !std::filesystem::exists(done); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(500));  // its checks are made
    std::ifstream children("/proc/self/task/" + std::to_string(::getpid()) + "/children");
    pid_t child = 0;
    if (children >> child) ::kill(child, SIGINT);
  });
  const Outcome stopped = bench.Call({"run", "a.toml", "b.toml", "--json", "-", "--junit", "j.xml"});
  killer.join();
  ASSERT_EQ(stopped.exit, 4) << stopped.Both();
  EXPECT_THAT(stopped.err, HasSubstr("interrupted: 1 of 2 scenarios are done, their traces are in out/"));
  EXPECT_THAT(stopped.err, HasSubstr("not done: dynoproof run b.toml\n"));
  const nlohmann::json document = nlohmann::json::parse(stopped.out, nullptr, false);
  ASSERT_TRUE(document.is_object()) << stopped.Both();
  EXPECT_EQ(document["exit"], 4);
  ASSERT_EQ(document["scenarios"].size(), 1u);
  EXPECT_EQ(document["scenarios"][0]["id"], "a");
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(bench / "out")) files.push_back(entry.path().filename());
  EXPECT_EQ(files, std::vector<std::string>{"a.h5"}) << "nothing half-written";
  EXPECT_FALSE(std::filesystem::exists(bench / "j.xml"));
}

/// A text with a part of it replaced.
std::string Changed(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

const std::string kSolversCheck =
    "[[check]]\nkind = \"solvers\"\nsignal = \"T_shaft\"\nnrmse = 1e-6\norigin = \"discretisation\"\n";
/// line.toml, with bounds in place of its oracle, which knows linear lines alone.
const std::string kBounded =
    Changed(Bench::kLine,
            "kind = \"oracle\"\noracle = \"held_input_exponential\"\nsignal = \"T_shaft\"\nnrmse = 1e-9\norigin = "
            "\"round-off\"",
            "kind = \"bounded\"\nsignal = \"T_shaft\"\nbetween = [-1e6, 1e6]\norigin = \"wide\"");

TEST(Warnings, OfValidateAndRunAreTheSameAndNoFault) {
  const Bench bench;
  const std::string nonlinear = "law = \"phase_plane\"\nhalf_gap_rad = 0.001\nstiffness_Nm_per_rad = 2.5e5";
  const std::string play = Changed(kBounded, "stiffness_Nm_per_rad = 2.5e5", nonlinear);
  bench.Write("compared.toml", play);
  bench.Write("play.toml", Changed(play, kSolversCheck, ""));
  bench.Write("loose.toml", Changed(kBounded, "nrmse = 1e-6", "nrmse = 1e300"));
  bench.Write("fast.toml", Changed(kBounded, "end_Hz = 400.0", "end_Hz = 6000.0"));
  const std::string line = Bench::kLine;
  bench.Write("unchecked.toml", line.substr(0, line.find("[[check]]")));
  // Nonlinear by what the plant declares: friction, and an effect that puts it there.
  const std::string without = Changed(kBounded, kSolversCheck, "");
  bench.Write("friction.toml", without + "\n[plant.load.bearing]\non = \"I3\"\nlaw = \"coulomb\"\nT_c_Nm = 1.0\n");
  bench.Write("effect.toml", without +
                                 "\n[[effect]]\nname = \"coulomb_friction\"\nat = \"inertia:I3\"\n"
                                 "parameters = { T_c = 1.0 }\n");
  bench.Write("linear.toml", without);
  for (const auto& [file, says] : std::vector<std::pair<std::string, std::string>>{
           {"line.toml", ""},
           {"linear.toml", ""},
           {"compared.toml", ""},
           {"play.toml", "plant is nonlinear, and no check compares the solvers"},
           {"friction.toml", "plant is nonlinear, and no check compares the solvers"},
           {"effect.toml", "plant is nonlinear, and no check compares the solvers"},
           {"loose.toml", "nrmse = 1e+300 cannot fail"},
           {"fast.toml", "6000 Hz is above half the sampling rate (5000 Hz)"},
           {"unchecked.toml", "states no checks"}}) {
    const Outcome validate = bench.Call({"validate", file});
    EXPECT_EQ(validate.exit, 0) << file << validate.Both();
    const Outcome run = bench.Call({"run", file, "--set", "run.duration_s=0.01"});
    for (const Outcome* outcome : {&validate, &run}) {
      if (says.empty())
        EXPECT_THAT(outcome->err, Not(HasSubstr("warning"))) << file;
      else
        EXPECT_THAT(outcome->err, HasSubstr(says)) << file << outcome->Both();
    }
    const nlohmann::json document = bench.Json({"validate", file});
    ASSERT_EQ(document["diagnostics"].size(), says.empty() ? 0u : 1u) << document;
    for (const nlohmann::json& item : document["diagnostics"]) EXPECT_EQ(item["severity"], "warning");
  }
  EXPECT_EQ(bench.Call({"run", "unchecked.toml"}).exit, 1) << "nothing compared is no pass";
}

TEST(Warnings, AreNotGivenToShippedScenariosWithoutNeed) {
  const Bench bench;
  const nlohmann::json document = bench.Json({"validate", "r2r/", "heavy_duty/", "diagnose/", "suppression/"});
  EXPECT_EQ(document["exit"], 0);
  for (const nlohmann::json& item : document["diagnostics"]) ADD_FAILURE() << item;
}

TEST(Format, OfANewerProgramIsRefused) {
  const Bench bench;
  bench.Write("own.toml", std::string("format = 1\n") + Bench::kLine);
  EXPECT_EQ(bench.Call({"validate", "own.toml"}).exit, 0);
  EXPECT_EQ(bench.Call({"run", "own.toml"}).exit, 0);
  bench.Write("newer.toml", std::string("format = 2\nsurprise = 1\n") + Bench::kLine);
  bench.Write("includes.toml", "include = [\"newer.toml\"]\n");
  for (const Words& words : std::vector<Words>{{"run", "newer.toml"},
                                               {"validate", "newer.toml"},
                                               {"run", "includes.toml"},
                                               {"run", "own.toml", "--set", "format=2"}}) {
    const Outcome outcome = bench.Call(words);
    EXPECT_EQ(outcome.exit, 2) << outcome.Both();
    EXPECT_THAT(outcome.err, HasSubstr("is of format 2, this program reads formats up to 1"));
    EXPECT_THAT(outcome.err, HasSubstr("take a newer dynoproof"));
    EXPECT_THAT(outcome.err, Not(HasSubstr("surprise"))) << "what a newer format means is not guessed at";
  }
  for (const char* wrong : {"0", "1.0", "\"one\""}) {
    bench.Write("wrong.toml", "format = " + std::string(wrong) + "\n" + Bench::kLine);
    EXPECT_THAT(bench.Call({"validate", "wrong.toml"}).err, HasSubstr("is no version of the scenario format")) << wrong;
  }
}

}  // namespace
}  // namespace dynoproof::test
