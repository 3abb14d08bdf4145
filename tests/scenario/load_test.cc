// Reading scenarios: includes, overrides, writing back, names.
#include "scenario/load.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>

#include "scenario/find.h"
#include "scenario/nesting.h"
#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

/// Equal trees: keys in the same order, values of the same kind and equal to the last bit.
bool Equal(const Value& a, const Value& b) {
  if (a.is_table() != b.is_table() || a.is_array() != b.is_array() || a.is_string() != b.is_string() ||
      a.is_bool() != b.is_bool() || a.is_integer() != b.is_integer() || a.is_number() != b.is_number()) {
    return false;
  }
  if (a.is_table()) {
    // The order of keys in a text is plain values first, then sections: only the set is kept.
    if (a.table().size() != b.table().size()) return false;
    for (const Value::Entry& entry : a.table()) {
      const Value* other = b.Find(entry.key);
      if (other == nullptr || !Equal(entry.value, *other)) return false;
    }
    return true;
  }
  if (a.is_array()) {
    if (a.array().size() != b.array().size()) return false;
    for (std::size_t i = 0; i < a.array().size(); ++i) {
      if (!Equal(a.array()[i], b.array()[i])) return false;
    }
    return true;
  }
  if (a.is_string()) return a.string() == b.string();
  if (a.is_bool()) return a.boolean() == b.boolean();
  if (a.is_integer()) return a.integer() == b.integer();
  return a.number() == b.number() && std::signbit(a.number()) == std::signbit(b.number());
}

/// The tree of a text, with overrides; fails the test when there is any fault.
Value Load(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const test::TempDir folder;
  Diagnostics diagnostics;
  std::optional<Plan> plan = LoadPlan(folder.Write("a.toml", text), overrides, diagnostics);
  EXPECT_EQ(diagnostics.Format(), "");
  return plan ? plan->root : Value();
}

TEST(Include, LaterFilesWinAndTheFileItselfWinsLast) {
  const test::TempDir folder;
  folder.Write("_one.toml", "[a]\nx = 1\ny = 1\nz = 1\nlist = [1, 1]\n");
  folder.Write("_two.toml", "[a]\ny = 2\nz = 2\nlist = [2]\n");
  Diagnostics diagnostics;
  const auto plan =
      LoadPlan(folder.Write("s.toml", "include = [\"_one.toml\", \"_two.toml\"]\n[a]\nz = 3\n"), {}, diagnostics);
  ASSERT_TRUE(plan) << diagnostics.Format();
  EXPECT_EQ(plan->root.FindPath("a.x")->integer(), 1);
  EXPECT_EQ(plan->root.FindPath("a.y")->integer(), 2);
  EXPECT_EQ(plan->root.FindPath("a.z")->integer(), 3);
  EXPECT_EQ(plan->root.FindPath("a.list")->array().size(), 1u) << "arrays are replaced, not joined";
  EXPECT_EQ(plan->root.Find("include"), nullptr);
}

TEST(Include, EffectsAndChecksAddUp) {
  const test::TempDir folder;
  folder.Write("_one.toml", "[[effect]]\nname = \"a\"\n[[check]]\nkind = \"x\"\n");
  folder.Write("_two.toml", "[[check]]\nkind = \"y\"\n");
  Diagnostics diagnostics;
  const auto plan = LoadPlan(
      folder.Write("s.toml", "include = [\"_one.toml\", \"_two.toml\"]\n[[effect]]\nname = \"b\"\n"), {}, diagnostics);
  ASSERT_TRUE(plan) << diagnostics.Format();
  ASSERT_EQ(plan->root.Find("effect")->array().size(), 2u);
  EXPECT_EQ(plan->root.FindPath("effect.0.name")->string(), "a");
  EXPECT_EQ(plan->root.FindPath("effect.1.name")->string(), "b");
  ASSERT_EQ(plan->root.Find("check")->array().size(), 2u);
  EXPECT_EQ(plan->root.FindPath("check.1.kind")->string(), "y");
}

TEST(Include, LeavesOutWhatTheFileDoesNotWant) {
  const test::TempDir dir;
  dir.Write("_base.toml", "[[check]]\nkind = \"a\"\n[[effect]]\nname = \"e\"\n");
  const std::string file =
      dir.Write("case.toml", "include = \"_base.toml\"\nwithout = [\"check\"]\n[[check]]\nkind = \"b\"\n");
  Diagnostics diagnostics;
  const std::optional<Plan> plan = LoadPlan(file, {}, diagnostics);
  ASSERT_TRUE(plan) << diagnostics.Format();
  ASSERT_EQ(plan->root.Find("check")->array().size(), 1U);
  EXPECT_EQ(plan->root.Find("check")->array()[0].Find("kind")->string(), "b");
  EXPECT_EQ(plan->root.Find("effect")->array().size(), 1U);
  EXPECT_EQ(plan->root.Find("without"), nullptr);
  const std::string wrong = dir.Write("wrong.toml", "include = \"_base.toml\"\nwithout = [\"chekc\"]\n");
  EXPECT_FALSE(LoadPlan(wrong, {}, diagnostics));
  EXPECT_NE(diagnostics.Format().find("wrong.toml:2"), std::string::npos) << diagnostics.Format();
}

TEST(Include, IsRelativeToTheFileThatNamesIt) {
  const test::TempDir folder;
  std::filesystem::create_directories(folder / "deep/er");
  folder.Write("_top.toml", "v = 1\n");
  folder.Write("deep/_mid.toml", "include = \"../_top.toml\"\n");
  Diagnostics diagnostics;
  const auto plan = LoadPlan(folder.Write("deep/er/s.toml", "include = \"../_mid.toml\"\n"), {}, diagnostics);
  ASSERT_TRUE(plan) << diagnostics.Format();
  EXPECT_EQ(plan->root.Find("v")->integer(), 1);
  EXPECT_TRUE(plan->root.Find("v")->where().file.ends_with("_top.toml")) << "a value knows which file it stands in";
}

TEST(Include, OfOneFileTwiceIsNoCircle) {
  const test::TempDir folder;
  folder.Write("_base.toml", "v = 1\n");
  folder.Write("_a.toml", "include = \"_base.toml\"\n");
  folder.Write("_b.toml", "include = \"_base.toml\"\n");
  Diagnostics diagnostics;
  EXPECT_TRUE(LoadPlan(folder.Write("s.toml", "include = [\"_a.toml\", \"_b.toml\"]\n"), {}, diagnostics))
      << diagnostics.Format();
}

TEST(Include, ThatDoublesAtEachLevelIsRefusedByName) {
  const test::TempDir folder;
  folder.Write("_0.toml", "v = 1\n");
  for (int k = 1; k <= 30; ++k) {
    const std::string below = "\"_" + std::to_string(k - 1) + ".toml\"";
    folder.Write("_" + std::to_string(k) + ".toml", "include = [" + below + ", " + below + "]\n");
  }
  Diagnostics diagnostics;
  EXPECT_FALSE(LoadPlan((folder / "_30.toml").string(), {}, diagnostics));
  EXPECT_NE(diagnostics.Format().find("includes take in more than 1000 files"), std::string::npos);
  EXPECT_EQ(diagnostics.error_count(), 1) << diagnostics.Format();
}

/// The diagnostics of reading a scenario text; empty: it has no fault.
std::string FaultsOf(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const test::TempDir folder;
  Diagnostics diagnostics;
  LoadPlan(folder.Write("a.toml", text), overrides, diagnostics);
  return diagnostics.Format();
}

std::string Repeated(const std::string& text, int count) {
  std::string out;
  for (int k = 0; k < count; ++k) out += text;
  return out;
}

TEST(Nesting, IsRefusedWhereItIsDeepHoweverItIsWritten) {
  constexpr int kDeep = 30'000;
  const std::string key = Repeated("a.", kDeep) + "a";
  for (const std::string& text : {key + " = 1", "[" + key + "]", "[[" + key + "]]", "v = { " + key + " = 1 }",
                                  Repeated("\"=\" . ", kDeep) + "a = 1", Repeated("'\"'.", kDeep) + "a = 1",
                                  "v = " + Repeated("[", kDeep) + Repeated("]", kDeep),
                                  "v = " + Repeated("{" + Repeated("a.", 90) + "a = ", 200) + "1" + Repeated("}", 200),
                                  "t = \"\"\"\"\"\"\nb = '''a'''\n" + key + " = 1"}) {
    const std::string faults = FaultsOf("x = 1\n" + text + "\n");
    EXPECT_NE(faults.find("lie in one another"), std::string::npos) << text.substr(0, 60);
    EXPECT_NE(faults.find(text.starts_with("t") ? "a.toml:4" : "a.toml:2"), std::string::npos) << text.substr(0, 60);
  }
  EXPECT_NE(FaultsOf("x = 1\n", {key + "=1"}).find("lie in one another"), std::string::npos);
  EXPECT_NE(FaultsOf("x = 1\n", {"x={" + key + "=1}"}).find("lie in one another"), std::string::npos);
}

// A scenario of 52 levels by points was read, but what was written of it was not: braces counted twice.
TEST(Nesting, IsTheSameInEachNotation) {
  for (const int levels : {52, kMostLevels, kMostLevels + 1}) {
    const std::string dotted = Repeated("a.", levels - 2) + "a = [1]", nested = Repeated("a = { ", levels - 2);
    for (const std::string& text :
         {dotted, nested + "a = [1]" + Repeated(" }", levels - 2), "[" + Repeated("a.", levels - 3) + "a]\na = [1]",
          "a = " + Repeated("[", levels - 1) + "1" + Repeated("]", levels - 1)}) {
      const test::TempDir folder;
      Diagnostics diagnostics;
      const auto plan = LoadPlan(folder.Write("a.toml", text + "\n"), {}, diagnostics);
      ASSERT_EQ(plan.has_value(), levels <= kMostLevels) << levels << " levels of\n" << text << diagnostics.Format();
      if (!plan) {
        EXPECT_NE(diagnostics.Format().find("more than 100 tables and lists"), std::string::npos);
        continue;
      }
      const std::string written = ToToml(plan->root);
      const auto back = LoadPlan(folder.Write("b.toml", written), {}, diagnostics);
      ASSERT_TRUE(back) << written << diagnostics.Format();
      EXPECT_EQ(ToToml(back->root), written);
    }
    const bool refused = FaultsOf("x = 1\n", {Repeated("y.", levels - 1) + "y=1"}).find("lie in") != std::string::npos;
    EXPECT_EQ(refused, levels > kMostLevels);
  }
}

TEST(Nesting, IsNotCountedInTextsCommentsAndSideBySide) {
  const std::string points = Repeated("a.", 200), numbers = Repeated("1.5, ", 500);
  Load("# " + points + "\nt = \"" + points + "\"\nu = '" + points + "'\nw = \"\"\"\n" + points + "[[[\n" + points +
       "\\\"\"\"\"\nv = [ " + numbers + "\n# [\n 1.5 ]\n" + Repeated("[[effect]]\nn = { a.b.c = [ 1 ] }\n", 200));
}

TEST(Messages, HoldNothingThatATerminalObeys) {
  Diagnostics diagnostics;
  const std::string name = "\x1b[2J\a\x7f\xc2\x9b\xe2\x80\xae\xef\xbb\xbf";
  const SourceSpan where{"a" + name + ".toml", 1, 1, 1};
  diagnostics.AddSource(where.file, "k = \"" + name + "\" # \xc2\xb5\xe2\x82\xac\t\r\n");
  diagnostics.Error(where, "\"" + name + "\" is unknown", "not " + name);
  const std::string shown = diagnostics.Format();
  for (const char* const raw : {"\x1b", "\a", "\x7f", "\xc2\x9b", "\xe2\x80\xae", "\xef\xbb\xbf", "\r"})
    EXPECT_EQ(shown.find(raw), std::string::npos) << shown;
  EXPECT_NE(shown.find("\"\\x1b[2J\\x07\\x7f\\x9b\\u202e\\ufeff\" is unknown"), std::string::npos) << shown;
  EXPECT_NE(shown.find("\xc2\xb5\xe2\x82\xac\t\n"), std::string::npos) << "letters stay as they are";
}

// "output.a" and, in a line of its own, "other.toml:1:1: error: forged: ..." was the message of such a key.
TEST(Messages, AreNotWrittenByKeys) {
  for (const char* const key : {"a\\nother.toml:1:1: error: forged", "a\\tb", "\\u0000", "\\u001b[2J", "\\u202e"}) {
    Diagnostics diagnostics;
    const test::TempDir folder;
    const std::string text = std::string("[output.\"") + key + "\"]\nof = \"plant.x\"\n";
    LoadPlan(folder.Write("a.toml", text).string(), {}, diagnostics);
    ASSERT_TRUE(diagnostics.has_errors()) << key;
    EXPECT_NE(diagnostics.items()[0].message.find("has control characters"), std::string::npos) << key;
    EXPECT_EQ(diagnostics.items()[0].message.find('\n'), std::string::npos) << key;
  }
  Diagnostics diagnostics;
  const test::TempDir folder;
  LoadPlan(folder.Write("a.toml", "[output]\n").string(), {"output.a\nforged=1"}, diagnostics);
  EXPECT_TRUE(diagnostics.has_errors());
  Diagnostics none;
  LoadPlan(folder.Write("b.toml", "[output.\"caf\u00e9 b\"]\n").string(), {}, none);
  EXPECT_EQ(none.Format(), "");
}

TEST(Messages, AreNotWrittenByTexts) {
  Diagnostics diagnostics;
  const test::TempDir folder;
  const std::string forged = "x\\nother.toml:1:1: error: forged";
  LoadPlan(folder.Write("a.toml", "include = [\"" + forged + "\"]\n").string(), {}, diagnostics);
  const SourceSpan where{"a\nother.toml:1:1: error: forged", 1, 1, 1};
  diagnostics.Error(where, "seen\nother.toml:1:1: error: forged", "hint\nother.toml:1:1: error: forged");
  const std::string shown = diagnostics.Format();
  EXPECT_NE(shown.find("other.toml:1:1: error: forged"), std::string::npos) << "it is told all the same";
  EXPECT_EQ(shown.find("\nother.toml"), std::string::npos) << shown;
}

TEST(Override, KeepsTheKindOfTheOldValue) {
  const Value root = Load("x = 2.0\nn = 3\nword = \"a\"\nflag = true\n", {"x=5", "n=7", "word=b c", "flag=false"});
  EXPECT_FALSE(root.Find("x")->is_integer()) << "2 for 2.0 is a number with a fraction";
  EXPECT_EQ(root.Find("x")->number(), 5.0);
  EXPECT_TRUE(root.Find("n")->is_integer());
  EXPECT_EQ(root.Find("word")->string(), "b c") << "a bare word is a text";
  EXPECT_FALSE(root.Find("flag")->boolean());
}

TEST(Override, ReachesIntoArraysAndTablesInThem) {
  const Value root =
      Load("list = [1.0, 2.0]\n[[check]]\nlimit = 1\n[[check]]\nlimit = 2\n", {"list.1=9", "check.1.limit=5"});
  EXPECT_EQ(root.FindPath("list.0")->number(), 1.0);
  EXPECT_EQ(root.FindPath("list.1")->number(), 9.0);
  EXPECT_EQ(root.FindPath("check.0.limit")->integer(), 1);
  EXPECT_EQ(root.FindPath("check.1.limit")->integer(), 5);
}

TEST(Override, MakesNewKeysAndSections) {
  const Value root =
      Load("[run]\nduration_s = 1.0\n", {"run.seed=4", "run.realtime.substeps=8", "list=[1, 2]", "t={ a = 1 }"});
  EXPECT_EQ(root.FindPath("run.seed")->integer(), 4);
  EXPECT_EQ(root.FindPath("run.realtime.substeps")->integer(), 8);
  EXPECT_EQ(root.FindPath("list")->array().size(), 2u);
  EXPECT_EQ(root.FindPath("t.a")->integer(), 1);
  EXPECT_EQ(root.FindPath("run.duration_s")->number(), 1.0) << "what stood there stays";
}

TEST(Override, ActsInTheOrderGivenAndKnowsItsPlace) {
  const Value root = Load("x = 1\n", {"x=2", "x=3", "t={ a = 1, b = [4, 5] }"});
  EXPECT_EQ(root.Find("x")->integer(), 3);
  EXPECT_EQ(root.Find("x")->where().file, "--set");
  EXPECT_EQ(root.Find("x")->where().line, 2);
  EXPECT_EQ(root.Find("x")->where().column, 3);
  // t={ a = 1, b = [4, 5] }: the 1 in column 9, the 5 in column 20.
  EXPECT_EQ(root.FindPath("t.a")->where().column, 9);
  EXPECT_EQ(root.FindPath("t.b.1")->where().column, 20);
  EXPECT_EQ(root.FindPath("t.b.1")->where().line, 3);
}

TEST(ToToml, GivesBackEveryShippedScenario) {
  Diagnostics diagnostics;
  const std::vector<std::string> files = FindScenarios("", diagnostics);
  ASSERT_FALSE(files.empty());
  for (const std::string& file : files) {
    const auto plan = LoadPlan(file, {}, diagnostics);
    ASSERT_TRUE(plan) << file << diagnostics.Format();
    const Value again = Load(ToToml(plan->root));
    EXPECT_TRUE(Equal(plan->root, again)) << file << "\n" << ToToml(plan->root);
    EXPECT_EQ(ToToml(again), ToToml(plan->root)) << file << ": written twice, it differs";
  }
}

TEST(ToToml, GivesBackAwkwardValues) {
  Value root;
  root["text"] = Value("a \"quote\", a \\ and\na tab\t, \x01 and caf\xC3\xA9");
  root["key with blanks and a \"quote\""] = Value(1);
  root["empty"] = Value("");
  root["whole"] = Value(3.0);
  root["tiny"] = Value(std::numeric_limits<double>::denorm_min());
  root["huge"] = Value(std::numeric_limits<double>::max());
  root["tenth"] = Value(0.1);
  root["minus_zero"] = Value(-0.0);
  root["large_whole"] = Value(1e22);
  root["infinite"] = Value(std::numeric_limits<double>::infinity());
  root["most"] = Value(std::numeric_limits<std::int64_t>::max());
  root["none"] = Value(Value::Array{});
  root["mixed"] = Value(Value::Array{Value(1), Value("two"), Value(Value::Array{Value(3.5)}), Value{{"four", 4}}});
  root["section"]["deep"]["deeper"]["deepest"] = Value(true);
  root["section"]["blank"] = Value();
  root["list"] = Value(Value::Array{Value{{"a", 1}}, Value{{"b", Value{{"c", 2}}}}});
  EXPECT_TRUE(Equal(root, Load(ToToml(root)))) << ToToml(root);
}

TEST(ToToml, GivesBackRandomNumbersToTheLastBit) {
  Value::Array numbers;
  std::uint64_t bits = 1;
  for (int i = 0; i < 2000; ++i) {
    bits = bits * 6364136223846793005u + 1442695040888963407u;  // Knuth's MMIX generator: every exponent turns up
    double number;
    std::memcpy(&number, &bits, sizeof number);
    if (std::isfinite(number)) numbers.emplace_back(number);
  }
  Value root;
  root["x"] = Value(numbers);
  EXPECT_TRUE(Equal(root, Load(ToToml(root))));
}

TEST(ParseTomlValue, TakesWhatIsNoValueAsText) {
  EXPECT_EQ(ParseTomlValue("3.5").number(), 3.5);
  EXPECT_TRUE(ParseTomlValue("3").is_integer());
  EXPECT_EQ(ParseTomlValue("reference").string(), "reference");
  EXPECT_EQ(ParseTomlValue("").string(), "");
  EXPECT_EQ(ParseTomlValue("1\ny = 2").string(), "1\ny = 2") << "a value cannot smuggle in a second key";
}

/// Points $DYNOPROOF_SCENARIOS at a folder for one test.
class Scenarios : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "scenarios/line");
    folder_.Write("scenarios/line/one.toml", "title = \"1\"\n");
    folder_.Write("scenarios/line/two.toml", "title = \"2\"\n");
    folder_.Write("scenarios/line/_part.toml", "");
    folder_.Write("scenarios/line/notes.txt", "");
    folder_.Write("scenarios/top.toml", "");
    ::setenv("DYNOPROOF_SCENARIOS", (folder_ / "scenarios").c_str(), 1);
  }
  void TearDown() override { ::unsetenv("DYNOPROOF_SCENARIOS"); }

  std::vector<std::string> Ids(const std::string& name) {
    std::vector<std::string> ids;
    for (const std::string& file : FindScenarios(name, diagnostics_)) ids.push_back(ScenarioId(file));
    return ids;
  }

  test::TempDir folder_;
  Diagnostics diagnostics_;
};

TEST_F(Scenarios, AreFoundByIdFolderAndFile) {
  using List = std::vector<std::string>;
  EXPECT_EQ(Ids(""), (List{"line/one", "line/two", "top"}));
  EXPECT_EQ(Ids("line/"), (List{"line/one", "line/two"}));
  EXPECT_EQ(Ids("line"), (List{"line/one", "line/two"}));
  EXPECT_EQ(Ids("line/two"), (List{"line/two"}));
  EXPECT_EQ(Ids((folder_ / "scenarios/line/one.toml").string()), (List{"line/one"}));
  EXPECT_FALSE(diagnostics_.has_errors());
}

TEST_F(Scenarios, ElsewhereHaveTheirStemAsId) {
  EXPECT_EQ(Ids(folder_.Write("mine.toml", "").string()), std::vector<std::string>{"mine"});
}

TEST_F(Scenarios, OfAMistypedIdAreSuggested) {
  EXPECT_TRUE(Ids("line/tow").empty());
  EXPECT_EQ(diagnostics_.Format(),
            "line/tow: error: there is no such scenario, file or folder\n"
            "        did you mean \"line/two\"?\n");
}

TEST_F(Scenarios, OfAnEmptyFolderAreAFault) {
  std::filesystem::create_directories(folder_ / "scenarios/nothing");
  EXPECT_TRUE(Ids("nothing").empty());
  EXPECT_TRUE(diagnostics_.has_errors()) << "a run of nothing must not pass";
}

}  // namespace
}  // namespace dynoproof
