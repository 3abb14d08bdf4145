// Golden data and records of a scenario of one's own: they lie beside it, whatever folder the program is called in, and
// the repository that is asked for cleanliness is the one that holds the scenario.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/project.h"

namespace dynoproof::test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// lines/mine.toml in a folder that has nothing to do with the program's own scenarios.
class OwnGolden : public Project {
 protected:
  void SetUp() override {
    bench_.Write("lines/mine.toml", std::string(Bench::kLine) + "\n[[check]]\nkind = \"golden\"\n");
  }
  void Commit() {
    Git("init -q .");
    Git("add -A");
    Git("commit -q -m start");
  }
  Outcome Run(const std::vector<std::string>& more = {}) { return Call("run", more); }
  Outcome Bless(std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--reason", "looked at it"});
    return Call("bless", more);
  }
  Outcome Call(const std::string& command, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {command, "lines/mine.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench_.Call(arguments, options_);
  }
  fs::path golden() const { return bench_ / "lines/mine.golden.h5"; }
  static bool InTheProgramsFolder(const std::string& name) {
    return fs::exists(fs::path("golden") / name);  // the tests run in the source folder
  }
};

TEST_F(OwnGolden, LiesBesideTheScenario) {
  Commit();
  const Outcome before = Run();
  EXPECT_EQ(before.exit, 1) << "no golden trace yet";
  EXPECT_THAT(before.out,
              AllOf(HasSubstr("lines/mine.golden.h5"), HasSubstr("dynoproof bless lines/mine.toml --reason TEXT")));
  const Outcome blessed = Bless();
  ASSERT_EQ(blessed.exit, 0) << blessed.Both();
  EXPECT_THAT(blessed.out, AllOf(HasSubstr("lines/mine.golden.h5"), HasSubstr("lines/mine.golden.toml")));
  EXPECT_TRUE(fs::exists(golden()) && fs::exists(bench_ / "lines/mine.golden.toml"));
  for (const char* name : {"mine.h5", "mine.toml", "mine.golden.h5"}) EXPECT_FALSE(InTheProgramsFolder(name)) << name;
  EXPECT_EQ(Run().exit, 0) << Run().Both();
  const Outcome elsewhere =
      bench_.Call({"run", (bench_ / "lines/mine.toml").string(), "--out", "out"}, {.folder = bench_ / "lines"});
  EXPECT_EQ(elsewhere.exit, 0) << elsewhere.Both();

  // What was changed in the file since then is named, as a change by --set is.
  const std::string as_blessed = ReadBytes(bench_ / "lines/mine.toml");
  std::string other = as_blessed;
  const std::size_t at = other.find("I3 = ");
  ASSERT_NE(at, std::string::npos);
  other.replace(at, other.find_first_of("\n,}", at) - at, "I3 = 0.4321");
  bench_.Write("lines/mine.toml", other);
  EXPECT_THAT(Run().out, HasSubstr("likely changed since it was blessed: plant.inertia.I3 = 0.4321 (was "));
  bench_.Write("lines/mine.toml", as_blessed);

  const Outcome changed = Run({"--set", "plant.inertia.I3=0.501", "--html", "report.html"});
  EXPECT_EQ(changed.exit, 1) << changed.Both();
  EXPECT_THAT(changed.out, HasSubstr("dynoproof compare out/mine.golden.h5 out/mine.h5 --tolerance "
                                     "lines/mine.golden.toml"));
  EXPECT_EQ(bench_.Call({"compare", "out/mine.golden.h5", "out/mine.h5", "--tolerance", "lines/mine.golden.toml"}).exit,
            1);
  EXPECT_THAT(ReadBytes(bench_ / "report.html"), HasSubstr("T_shaft leaves the tube around the golden trace"));
}

TEST_F(OwnGolden, IsAskedForByTheScenarioAndNotByChecksOfTheCommandLine) {
  Commit();
  ASSERT_EQ(Bless().exit, 0);
  const std::string others = R"(check=[{kind="solvers", signal="T_shaft", nrmse=1e-3, origin="goal"}])";
  EXPECT_EQ(Run({"--set", others}).exit, 0) << Run({"--set", others}).Both();
  bench_.Write("lines/mine.toml", Bench::kLine);
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 1) << run.Both();
  EXPECT_THAT(run.out, HasSubstr("no [[check]] with kind = \"golden\" compares"));
  EXPECT_EQ(Run({"--set", "plant.inertia.I3=0.501"}).exit, 1);
}

TEST_F(OwnGolden, IsNoScenarioOfItsFolder) {
  Commit();
  ASSERT_EQ(Bless().exit, 0);
  const nlohmann::json result = bench_.Json({"run", "lines"});
  EXPECT_EQ(result["exit"], 0) << result.dump(1);
  EXPECT_EQ(result["scenarios"].size(), 1u);
}

TEST_F(OwnGolden, IsKeptWhereTracesGoToItsOwnFolder) {
  Commit();
  ASSERT_EQ(Bless().exit, 0);
  const std::string kept = ReadBytes(golden());
  EXPECT_EQ(Run({"--out", "lines"}).exit, 0);
  EXPECT_TRUE(ReadBytes(golden()) == kept) << "a run that passes removes what an earlier failure left, not this";
  const Outcome changed = Run({"--out", "lines", "--set", "plant.inertia.I3=0.501"});
  EXPECT_EQ(changed.exit, 1);
  EXPECT_THAT(changed.out, HasSubstr("dynoproof compare lines/mine.golden.h5 lines/mine.h5"));
  EXPECT_TRUE(ReadBytes(golden()) == kept);
}

TEST_F(OwnGolden, MayStandInAFolderThatIsNamed) {
  Commit();
  const Outcome before = Run({"--golden", "kept"});
  EXPECT_EQ(before.exit, 1);
  EXPECT_THAT(before.out, AllOf(HasSubstr("kept/mine.golden.h5"),
                                HasSubstr("dynoproof bless lines/mine.toml --golden kept --reason TEXT")));
  ASSERT_EQ(Bless({"--golden", "kept"}).exit, 0);
  EXPECT_TRUE(fs::exists(bench_ / "kept/mine.golden.h5") && fs::exists(bench_ / "kept/mine.golden.toml"));
  EXPECT_FALSE(fs::exists(golden()));
  EXPECT_EQ(Run({"--golden", "kept"}).exit, 0);
  EXPECT_EQ(Run().exit, 1) << "there is none beside the scenario";
}

TEST_F(OwnGolden, AsksTheRepositoryThatHoldsTheScenario) {
  Commit();
  const std::string line = ReadBytes(bench_ / "lines/mine.toml");
  bench_.Write("lines/mine.toml", line + "# changed\n");
  const Outcome dirty = Bless();
  EXPECT_EQ(dirty.exit, 2) << dirty.Both();
  EXPECT_THAT(dirty.err, AllOf(HasSubstr("lines/mine.toml"), HasSubstr("commit them first")));
  EXPECT_FALSE(fs::exists(golden()));
  Git("commit -q -a -m changed");
  bench_.Write("line.toml", std::string(Bench::kLine) + "# changed as well\n");
  EXPECT_EQ(Bless().exit, 2) << "what else the repository tracks may be included";
  Git("checkout -q line.toml");
  const Outcome clean = Bless();
  EXPECT_EQ(clean.exit, 0) << clean.Both();
  Git("add -A");
  Git("commit -q -m golden");
  bench_.Write("lines/mine.golden.toml", ReadBytes(bench_ / "lines/mine.golden.toml") + "# looked at by hand\n");
  EXPECT_EQ(Bless().exit, 0) << "golden files may be changed themselves";

  bench_.Write("lines/new.toml", line);
  const Outcome untracked = bench_.Call({"bless", "lines/new.toml", "--reason", "r"}, options_);
  EXPECT_EQ(untracked.exit, 0) << untracked.Both();
  EXPECT_THAT(untracked.err, HasSubstr("git does not track lines/new.toml yet"));

  options_.environment["CI"] = "true";
  EXPECT_THAT(Bless().err, HasSubstr("CI"));
}

TEST_F(OwnGolden, OutsideAnyRepositoryIsTakenWithANote) {
  const Outcome blessed = Bless();
  ASSERT_EQ(blessed.exit, 0) << blessed.Both();
  EXPECT_THAT(blessed.err, HasSubstr("no git repository holds lines/mine.toml"));
  EXPECT_EQ(Run().exit, 0);
  // A repository that git cannot read is not taken for none.
  bench_.Write(".git", "nonsense\n");
  const Outcome unreadable = Bless();
  EXPECT_EQ(unreadable.exit, 2) << unreadable.Both();
  EXPECT_THAT(unreadable.err, HasSubstr("cannot ask git"));
}

TEST_F(OwnGolden, StandsBesideTheRecordOfTheScenario) {
  ASSERT_EQ(bench_.Call({"run", "line.toml"}).exit, 0);
  fs::copy_file(bench_ / "out/line.h5", bench_ / "lines/logged.h5");
  const Outcome sum = bench_.Call({"-c", "sha256sum lines/logged.h5 | cut -d' ' -f1 | tr -d '\\n'"}, {.program = "sh"});
  bench_.Write("lines/mine.toml", ReadBytes(bench_ / "lines/mine.toml") +
                                      "\n[record]\nfile = \"logged.h5\"\nhash = \"" + sum.out +
                                      "\"\nnrmse = { T_shaft = 0.01 }\n");
  Commit();
  ASSERT_EQ(Bless().exit, 0) << Bless().Both();
  const nlohmann::json elsewhere = bench_.Json({"run", "../lines/mine.toml"}, {.folder = bench_ / "out"});
  EXPECT_EQ(elsewhere["exit"], 0) << elsewhere.dump(1);
  EXPECT_THAT(elsewhere.dump(), HasSubstr("record T_shaft"));
  fs::remove(bench_ / "lines/logged.h5");
  const Outcome gone = Run();
  EXPECT_EQ(gone.exit, 1) << gone.Both();
  EXPECT_THAT(gone.out, HasSubstr("lines/logged.h5"));
}

}  // namespace
}  // namespace dynoproof::test
