// Campaigns as a user runs them: one table whatever the workers, nothing lost whatever happens.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <regex>
#include <sstream>
#include <thread>

#include "tests/acceptance/spoil.h"
#include "tests/support/program.h"
#include "trace/trace_io.h"

namespace dynoproof::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kCampaign = R"(title = "a line with uncertain inertia"
scenario = "line.toml"
samples = 12
sampling = "latin_hypercube"
seed = 7

[[axis]]
key = "plant.inertia.I3"
uniform = [0.8, 1.2]
relative = true

[[axis]]
key = "input.T_airgap.source.amplitude"
grid = [50.0, 100.0]
count = 3

[figure.T_peak]
of = "T_shaft"
take = "peak"
at_most = 60.0

[figure.omega_last]
of = "omega_1"
take = "last"

[rate.too_high]
hits = "fail"
by = "input.T_airgap.source.amplitude"
)";

class Campaign : public ::testing::Test {
 protected:
  Campaign() { bench_.Write("spread.toml", kCampaign); }

  /// Cells of a line of the table.
  static std::vector<std::string> Cells(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream words(line);
    for (std::string cell; std::getline(words, cell, ',');) cells.push_back(cell);
    return cells;
  }
  std::vector<std::vector<std::string>> Table(const std::string& out = "out", const std::string& id = "spread") const {
    std::istringstream lines(ReadBytes(bench_ / out / id / "table.csv"));
    std::vector<std::vector<std::string>> table;
    for (std::string line; std::getline(lines, line);) table.push_back(Cells(line));
    return table;
  }
  void ExpectSameTables(const std::string& a, const std::string& b, const std::string& id = "spread") const {
    for (const char* file : {"table.csv", "table.h5"}) {
      const std::string one = ReadBytes(bench_ / a / id / file);
      EXPECT_FALSE(one.empty()) << file;
      EXPECT_TRUE(one == ReadBytes(bench_ / b / id / file)) << file;
    }
  }
  /// Starts the program and sends a signal once `files` pieces are stored.
  Outcome Interrupted(const std::vector<std::string>& arguments, int signal, int files) {
    const fs::path rows = bench_ / "out/spread/rows";
    std::thread killer;
    const pid_t me = ::getpid();
    killer = std::thread([&] {
      for (int i = 0; i < 3000; ++i) {
        std::error_code error;
        int there = 0;
        for (fs::directory_iterator it(rows, error), end; !error && it != end; it.increment(error)) ++there;
        if (there >= files) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
      ::kill(ChildOf(me), signal);
    });
    const Outcome outcome = bench_.Call(arguments);
    killer.join();
    return outcome;
  }
  static pid_t ChildOf(pid_t parent) {
    std::istringstream list(
        ReadBytes("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) + "/children"));
    pid_t child = 0;
    list >> child;
    return child > 0 ? child : parent;
  }

  Bench bench_;
};

TEST_F(Campaign, GivesOneTableWhateverTheNumberOfWorkers) {
  const Outcome one = bench_.Call({"sweep", "spread.toml", "--jobs", "1", "--out", "one"});
  ASSERT_EQ(one.exit, 1) << one.Both() << "some runs are above the limit";
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml", "--jobs", "3", "--out", "three"}).exit, 1);
  ExpectSameTables("one", "three");
  const auto table = Table("one");
  ASSERT_EQ(table.size(), 37u);
  EXPECT_THAT(table[0],
              ::testing::ElementsAre("run", "seed", "\"plant.inertia.I3\"", "\"input.T_airgap.source.amplitude\"",
                                     "\"T_peak\"", "\"omega_last\"", "verdict", "why"));
  std::vector<int> strata(12);
  for (int run = 0; run < 36; ++run) {
    const auto& row = table[static_cast<std::size_t>(run) + 1];
    EXPECT_EQ(row[0], std::to_string(run));
    EXPECT_EQ(std::stod(row[3]), 50.0 + 25.0 * (run / 12)) << "samples of one point of the grid stand together";
    EXPECT_EQ(row[2], table[static_cast<std::size_t>(run % 12) + 1][2]) << "the same draws at each point";
    if (run < 12) ++strata[static_cast<std::size_t>((std::stod(row[2]) / 0.5 - 0.8) / 0.4 * 12.0)];
    EXPECT_EQ(row[6], std::stod(row[4]) > 60.0 ? "fail" : "pass");
  }
  EXPECT_THAT(strata, ::testing::Each(1)) << "a Latin hypercube has one sample in each stratum";
}

TEST_F(Campaign, WhoseRunsAllPassNamesTheOneClosestToItsLimit) {
  std::string text = kCampaign;
  text.replace(text.find("60.0"), 4, "1000.0");
  bench_.Write("spread.toml", text);
  const Outcome sweep = bench_.Call({"sweep", "spread.toml", "--html", "page.html", "--json", "s.json"});
  ASSERT_EQ(sweep.exit, 0) << sweep.Both();
  const nlohmann::json peak = nlohmann::json::parse(ReadBytes(bench_ / "s.json"))["figures"]["T_peak"];
  const std::string run = "closest to its limit: run " + peak["largest_run"].dump() + ", T_peak is ";
  EXPECT_THAT(sweep.out, HasSubstr("all passed; " + run));
  const std::string page = ReadBytes(bench_ / "page.html");
  EXPECT_THAT(page, HasSubstr("All runs passed"));
  EXPECT_THAT(page, HasSubstr("C" + run.substr(1)));
  EXPECT_THAT(page, Not(HasSubstr(">pass<"))) << "no run that passed is listed as one of the worst";
}

/// The same where checks judge, not limits of figures.
TEST_F(Campaign, WhoseChecksAllPassNamesTheOneClosestToItsLimit) {
  std::string text = kCampaign;
  text.erase(text.find("at_most"), std::string("at_most = 60.0\n").size());
  bench_.Write("spread.toml", "checks = [\"oracle\"]\n" + text);
  const Outcome sweep = bench_.Call({"sweep", "spread.toml"});
  ASSERT_EQ(sweep.exit, 0) << sweep.Both();
  EXPECT_THAT(sweep.out, ::testing::ContainsRegex("all passed; closest to its limit: run [0-9]+, [^\n]*T_shaft: "));
}

TEST_F(Campaign, ARowIsWhatRunGivesForTheSameValues) {
  bench_.Write("alone.toml", std::string("batch = \"never\"\n") + kCampaign);
  ASSERT_EQ(bench_.Call({"sweep", "alone.toml"}).exit, 1);
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml"}).exit, 1);
  const auto alone = Table("out", "alone"), together = Table();
  ASSERT_EQ(alone.size(), together.size());
  bool differ = false;
  for (std::size_t i = 1; i < alone.size(); ++i) {
    for (const std::size_t figure : {4u, 5u}) {
      const double one = std::stod(alone[i][figure]), other = std::stod(together[i][figure]);
      EXPECT_NEAR(one, other, 1e-12 * std::abs(one)) << "round-off: two exact methods, 500 steps";
      differ = differ || one != other;
    }
  }
  EXPECT_TRUE(differ) << "batches are not made at all";
  const auto row = alone[21];
  const std::string seed = row[1];
  bench_.Call({"run", "line.toml", "--set", "plant.inertia.I3=" + row[2], "--set",
               "input.T_airgap.source.amplitude=" + row[3], "--set", "run.seed=" + seed});
  const auto trace = trace::ReadTrace(bench_ / "out/line.h5");
  ASSERT_TRUE(trace.ok());
  double peak = 0.0;
  for (const double value : trace->Find("T_shaft")->values) peak = std::max(peak, std::abs(value));
  EXPECT_EQ(std::stod(row[4]), peak);
  EXPECT_EQ(std::stod(row[5]), trace->Find("omega_1")->values.back());
  const Outcome again = bench_.Call({"sweep", "alone.toml", "--run", "20"});
  EXPECT_THAT(again.out, HasSubstr(row[4]));
  EXPECT_THAT(again.out, HasSubstr("dynoproof run"));
}

TEST_F(Campaign, SummaryAndHdf5SayTheSameAsTheRows) {
  const nlohmann::json summary = bench_.Json({"sweep", "spread.toml", "--html", "page.html"});
  const std::string page = ReadBytes(bench_ / "page.html");
  // The worst failing run stands first, with how to see it.
  const std::string command = "dynoproof sweep spread.toml --run ";
  EXPECT_EQ(page.find(command), page.find(command + summary["figures"]["T_peak"]["largest_run"].dump() + "<"));
  EXPECT_THAT(page, HasSubstr("T_peak over plant.inertia.I3"));
  const auto table = Table();
  std::vector<double> peaks;
  int failing = 0;
  for (std::size_t i = 1; i < table.size(); ++i) {
    peaks.push_back(std::stod(table[i][4]));
    failing += table[i][6] == "fail" ? 1 : 0;
  }
  Spoil(bench_ / "out/spread/table.h5", [&](hid_t file) {
    EXPECT_EQ(Numbers(file, "/figures/T_peak"), peaks);
    EXPECT_EQ(Numbers(file, "/axes/plant.inertia.I3").size(), 36u);
  });
  std::sort(peaks.begin(), peaks.end());
  EXPECT_EQ(summary["exit"], 1);
  EXPECT_EQ(summary["runs"], 36);
  EXPECT_EQ(summary["failing"]["hits"], failing);
  const nlohmann::json& figure = summary["figures"]["T_peak"];
  EXPECT_DOUBLE_EQ(figure["quantiles"]["0.5"].get<double>(), 0.5 * (peaks[17] + peaks[18]));
  EXPECT_EQ(figure["quantiles"]["1"].get<double>(), peaks.back());
  // Binomial(36, 1/2): 12 or fewer below the median happens in 3.3 % of cases, 11 or fewer in 1.4 %: ranks 12 and 25.
  EXPECT_EQ(figure["median_ci95"][0].get<double>(), peaks[11]);
  EXPECT_EQ(figure["median_ci95"][1].get<double>(), peaks[24]);
  EXPECT_GT(figure["rank_correlation"]["input.T_airgap.source.amplitude"].get<double>(), 0.9);
  EXPECT_EQ(summary["rates"]["too_high"]["groups"].size(), 3u);
  EXPECT_EQ(summary["rates"]["too_high"]["all"]["hits"], failing);
}

TEST_F(Campaign, WhatIsWrongIsSaidBeforeAnythingRuns) {
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& why) {
    std::string text = kCampaign;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    bench_.Write("wrong.toml", text);
    const Outcome outcome = bench_.Call({"sweep", "wrong.toml"});
    EXPECT_EQ(outcome.exit, 2) << to << outcome.Both();
    EXPECT_THAT(outcome.err, HasSubstr(why)) << to;
    EXPECT_THAT(outcome.err, HasSubstr("wrong.toml")) << to;
    EXPECT_FALSE(fs::exists(bench_ / "out/wrong")) << to;
  };
  refused("samples = 12", "samples = 0", "has no runs");
  refused("plant.inertia.I3", "plant.inertia.J3", "axis plant.inertia.J3");
  refused("plant.inertia.I3", "plant.inertia=.I3", "has a \"=\"");
  refused("uniform = [0.8, 1.2]", "uniform = [1.2, 0.8]", "the range is empty");
  refused("uniform = [0.8, 1.2]", "uniform = [-0.2, 1.2]", "narrow the axis");
  refused("uniform = [0.8, 1.2]", "list = []", "0 ways");
  refused("uniform = [0.8, 1.2]", "uniform = [0.8, 1.2]\nspread = 1", "spread");
  refused("of = \"T_shaft\"", "of = \"T_shat\"", "did you mean \"T_shaft\"?");
  refused("take = \"peak\"", "take = \"peek\"", "peak");
  refused("line.toml", "lime.toml", "no such scenario");
  refused("hits = \"fail\"", "hits = \"fails\"", "did you mean \"fail\"?");
}

TEST_F(Campaign, KeepsTheTracesThatAreAskedFor) {
  bench_.Write("spread.toml", std::string("keep_traces = \"failing\"\n") + kCampaign);
  bench_.Call({"sweep", "spread.toml"});
  const auto table = Table();
  for (std::size_t i = 1; i < table.size(); ++i) {
    const std::string digits = std::to_string(i - 1);
    const fs::path file = bench_ / ("out/spread/traces/run_" + std::string(9 - digits.size(), '0') + digits + ".h5");
    EXPECT_EQ(fs::exists(file), table[i][6] == "fail") << file;
    EXPECT_EQ(trace::ReadTrace(file).ok(), table[i][6] == "fail") << file;
  }
}

TEST_F(Campaign, WhatNothingJudgesIsUndecided) {
  std::string text = kCampaign;
  text.erase(text.find("at_most = 60.0"), 14);
  bench_.Write("spread.toml", text);
  EXPECT_EQ(bench_.Call({"sweep", "spread.toml"}).exit, 4);
  bench_.Write("checked.toml", "checks = [\"oracle\"]\n" + text);
  EXPECT_EQ(bench_.Call({"sweep", "checked.toml"}).exit, 0);
}

TEST_F(Campaign, ShowsRateAndTimeLeftOnATerminalOnly) {
  EXPECT_THAT(bench_.Call({"sweep", "spread.toml"}).err, Not(HasSubstr("a second")));
  const Outcome seen = bench_.Call({"sweep", "spread.toml", "--out", "seen"}, {.terminal = true});
  EXPECT_THAT(seen.out, HasSubstr("a second"));
  EXPECT_THAT(seen.out, HasSubstr(" left"));
}

// A piece takes five seconds or so of work: a longer run makes several of them.
constexpr const char* kLong = "set = [\"run.duration_s=10.0\"]\n";

TEST_F(Campaign, InterruptedGoesOnWhereItWas) {
  bench_.Write("spread.toml", std::string(kLong) + kCampaign);
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml", "--out", "whole"}).exit, 1);
  const Outcome stopped = Interrupted({"sweep", "spread.toml", "--jobs", "2"}, SIGINT, 2);
  ASSERT_EQ(stopped.exit, 4) << stopped.Both();
  EXPECT_THAT(stopped.err, HasSubstr("--resume"));
  EXPECT_FALSE(fs::exists(bench_ / "out/spread/table.csv"));
  EXPECT_EQ(bench_.Call({"sweep", "spread.toml"}).exit, 2) << "what is there is not made again by mistake";
  const Outcome rest = bench_.Call({"sweep", "spread.toml", "--resume"});
  ASSERT_EQ(rest.exit, 1) << rest.Both();
  EXPECT_THAT(rest.err, Not(HasSubstr("36 runs in"))) << "only what was missing";
  ExpectSameTables("whole", "out");
}

TEST_F(Campaign, KilledGoesOnWhereItWas) {
  bench_.Write("spread.toml", std::string(kLong) + kCampaign);
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml", "--out", "whole"}).exit, 1);
  const Outcome killed = Interrupted({"sweep", "spread.toml", "--jobs", "2"}, SIGKILL, 2);
  ASSERT_EQ(killed.signal, SIGKILL) << killed.Both();
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml", "--resume"}).exit, 1);
  ExpectSameTables("whole", "out");
}

TEST_F(Campaign, KilledWhileItWritesGoesOnWhereItWas) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer must be loaded first";
#endif
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml", "--out", "whole"}).exit, 1);
  for (const char* call : {"fsync", "rename"}) {
    const CallOptions deadly{.environment = {{"LD_PRELOAD", DYNOPROOF_DIE_ON_LIBRARY}, {"DYNOPROOF_DIE_ON", call}}};
    ASSERT_EQ(bench_.Call({"sweep", "spread.toml", "--resume"}, deadly).signal, SIGKILL);
  }
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml", "--resume"}).exit, 1);
  ExpectSameTables("whole", "out");
}

TEST_F(Campaign, AFullDiskStopsItAndLosesNothing) {
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml", "--out", "whole"}).exit, 1);
  // Room for small pieces, not for the table.
  const Outcome full = bench_.Call({"sweep", "spread.toml"}, {.largest_file = 2500});
  EXPECT_EQ(full.exit, 3) << full.Both();
  EXPECT_THAT(full.err, HasSubstr("out/spread/"));
  EXPECT_FALSE(fs::exists(bench_ / "out/spread/table.csv") && fs::exists(bench_ / "out/spread/table.h5"));
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml", "--resume"}).exit, 1);
  ExpectSameTables("whole", "out");
  // A trace that does not fit stops the campaign: it is no property of the run.
  bench_.Write("traces.toml", std::string("keep_traces = \"all\"\n") + kCampaign);
  const Outcome traces = bench_.Call({"sweep", "traces.toml"}, {.largest_file = 2500});
  EXPECT_EQ(traces.exit, 3) << traces.Both();
  EXPECT_THAT(traces.err, HasSubstr("--resume"));
}

TEST_F(Campaign, RefusesRowsOfAnotherCampaign) {
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml"}).exit, 1);
  bench_.Write("line.toml", std::string(Bench::kLine) + "# changed in words only\n");
  EXPECT_EQ(bench_.Call({"sweep", "spread.toml", "--resume"}).exit, 1);
  std::string text = Bench::kLine;
  text.replace(text.find("I1 = 2.0"), 8, "I1 = 2.1");
  bench_.Write("line.toml", text);
  const Outcome other = bench_.Call({"sweep", "spread.toml", "--resume"});
  EXPECT_EQ(other.exit, 2) << other.Both();
  EXPECT_THAT(other.err, HasSubstr("another campaign"));
}

TEST_F(Campaign, FindsDamagedAndContradictingRows) {
  ASSERT_EQ(bench_.Call({"sweep", "spread.toml"}).exit, 1);
  // All pieces in one, as a second copy of a task with another cut would leave it.
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(bench_ / "out/spread/rows")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string header, lines;
  for (const fs::path& file : files) {
    const std::string text = ReadBytes(file);
    header = text.substr(0, text.find('\n') + 1);
    lines += text.substr(header.size());
  }
  const char* const copy = "out/spread/rows/000000000-000000036.jsonl";
  bench_.Write(copy, header + lines);
  const Outcome by_hand = bench_.Call({"sweep", "spread.toml", "--resume"});
  EXPECT_EQ(by_hand.exit, 2) << by_hand.Both();
  EXPECT_THAT(by_hand.err, HasSubstr("holds other rows than were written"));
  // An earlier version's has no fingerprint.
  header = std::regex_replace(header, std::regex(R"("fingerprint":"[0-9a-f]*",)"), "");
  bench_.Write(copy, header + lines);
  EXPECT_EQ(bench_.Call({"sweep", "spread.toml", "--resume"}).exit, 1) << "harmless while it says the same";
  std::string otherwise = lines;
  const std::size_t digit = otherwise.find('.') + 1;
  otherwise[digit] = otherwise[digit] == '1' ? '2' : '1';
  bench_.Write(copy, header + otherwise);
  const Outcome contradiction = bench_.Call({"sweep", "spread.toml", "--resume"});
  EXPECT_EQ(contradiction.exit, 3) << contradiction.Both();
  EXPECT_THAT(contradiction.err, HasSubstr("run 0 came out differently"));
  bench_.Write(copy, header + lines.substr(0, lines.find('\n', lines.size() / 2) + 1));
  const Outcome cut = bench_.Call({"sweep", "spread.toml", "--resume"});
  EXPECT_EQ(cut.exit, 2) << cut.Both();
  EXPECT_THAT(cut.err, HasSubstr("cut short"));
  for (const char* wrong : {"\"cpu\":5", "\"campaign\":5"}) {  // members of another type
    const std::string key = std::string(wrong).substr(0, std::string(wrong).size() - 1);
    const std::size_t at = header.find(key) + key.size(), end = header.find_first_of(",}", at);
    bench_.Write(copy, header.substr(0, at) + "5" + header.substr(end) + lines);
    const Outcome damaged = bench_.Call({"sweep", "spread.toml", "--resume"});
    EXPECT_EQ(damaged.exit, 2) << damaged.Both();
    EXPECT_THAT(damaged.err, Not(HasSubstr("unexpected"))) << wrong;
  }
}

TEST_F(Campaign, FileAndFolderMayHaveAnyName) {
  bench_.Write("gr\xfcn.toml", kCampaign);  // Latin-1
  const std::string folder = (bench_ / "bl\xe5").string();
  const Outcome outcome = bench_.Call({"sweep", "gr\xfcn.toml", "--out", folder, "--json", folder + "/all.json"});
  EXPECT_EQ(outcome.exit, 1) << outcome.Both();
  for (const char* file : {"/all.json", "/gr\xfcn/summary.json"})
    EXPECT_TRUE(nlohmann::json::accept(ReadBytes(folder + file))) << file;
}

/// A campaign over what the stumbling plugin does.
TEST(CampaignOfCrashes, EachIsARowAndNotTheEnd) {
  const Bench bench;
  std::string text = Bench::kLine;
  const std::size_t source = text.find("source = { type");
  text.replace(source, text.find('\n', source) - source, "source = { type = \"stumble\", stumble = 0 }");
  text.erase(text.find("[[check]]"));
  bench.Write("line.toml", text);
  bench.Write("crash.toml", R"(title = "crashes"
scenario = "line.toml"
most_seconds = 2.0
[[axis]]
key = "input.T_airgap.source.stumble"
list = [0, 1, 0, 2, 3, 4, 5, 0]
[figure.T_peak]
of = "T_shaft"
take = "peak"
at_most = 60.0
)");
  const nlohmann::json result = bench.Json({"sweep", "crash.toml", "--plugin", DYNOPROOF_STUMBLE_PLUGIN});
  EXPECT_EQ(result["exit"], 3);
  EXPECT_EQ(result["verdicts"]["broken"], 5);
  EXPECT_EQ(result["verdicts"]["pass"], 3);
  const std::string table = ReadBytes(bench / "out/crash/table.csv");
  for (const char* why : {"signal 6", "signal 11", "stumbled", "not a finite number", "took longer than 2 s"})
    EXPECT_THAT(table, HasSubstr(why));
}

TEST(CampaignOfAProgram, TakesWhatItPrintsAndSurvivesItsFailures) {
  const Bench bench;
  bench.Write("program.toml", R"(title = "a shell"
command = ["sh", "-c", "echo work > {folder}/log; echo hello; [ {x} != 2 ] && echo '{\"twice\": '$(({x} * 2))'}'"]
[[axis]]
key = "x"
list = [1, 2, 3]
[figure.y]
from = "twice"
at_most = 5
)");
  const nlohmann::json result = bench.Json({"sweep", "program.toml", "--jobs", "2"});
  EXPECT_EQ(result["exit"], 3);
  EXPECT_EQ(result["verdicts"]["pass"], 1);
  EXPECT_EQ(result["verdicts"]["fail"], 1);
  EXPECT_EQ(result["verdicts"]["broken"], 1);
  EXPECT_EQ(result["figures"]["y"]["quantiles"]["1"], 6.0);
  EXPECT_EQ(ReadBytes(bench / "out/program/work/run_000000002/log"), "work\n");
}

TEST(CampaignOfAProgram, FindsNumbersAndTextsByTheirPath) {
  const Bench bench;
  bench.Write("program.toml", R"(title = "a shell"
command = ["sh", "-c", "printf '{\n\"verdict\": \"found\",\n\"gain\": {\"T_1\": {\"after\": {x}}},\n\"list\": [{\"a\": 7}]\n}\n'"]
[[axis]]
key = "x"
list = [3]
[figure.found]
from = "verdict.found"
at_least = 1
[figure.other]
from = "verdict.nothing"
[figure.after]
from = "gain.T_1.after"
[figure.first]
from = "list.0.a"
)");
  const nlohmann::json result = bench.Json({"sweep", "program.toml"});
  EXPECT_EQ(result["exit"], 0) << result.dump(1);
  for (const auto& [name, value] :
       {std::pair("found", 1.0), std::pair("other", 0.0), std::pair("after", 3.0), std::pair("first", 7.0)})
    EXPECT_EQ(result["figures"][name]["quantiles"]["1"], value) << name;
}

TEST(CampaignOfADiagnosis, ExplainsEachRecordAndVariesTheModel) {
  const Bench bench;
  ASSERT_EQ(bench.Call({"run", "line.toml"}).exit, 0);
  bench.Write("explain.toml", R"(title = "one record against two models"
diagnose = "line.toml"
data = ["{record}"]
[[axis]]
key = "record"
list = ["out/line.h5"]
[[axis]]
key = "plant.inertia.I3"
list = [0.5, 0.65]
[figure.simulations]
from = "simulations"
at_least = 1
[figure.found]
from = "verdict.effect_found"
)");
  const nlohmann::json result = bench.Json({"sweep", "explain.toml", "--jobs", "1"});
  EXPECT_EQ(result["verdicts"]["broken"], 0) << result.dump(1);
  EXPECT_EQ(result["verdicts"]["pass"], 2);
  EXPECT_EQ(result["figures"]["found"]["quantiles"]["0"], 0.0) << "the record's own model explains it";
  EXPECT_EQ(result["figures"]["found"]["quantiles"]["1"], 1.0) << "without noise, down to rounding";
  EXPECT_THAT(bench.Call({"sweep", "explain.toml", "--out", "again", "--run", "1"}).Both(),
              HasSubstr("--set plant.inertia.I3=0.65"));
  const std::string extended = ReadBytes(bench / "out/explain/work/run_000000001/extended.toml");
  EXPECT_THAT(extended, HasSubstr("I3 = 0.65  # by --set"));
  EXPECT_EQ(bench.Call({"validate", "out/explain/work/run_000000001/extended.toml"}).exit, 0);
  bench.Write("none.toml", "title = \"no record\"\ndiagnose = \"line.toml\"\n[figure.a]\nfrom = \"simulations\"\n");
  EXPECT_EQ(bench.Call({"sweep", "none.toml"}).exit, 2);
}

}  // namespace
}  // namespace dynoproof::test
