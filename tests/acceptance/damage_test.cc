// What goes wrong around the program: no room, no right to write, a kill in the middle, golden files lost or damaged.
// Each time a clear error, the right exit code, and nothing lost that was there before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstdlib>

#include "tests/acceptance/spoil.h"
#include "tests/support/program.h"
#include "tests/support/project.h"
#include "trace/trace_io.h"

namespace dynoproof::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(OutputFolder, ThatCannotBeIsFoundBeforeAnythingRuns) {
  const Bench bench;
  bench.Write("file", "not a folder");
  for (const char* folder : {"/dev/null/out", "/proc/out", "file", "file/deeper"}) {
    const Outcome run = bench.Call({"run", "line.toml", "--out", folder});
    EXPECT_EQ(run.exit, 3) << folder << run.Both();
    EXPECT_THAT(run.err, HasSubstr(folder));
    EXPECT_EQ(run.out, "") << "nothing ran";
  }
  EXPECT_EQ(ReadBytes(bench / "file"), "not a folder");
}

TEST(OutputFolder, WithoutRightsIsFoundBeforeAnythingRuns) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  const Bench bench;
  fs::create_directories(bench / "out");
  fs::permissions(bench / "out", fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(bench.Call({"run", "line.toml"}).exit, 3);
  fs::permissions(bench / "out", fs::perms::owner_all);
}

TEST(OutputFile, ThatCannotBeWrittenIsAnExitOfThree) {
  const Bench bench;
  fs::create_directories(bench / "taken");
  for (const char* option : {"--json", "--junit", "--markdown"}) {
    const Outcome run = bench.Call({"run", "line.toml", option, "taken"});
    EXPECT_EQ(run.exit, 3) << option << run.Both();
    EXPECT_THAT(run.err, HasSubstr("taken"));
  }
  fs::create_directories(bench / "other/line.h5");
  const Outcome run = bench.Call({"run", "line.toml", "--out", "other"});
  EXPECT_EQ(run.exit, 3) << "a folder has the trace's name";
  EXPECT_THAT(run.Both(), HasSubstr("other/line.h5"));
}

TEST(FullDisk, LeavesNothingUnderTheFinalName) {
  const Bench bench;
  const Outcome run = bench.Call({"run", "line.toml"}, {.largest_file = 5000});
  EXPECT_EQ(run.exit, 3) << run.Both();
  EXPECT_THAT(run.out, HasSubstr("out/line.h5"));
  EXPECT_TRUE(fs::is_empty(bench / "out")) << "neither half a trace nor a temporary file";
}

TEST(FullDisk, KeepsTheTraceThatWasThere) {
  const Bench bench;
  ASSERT_EQ(bench.Call({"run", "line.toml"}).exit, 0);
  const std::string before = ReadBytes(bench / "out/line.h5");
  EXPECT_EQ(bench.Call({"run", "line.toml", "--set", "plant.inertia.I3=0.7"}, {.largest_file = 5000}).exit, 3);
  EXPECT_TRUE(ReadBytes(bench / "out/line.h5") == before);
}

TEST(Kill, InTheMiddleOfAWriteLosesNothing) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer must be loaded first";
#endif
  for (const char* call : {"fsync", "rename"}) {
    const Bench bench;
    ASSERT_EQ(bench.Call({"run", "line.toml"}).exit, 0);
    const std::string before = ReadBytes(bench / "out/line.h5");
    const CallOptions deadly{.environment = {{"LD_PRELOAD", DYNOPROOF_DIE_ON_LIBRARY}, {"DYNOPROOF_DIE_ON", call}}};
    const Outcome killed = bench.Call({"run", "line.toml", "--set", "plant.inertia.I3=0.7"}, deadly);
    ASSERT_EQ(killed.signal, SIGKILL) << call << killed.Both();
    EXPECT_TRUE(ReadBytes(bench / "out/line.h5") == before) << "the old trace is whole";
    const Outcome other = bench.Call({"run", "line.toml", "--out", "fresh"}, deadly);
    ASSERT_EQ(other.signal, SIGKILL);
    EXPECT_FALSE(fs::exists(bench / "fresh/line.h5")) << "no half trace under the final name";
    // What is left behind disturbs nobody.
    EXPECT_EQ(bench.Call({"run", "line.toml", "--out", "fresh"}).exit, 0);
    EXPECT_TRUE(trace::ReadTrace(bench / "fresh/line.h5").ok());
  }
}

TEST(ClosedPipe, IsAnErrorAndNoDeathWithoutAWord) {
  const Bench bench;
  const std::string command = "set -o pipefail; '" + std::string(DYNOPROOF_PROGRAM) +
                              "' list --json - 2>/dev/null | true; echo ${PIPESTATUS[0]}";
  const Outcome outcome = bench.Call({"-c", command}, {.program = "bash"});
  // 0: everything was written before the reader left; 3: it was not.
  EXPECT_THAT(outcome.out, ::testing::AnyOf("0\n", "3\n"));
}

/// With one blessed scenario.
class Golden : public Project {
 protected:
  void SetUp() override {
    bench_.Write("scenarios/line.toml", std::string(Bench::kLine) + "\n[[check]]\nkind = \"golden\"\n");
    Begin();
  }
  Outcome Bless(const std::vector<std::string>& more, const CallOptions& options) {
    std::vector<std::string> arguments = {"bless", "line"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench_.Call(arguments, options);
  }
  Outcome Run(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"run", "line"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench_.Call(arguments, options_);
  }
  fs::path golden() const { return bench_ / "golden/line.h5"; }
};

TEST_F(Golden, IsBlessedWithAReasonAndThenHolds) {
  const Outcome before = Run();
  EXPECT_EQ(before.exit, 1) << "no golden file yet";
  EXPECT_THAT(before.out, HasSubstr("dynoproof bless line"));
  const Outcome blessed = Bless({"--reason", "first trace"}, options_);
  ASSERT_EQ(blessed.exit, 0) << blessed.Both();
  const std::string words = ReadBytes(bench_ / "golden/line.toml");
  for (const char* word : {"first trace", "[provenance]", "commit = ", "compiler = ", "cpu = "})
    EXPECT_THAT(words, HasSubstr(word));
  EXPECT_LE(fs::file_size(golden()), 200'000u);
  const Outcome after = Run();
  EXPECT_EQ(after.exit, 0) << after.Both();
  EXPECT_EQ(Run({"--set", "plant.inertia.I3=0.5001"}).exit, 1) << "a changed model does not fit it";
}

TEST_F(Golden, IsNeverBlessedUnderCiWithoutReasonOrFromADirtyTree) {
  const auto refused = [this](const Outcome& outcome, const std::string& why) {
    EXPECT_EQ(outcome.exit, 2) << outcome.Both();
    EXPECT_THAT(outcome.err, HasSubstr(why));
    EXPECT_FALSE(fs::exists(golden()));
  };
  CallOptions ci = options_;
  ci.environment["CI"] = "true";
  refused(Bless({"--reason", "r"}, ci), "CI");
  refused(Bless({}, options_), "reason");
  refused(Bless({"--reason", "  "}, options_), "reason");
  bench_.Write("scenarios/line.toml", ReadBytes(bench_ / "scenarios/line.toml") + "# changed\n");
  refused(Bless({"--reason", "r"}, options_), "scenarios/line.toml");
  Git("commit -q -a -m changed");
  EXPECT_EQ(Bless({"--reason", "r"}, options_).exit, 0) << "committed, it may be";
}

TEST_F(Golden, MayBeDirtyItselfAndKeepsItsTolerances) {
  ASSERT_EQ(Bless({"--reason", "first"}, options_).exit, 0);
  Git("add -A");
  Git("commit -q -m golden");
  std::string text = ReadBytes(bench_ / "golden/line.toml");
  text += "# looked at by hand\n";
  const std::size_t at = text.find("[signal.T_shaft]");
  ASSERT_NE(at, std::string::npos);
  const std::size_t number = text.find("relative_width = ", at);
  text.replace(number, text.find('\n', number) - number, "relative_width = 3e-05");
  bench_.Write("golden/line.toml", text);
  const Outcome again = Bless({"--reason", "second"}, options_);
  ASSERT_EQ(again.exit, 0) << again.Both();
  EXPECT_THAT(ReadBytes(bench_ / "golden/line.toml"), HasSubstr("3e-05"));
  EXPECT_THAT(ReadBytes(bench_ / "golden/line.toml"), HasSubstr("second"));
}

TEST_F(Golden, WorksInAFolderWithAQuoteInItsName) {
  const fs::path odd = bench_ / "it's here";
  fs::create_directories(odd);
  for (const char* name : {"scenarios", "golden", "line.toml", ".git"}) fs::rename(bench_ / name, odd / name);
  options_.environment["DYNOPROOF_SCENARIOS"] = (odd / "scenarios").string();
  const Outcome blessed = Bless({"--reason", "r"}, options_);
  EXPECT_EQ(blessed.exit, 0) << blessed.Both();
}

TEST_F(Golden, IsNotBlessedWithoutGit) {
  fs::remove_all(bench_ / ".git");
  CallOptions alone = options_;
  alone.environment["GIT_CEILING_DIRECTORIES"] = bench_.path().parent_path().string();
  EXPECT_EQ(Bless({"--reason", "r"}, alone).exit, 2);
}

TEST_F(Golden, DeletedIsAFailureAndNoPass) {
  ASSERT_EQ(Bless({"--reason", "r"}, options_).exit, 0);
  fs::remove(golden());
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 1) << run.Both();
  EXPECT_THAT(run.out, HasSubstr("golden/line.h5"));
  EXPECT_TRUE(fs::exists(bench_ / "out/line.h5")) << "the trace is there to look at";
  ASSERT_EQ(Bless({"--reason", "again"}, options_).exit, 0);
  fs::remove(bench_ / "golden/line.toml");
  EXPECT_EQ(Run().exit, 1) << "tolerances without which nothing can be judged";
}

TEST_F(Golden, WithAnAddedNaNIsAFailure) {
  ASSERT_EQ(Bless({"--reason", "r"}, options_).exit, 0);
  SetValue(golden(), "/signals/T_shaft", 3, std::nan(""));
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 1) << run.Both();
  EXPECT_THAT(run.out, HasSubstr("T_shaft"));
}

TEST_F(Golden, WithoutASignalIsAFailure) {
  ASSERT_EQ(Bless({"--reason", "r"}, options_).exit, 0);
  Delete(golden(), "/signals/omega_1");
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 1) << run.Both();
  EXPECT_THAT(run.out, HasSubstr("no signal \"omega_1\""));
}

TEST_F(Golden, OfARunThatLostASignalIsAFailure) {
  ASSERT_EQ(Bless({"--reason", "r"}, options_).exit, 0);
  std::string text = ReadBytes(bench_ / "scenarios/line.toml");
  const std::size_t at = text.find("[output.omega_1]");
  text.erase(at, text.find("[analysis]") - at);
  bench_.Write("scenarios/line.toml", text);
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 1) << run.Both();
  EXPECT_THAT(run.out, HasSubstr("no signal \"omega_1\""));
}

TEST_F(Golden, OfARunThatIsShortIsAFailure) {
  ASSERT_EQ(Bless({"--reason", "r"}, options_).exit, 0);
  EXPECT_EQ(Run({"--set", "run.duration_s=0.04"}).exit, 1);
  EXPECT_EQ(Run({"--set", "run.duration_s=0.06"}).exit, 1);
}

TEST_F(Golden, LiesBesideTheTraceOfARunThatFallsShortOfIt) {
  ASSERT_EQ(Bless({"--reason", "r"}, options_).exit, 0);
  const Outcome run = Run({"--set", "plant.inertia.I3=0.501", "--html", "report.html"});
  EXPECT_EQ(run.exit, 1) << run.Both();
  const fs::path kept = bench_ / "out/line.golden.h5";
  ASSERT_TRUE(fs::exists(kept));
  EXPECT_TRUE(ReadBytes(kept) == ReadBytes(golden()));
  const std::string tolerances = (bench_ / "golden/line.toml").string();
  const std::string command = "dynoproof compare out/line.golden.h5 out/line.h5 --tolerance " + tolerances;
  EXPECT_THAT(run.out, HasSubstr(command));
  const std::string page = ReadBytes(bench_ / "report.html");
  for (const std::string text : {"T_shaft leaves the tube around the golden trace", command.c_str()}) {
    EXPECT_NE(page.find(text), std::string::npos) << text;
  }
  const Outcome compared =
      bench_.Call({"compare", "out/line.golden.h5", "out/line.h5", "--tolerance", tolerances}, options_);
  EXPECT_EQ(compared.exit, 1) << compared.Both();
  EXPECT_THAT(compared.out, HasSubstr("T_shaft"));
  EXPECT_EQ(Run().exit, 0);
  EXPECT_FALSE(fs::exists(kept)) << "nothing of an earlier failure stays";
}

TEST_F(Golden, CutShortIsAFailure) {
  ASSERT_EQ(Bless({"--reason", "r"}, options_).exit, 0);
  fs::resize_file(golden(), fs::file_size(golden()) / 2);
  EXPECT_EQ(Run().exit, 1);
}

TEST_F(Golden, FullDiskKeepsTheOldOne) {
  ASSERT_EQ(Bless({"--reason", "r"}, options_).exit, 0);
  const std::string before = ReadBytes(golden()), words = ReadBytes(bench_ / "golden/line.toml");
  CallOptions full = options_;
  full.largest_file = 500;
  EXPECT_EQ(Bless({"--reason", "other"}, full).exit, 3);
  EXPECT_TRUE(ReadBytes(golden()) == before);
  EXPECT_EQ(ReadBytes(bench_ / "golden/line.toml"), words);
}

}  // namespace
}  // namespace dynoproof::test
