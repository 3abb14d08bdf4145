// `dynoproof bless` of a scenario that extends another one: taken only with what it gains on a record that took no
// part, and where no other record is foretold worse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/noisy_record.h"
#include "tests/support/project.h"
#include "trace/csv_write.h"

namespace dynoproof::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr const char* kChanged = "plant.inertia.I3=0.65";  // 30 % more

/// scenarios/line.toml as drawn, and heavier.toml, which extends it by what the machine really has.
class Extension : public Project {
 protected:
  void SetUp() override {
    bench_.Write("scenarios/line.toml", std::string(Bench::kLine) + "\n[[check]]\nkind = \"golden\"\n");
    Extend("[]", "[[effect]]\nname = \"inertia_change\"\nat = \"inertia:I3\"\nparameters = { delta = 0.3 }\n");
    Begin();
    Record("changed.csv", {kChanged, "input.T_airgap.source.amplitude=80.0"}, 3);
    Record("drawn.csv", {}, 4);
  }
  void Extend(const std::string& set, const std::string& by) {
    bench_.Write("scenarios/heavier.toml",
                 "include = [\"line.toml\"]\nwithout = [\"check\"]\n\n[extension]\nof = "
                 "\"line\"\nset = " +
                     set + "\n\n" + by + kSolvers);
  }
  /// What a logger would have written of the line with these changes.
  void Record(const std::string& name, const std::vector<std::string>& changes, std::uint64_t seed) {
    std::vector<std::string> run = {"line.toml", "--set", "run.duration_s=0.3"};
    for (const std::string& change : changes) run.insert(run.end(), {"--set", change});
    columns_ = NoisyRecord(bench_, run, "out/line.h5", {"T_airgap"}, {"T_shaft", "omega_1"}, 0.01, seed);
    ASSERT_FALSE(trace::WriteCsv(bench_ / name, columns_));
  }
  Outcome Bless(const std::vector<std::string>& more, const std::string& id = "heavier") {
    std::vector<std::string> arguments = {"bless", id, "--reason", "the coupling's hub was left out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench_.Call(arguments, options_);
  }
  void ExpectRefused(const Outcome& outcome, const std::vector<std::string>& says) {
    EXPECT_EQ(outcome.exit, 2) << outcome.Both();
    for (const std::string& text : says) EXPECT_THAT(outcome.err, HasSubstr(text));
    EXPECT_FALSE(fs::exists(bench_ / "golden/heavier.h5"));
  }

  static constexpr const char* kSolvers =
      "\n[[check]]\nkind = \"solvers\"\nsignal = \"T_shaft\"\nnrmse = 1e-6\norigin = \"discretisation\"\n"
      "\n[[check]]\nkind = \"golden\"\n";
  std::vector<trace::Column> columns_;
};

TEST_F(Extension, NeedsAHoldout) {
  ExpectRefused(Bless({}), {"extends line", "--holdout FILE", "--record FILE"});
  ExpectRefused(Bless({"--record", "changed.csv"}), {"--holdout FILE"});
}

TEST_F(Extension, IsTakenWithWhatItGainsThere) {
  const Outcome blessed = Bless({"--holdout", "changed.csv"});
  ASSERT_EQ(blessed.exit, 0) << blessed.Both();
  EXPECT_THAT(blessed.out, HasSubstr("changed.csv"));
  EXPECT_THAT(blessed.out, HasSubstr("hold-out"));
  const std::string kept = ReadBytes(bench_ / "golden/heavier.toml");
  EXPECT_THAT(kept, HasSubstr("the coupling's hub was left out. NRMSE on the hold-out changed.csv: T_shaft from "));
  const nlohmann::json document =
      bench_.Json({"bless", "heavier", "--reason", "r", "--holdout", "changed.csv"}, options_);
  const nlohmann::json& gain = document["evidence"][0]["gain"]["T_shaft"];
  EXPECT_GT(gain["gain_ci95"][0], 0.0) << document.dump(1);
  EXPECT_LT(gain["nrmse_after"], 0.015);
  EXPECT_GT(gain["nrmse_before"], 0.1);
}

TEST_F(Extension, IsRefusedWhereItMakesAnotherRecordWorse) {
  ExpectRefused(Bless({"--holdout", "changed.csv", "--record", "drawn.csv"}),
                {"drawn.csv: T_shaft is foretold worse", "gain, 95 %"});
  Record("again.csv", {kChanged}, 5);
  EXPECT_EQ(Bless({"--holdout", "changed.csv", "--record", "again.csv"}).exit, 0) << "the same machine once more";
}

TEST_F(Extension, IsRefusedWhereItMakesTheScenariosOwnRecordWorse) {
  fs::copy_file(bench_ / "drawn.csv", bench_ / "scenarios/own.csv");
  const Outcome sum =
      bench_.Call({"-c", "sha256sum scenarios/own.csv | cut -d' ' -f1 | tr -d '\\n'"}, {.program = "sh"});
  bench_.Write("scenarios/line.toml",
               std::string(Bench::kLine) + "\n[record]\nfile = \"own.csv\"\nhash = \"" + sum.out + "\"\n");
  Git("commit -q -a -m record");
  ExpectRefused(Bless({"--holdout", "changed.csv"}), {"own.csv: T_shaft is foretold worse"});
}

TEST_F(Extension, IsRefusedWithAHoldoutOfTheMachineAsDrawn) {
  ExpectRefused(Bless({"--holdout", "drawn.csv"}), {"drawn.csv: T_shaft is foretold worse"});
}

TEST_F(Extension, IsHeldAgainstTheNominalModelAsItWasSet) {
  const std::string heavier = "[plant.inertia]\nI3 = 0.65\n";
  Extend("[\"plant.inertia.I3=0.65\"]", heavier);
  Git("commit -q -a -m nothing");
  ExpectRefused(Bless({"--holdout", "changed.csv"}), {"every interval includes zero"});
  Extend("[]", heavier);
  Git("commit -q -a -m something");
  EXPECT_EQ(Bless({"--holdout", "changed.csv"}).exit, 0);
}

TEST_F(Extension, IsRefusedWhereNothingIsCompared) {
  columns_.resize(2);  // time and input
  ASSERT_FALSE(trace::WriteCsv(bench_ / "input.csv", columns_));
  ExpectRefused(Bless({"--holdout", "input.csv"}), {"input.csv: nothing compared"});
  ExpectRefused(Bless({"--holdout", "changed.csv", "--record", "input.csv"}), {"input.csv: nothing compared"});
  ExpectRefused(Bless({"--holdout", "gone.csv"}), {"gone.csv"});
}

TEST_F(Extension, IsTheOnlyScenarioThatRecordsAreAskedOf) {
  const Outcome outcome = Bless({"--holdout", "changed.csv"}, "line");
  ExpectRefused(outcome, {"[extension]"});
  EXPECT_FALSE(fs::exists(bench_ / "golden/line.h5"));
  EXPECT_EQ(Bless({}, "line").exit, 0);
}

}  // namespace
}  // namespace dynoproof::test
