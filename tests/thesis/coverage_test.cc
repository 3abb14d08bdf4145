// What of the thesis is here: the shipped rows hold what they say, and rows that do not are answered.
#include "thesis/coverage.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "experiment/golden.h"
#include "tests/support/registry.h"
#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

using ::testing::HasSubstr;

/// A ledger and an atlas of one entry each, that a row may name: Fig. 9.1 is drawn, Fig. 9.2 and Table 9.3 are claimed.
std::vector<Claim> Claims() {
  Claim good, against;
  good.id = "good";
  good.place = "Sec. 9.1, Fig. 9.2, Table 9.3";
  good.expect = "derived";
  against.id = "against";
  against.place = "(9.4)";
  against.expect = "contradicted";
  return {good, against};
}
std::vector<AtlasFigure> Figures(const std::string& missing = "") {
  AtlasFigure figure;
  figure.number = "9.1";
  figure.scenarios = {"backlash/clamped"};
  figure.missing = missing;
  return {figure};
}

std::string RowText(const std::string& name, const std::string& kind, const std::string& rest) {
  return fmt::format("[[row]]\nname = \"{}\"\nkind = \"{}\"\ntitle = \"t\"\n{}\n", name, kind, rest);
}
/// Rows for whatever the ledger and the atlas above are about.
std::string Sound() {
  return RowText("Fig. 9.1", "figure", "state = \"whole\"") + RowText("Fig. 9.2", "diagram", "state = \"whole\"") +
         RowText("Table 9.3", "table", "state = \"whole\"");
}

std::vector<CoverageRow> Read(const std::string& text, Diagnostics& diagnostics,
                              const std::vector<AtlasFigure>& figures = Figures()) {
  const test::TempDir folder;
  return ReadCoverage(folder.Write("coverage.toml", text), testing::FullRegistry(), figures, Claims(), diagnostics);
}
/// What the reader says of a row beside the sound ones.
std::string Answer(const std::string& rest) {
  Diagnostics diagnostics;
  Read(Sound() + RowText("play", "model", rest), diagnostics);
  return diagnostics.Format();
}

TEST(Coverage, TheShippedRowsHoldAndEveryFigureAndTableOfTheThesisHasOne) {
  Diagnostics diagnostics;
  const std::vector<Claim> claims = ReadLedger(GoldenFolder() + "/published.toml", diagnostics);
  const std::vector<AtlasFigure> figures = ReadFigures(GoldenFolder() + "/figures.toml", diagnostics);
  const std::vector<CoverageRow> rows =
      ReadCoverage(GoldenFolder() + "/coverage.toml", testing::FullRegistry(), figures, claims, diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.Format();
  std::set<std::string> wanted, there;
  const auto add = [&wanted](const std::string& kind, const std::string& chapter, int last) {
    for (int i = 1; i <= last; ++i) wanted.insert(fmt::format("{} {}.{}", kind, chapter, i));
  };
  // The last numbers in the thesis.
  for (const auto& [chapter, last] :
       {std::pair{"1", 1}, {"2", 34}, {"3", 10}, {"4", 10}, {"5", 29}, {"6", 10}, {"B", 2}, {"D", 1}, {"E", 1}}) {
    add("Fig.", chapter, last);
  }
  for (const auto& [chapter, last] : {std::pair{"2", 8}, {"4", 2}, {"A", 7}, {"B", 1}, {"C", 3}})
    add("Table", chapter, last);
  for (const CoverageRow& row : rows) {
    if (row.kind == "figure" || row.kind == "diagram" || row.kind == "table") there.insert(row.name);
    EXPECT_NE(row.state, "missing") << row.name;
  }
  EXPECT_EQ(there, wanted);
  const std::vector<int> all = CountStates(rows, "");
  EXPECT_EQ(std::accumulate(all.begin(), all.end(), 0), static_cast<int>(rows.size()));
}

TEST(Coverage, TheRowOfAFigureNamesItsScenariosAndClaims) {
  Diagnostics diagnostics;
  const std::vector<CoverageRow> rows = Read(Sound(), diagnostics);
  ASSERT_FALSE(diagnostics.has_errors()) << diagnostics.Format();
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].CoveredBy(), "scenario backlash/clamped; figure 9.1");
  EXPECT_EQ(rows[1].CoveredBy(), "claim good");
  EXPECT_EQ(rows[2].CoveredBy(), "claim good");
}

TEST(Coverage, ARowThatNamesWhatIsNotThereIsAnswered) {
  const std::string whole = "state = \"whole\"\n";
  EXPECT_THAT(Answer(whole + "scenarios = [\"no/such\"]"), HasSubstr("a scenario \"no/such\" that does not exist"));
  EXPECT_THAT(Answer(whole + "claims = [\"goood\"]"), HasSubstr("did you mean \"good\"?"));
  EXPECT_THAT(Answer(whole + "figures = [\"9.7\"]"), HasSubstr("a figure \"9.7\" that does not exist"));
  EXPECT_THAT(Answer(whole + "studies = [\"none\"]"), HasSubstr("a study \"none\" that does not exist"));
  EXPECT_THAT(Answer(whole + "plugins = [\"law.phase_plan\"]"), HasSubstr("did you mean \"law.phase_plane\"?"));
  EXPECT_EQ(Answer(whole + "claims = [\"good\"]\nfigures = [\"9.1\"]\nstudies = [\"zero_count\"]\n"
                           "plugins = [\"law.phase_plane\", \"effect.backlash\", \"check.contacts\"]"),
            "");
}

TEST(Coverage, ARowSaysWhyItIsNotWholeAndIsCalledNoMoreThanItRestsOn) {
  const std::string covered = "\nclaims = [\"good\"]", reason = "\nreason = \"why\"";
  for (const char* state : {"assumed", "partial", "not_given", "missing"})
    EXPECT_THAT(Answer(fmt::format("state = \"{}\"{}", state, covered)), HasSubstr("does not say why it is not whole"));
  EXPECT_THAT(Answer("state = \"whole\"" + covered + reason), HasSubstr("has a reason for being less than whole"));
  for (const char* state : {"not_given", "missing"}) {
    EXPECT_THAT(Answer(fmt::format("state = \"{}\"{}{}", state, covered, reason)), HasSubstr("names what covers it"));
    EXPECT_EQ(Answer(fmt::format("state = \"{}\"{}", state, reason)), "");
  }
  EXPECT_THAT(Answer("state = \"assumed\"" + reason), HasSubstr("names nothing that covers it"));
  const std::string against = "\nclaims = [\"against\"]";
  EXPECT_THAT(Answer("state = \"whole\"" + against), HasSubstr("which is contradicted"));
  EXPECT_THAT(Answer("state = \"assumed\"" + against + reason), HasSubstr("which is contradicted"));
  EXPECT_EQ(Answer("state = \"partial\"" + against + reason), "");
  Diagnostics diagnostics;
  Read(Sound(), diagnostics, Figures("the measured curve"));
  EXPECT_THAT(diagnostics.Format(), HasSubstr("figure 9.1, of which something is missing"));
}

TEST(Coverage, AFigureIsDrawnOrADiagramOrNotGiven) {
  const auto answer = [](const std::string& kind, const std::string& rest) {
    Diagnostics diagnostics;
    Read(Sound() + RowText("Fig. 9.4", kind, rest), diagnostics);
    return diagnostics.Format();
  };
  const std::string covered = "state = \"whole\"\nclaims = [\"good\"]";
  EXPECT_THAT(answer("figure", covered), HasSubstr("row \"Fig. 9.4\" (whole) is not drawn"));
  EXPECT_EQ(answer("diagram", covered), "");
  EXPECT_EQ(answer("figure", "state = \"not_given\"\nreason = \"a photograph\""), "");
}

TEST(Coverage, WhatIsDrawnOrClaimedHasARowAndNoneTwice) {
  for (const char* name : {"Fig. 9.1", "Fig. 9.2", "Table 9.3"}) {
    std::string text = Sound();
    const std::size_t at = text.find(name);
    text.replace(at, std::string(name).size(), "another");
    Diagnostics diagnostics;
    Read(text, diagnostics);
    EXPECT_THAT(diagnostics.Format(), HasSubstr(fmt::format("there is no row \"{}\"", name)));
  }
  Diagnostics diagnostics;
  Read(Sound() + RowText("Fig. 9.1", "figure", "state = \"whole\""), diagnostics);
  EXPECT_THAT(diagnostics.Format(), HasSubstr("a second row \"Fig. 9.1\""));
}

}  // namespace
}  // namespace dynoproof
