// What `run --html`, `reproduce --html` and --json leave behind, from outside: one page without a network, whose links
// lead somewhere, and a document that the published schema describes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "tests/support/json_schema.h"
#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

namespace fs = std::filesystem;
using ::testing::IsEmpty;

/// The page without what scripts and comments hold.
std::string Markup(const std::string& page) {
  std::string out;
  std::size_t at = 0;
  for (;;) {
    const std::size_t script = std::min(page.find("<script", at), page.find("<!--", at));
    if (script == std::string::npos) return out + page.substr(at);
    const bool comment = page.compare(script, 4, "<!--") == 0;
    const std::size_t begin = comment ? script : page.find('>', script) + 1;
    out += page.substr(at, begin - at);
    at = page.find(comment ? "-->" : "</script>", begin);
    if (at == std::string::npos) return out;
  }
}

/// Not a matcher: a failure would print the page.
bool Has(const std::string& page, const std::string& text) { return page.find(text) != std::string::npos; }

std::multiset<std::string> All(const std::string& text, const char* pattern) {
  std::multiset<std::string> found;
  const std::regex regex(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it) found.insert((*it)[1]);
  return found;
}

/// Every rule that a page of ours keeps.
void ExpectSound(const std::string& page) {
  const std::string markup = Markup(page);
  const std::multiset<std::string> ids = All(markup, " id=\"([^\"]*)\"");
  for (const std::string& id : ids) EXPECT_EQ(ids.count(id), 1u) << "id twice: " << id;
  for (const std::string& link : All(markup, " href=\"([^\"]*)\"")) {
    if (link == "data:,") continue;  // the icon, so that none is looked for
    ASSERT_TRUE(link.starts_with("#")) << link;
    EXPECT_EQ(ids.count(link.substr(1)), 1u) << "leads nowhere: " << link;
  }
  EXPECT_THAT(All(markup, " src=\"([^\"]*)\""), IsEmpty());
  EXPECT_THAT(All(page, "(url\\(|@import|fetch\\(|XMLHttpRequest|import\\()"), IsEmpty()) << "loads something";
  for (const std::string& set : All(markup, " data-set=\"([^\"]*)\"")) EXPECT_EQ(ids.count(set), 1u) << set;
  EXPECT_TRUE(Has(markup, "default-src 'none'")) << "the page forbids itself a network";
  for (const char* element : {"section", "details", "figure", "table", "div", "script", "p", "h2", "h3"}) {
    const std::string name = element;
    EXPECT_EQ(All(markup, ("(<" + name + "[ >])").c_str()).size(), All(markup, ("(</" + name + ">)").c_str()).size())
        << name << " is not closed";
  }
}

TEST(Report, HasEveryScenarioWithPicturesScoresAndSettings) {
  const Bench bench;
  bench.Write("short.toml", std::string(Bench::kLine));
  const Outcome run = bench.Call({"run", "line.toml", "short.toml", "--set", "check.1.nrmse=1e-30", "--html",
                                  "deep/report.html", "--json", "r.json"});
  EXPECT_EQ(run.exit, 1) << run.Both();
  const std::string page = ReadBytes(bench / "deep/report.html");
  ExpectSound(page);
  EXPECT_TRUE(Has(page, "<a href=\"#line\">line</a>")) << "<a href=\"#line\">line</a>";
  EXPECT_TRUE(Has(page, "id=\"short\" open")) << "id=\"short\" open";
  for (const char* text : {"three masses", "made up", "T_shaft", "held_input_exponential T_shaft", "round-off",
                           "Distances over their limits", "Amplitude response", "Poles and zeros", "plant.inertia.I2",
                           "line.toml:11", "run.realtime.substeps", "solver_summary"}) {
    EXPECT_TRUE(Has(page, text)) << text;
  }
  EXPECT_TRUE(Has(page, "T_shaft: run and held_input_exponential part"))
      << "T_shaft: run and held_input_exponential part"
      << ": "
      << "a failed comparison, close up";
  EXPECT_FALSE(Has(Markup(page), ">nan<")) << "numbers that are none are dashes";
}

TEST(Report, EscapesWhatAScenarioSays) {
  const Bench bench;
  std::string text = Bench::kLine;
  text.replace(text.find("three masses"), 12, "<script>alert(1)</script><b>");
  text.replace(text.find("made up"), 7, "</details>&<img src=x>");
  bench.Write("<i>evil.toml", text);
  const Outcome run = bench.Call({"run", "<i>evil.toml", "--html", "r.html"});
  EXPECT_EQ(run.exit, 0) << run.Both();
  const std::string page = ReadBytes(bench / "r.html");
  ExpectSound(page);
  for (const char* mark : {"<script>alert", "<img", "<i>evil", "</details>&"}) EXPECT_FALSE(Has(page, mark));
}

TEST(Report, IsWrittenWholeOrNotAtAllAndFoundOutEarly) {
  const Bench bench;
  bench.Write("file", "not a folder");
  fs::create_directories(bench / "taken");
  for (const char* file : {"file/r.html", "/proc/r.html/x.html", "taken"}) {
    const Outcome run = bench.Call({"run", "line.toml", "--html", file});
    EXPECT_EQ(run.exit, 3) << file << run.Both();
    EXPECT_EQ(run.out, "") << "nothing ran";
  }
  bench.Write("r.html", "the old one");
  EXPECT_EQ(bench.Call({"run", "line.toml", "--html", "r.html"}, {.largest_file = 60'000}).exit, 3);
  EXPECT_EQ(ReadBytes(bench / "r.html"), "the old one");
}

TEST(Report, OfThreeScenariosOfTheThesisIsSoundAndSmall) {
  const Bench bench;
  const Outcome run = bench.Call({"run", "heavy_duty/alternative_setup_1", "suppression/unsuppressed",
                                  "diagnose/coupling", "--jobs", "2", "--html", "r.html"});
  EXPECT_EQ(run.exit, 0) << run.Both();
  const std::string page = ReadBytes(bench / "r.html");
  ExpectSound(page);
  EXPECT_LT(page.size(), 12'000'000u);
  for (const char* title : {"Hull curve of T_shaft", "Amplitude response, chirp run and model", "Nyquist curve",
                            "Poles of the closed loop", "Stiffness of"}) {
    EXPECT_TRUE(Has(page, title)) << title;
  }
}

TEST(Report, AtlasHasTheClaimAndItsFigure) {
  const Bench bench;
  const Outcome run = bench.Call({"reproduce", "5.6.1-notch-1", "--html", "atlas.html"});
  EXPECT_EQ(run.exit, 0) << run.Both();
  const std::string page = ReadBytes(bench / "atlas.html");
  ExpectSound(page);
  for (const char* text : {"5.6.1-notch-1", "Fig. 5.19", "Chapter 5: Resonance suppression", "reproduced",
                           "What of the thesis is here", "proposed suppression in simulation"})
    EXPECT_TRUE(Has(page, text)) << text;
  EXPECT_FALSE(Has(page, "Fig. 3.6")) << "only what the claim needs";
  EXPECT_EQ(bench.Call({"reproduce", "5.6.1-notch-1", "--html", "/proc/x/atlas.html"}).exit, 3);
}

TEST(Json, IsWhatThePublishedSchemaDescribes) {
  const JsonSchema schema(nlohmann::json::parse(ReadBytes("reports/run.schema.json")));
  const Bench bench;
  bench.Write("short.toml", Bench::kLine);
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"run", "line.toml"},
           {"run", "line.toml", "short.toml", "--set", "check.1.nrmse=1e-30"},
           {"run", "line.toml", "--set", "run.reference.relative_tolerance=1e-2", "--set", "check=[]"}}) {
    const nlohmann::json document = bench.Json(arguments);
    EXPECT_THAT(schema.Faults(document), IsEmpty()) << document.dump(1);
  }
  // A schema that lets everything pass would prove nothing.
  nlohmann::json wrong = bench.Json({"run", "line.toml"});
  wrong["scenarios"][0]["verdict"] = "maybe";
  wrong["scenarios"][0]["checks"][0].erase("origin");
  wrong["surprise"] = 1;
  EXPECT_EQ(schema.Faults(wrong).size(), 3u);
}

}  // namespace
}  // namespace dynoproof::test
