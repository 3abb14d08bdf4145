// Texts from outside never become markup, and what the program embeds is what stands in the folder.
#include "reports/html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "base/text.h"
#include "reports/run_page.h"
#include "reports/web_assets.h"

namespace dynoproof::reports {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Escape, LeavesNoMarkup) {
  EXPECT_EQ(Escape("<b title=\"x\">'&'</b>"), "&lt;b title=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/b&gt;");
  EXPECT_EQ(Escape("N m/rad, 5 µs"), "N m/rad, 5 µs");
}

TEST(ScriptData, CannotEndItsElementAndReadsBackAsItWas) {
  const nlohmann::json document = {{"label", "</script><script>alert(1)</script><!-- & "}, {"n", 3}};
  const std::string text = ScriptData(document);
  EXPECT_THAT(text, Not(HasSubstr("<")));
  EXPECT_EQ(nlohmann::json::parse(text), document);
  EXPECT_NO_THROW(ScriptData({{"label", "\xff bytes that are no UTF-8"}}));
}

TEST(Anchor, IsAnIdOfItsOwn) {
  std::set<std::string> ids;
  for (const char* text : {"a/b", "a.b", "a-b", "a b", "a.2fb", "a\"b", ""})
    EXPECT_TRUE(ids.insert(Anchor(text)).second);
  EXPECT_EQ(Anchor("r2r/setup_1"), "r2r.2fsetup_1");
}

TEST(Assets, AreTheFilesOfTheFolder) {
  EXPECT_EQ(assets::kPageHtml, *ReadTextFile("reports/page.html"));
  EXPECT_EQ(assets::kPageCss, *ReadTextFile("reports/page.css"));
  EXPECT_EQ(assets::kDrawingJs, *ReadTextFile("reports/drawing.js"));
  EXPECT_EQ(assets::kPageJs, *ReadTextFile("reports/page.js"));
  EXPECT_EQ(HasPlotLibrary(), !assets::kUPlotJs.empty());
  if (HasPlotLibrary()) {
    EXPECT_THAT(std::string(assets::kUPlotLicence), HasSubstr("MIT"));
  }
}

TEST(Page, PutsEachPartInOnce) {
  const std::string page = Page("a <title>", "<b>fail</b> {{title}}", "{{body}}", "<p>the body {{style}}</p>");
  EXPECT_THAT(page, HasSubstr("<title>a &lt;title&gt; (dynoproof)</title>"));
  EXPECT_THAT(page, HasSubstr("<p>the body {{style}}</p>")) << "what is put in is not a place itself";
  EXPECT_THAT(page, HasSubstr("<p class=\"lead\"><b>fail</b> {{title}}</p>"));
  EXPECT_THAT(page, HasSubstr("class=\"provenance\">{{body}}</p>"));
}

TEST(RunPage, SaysFirstWhichVerdictAndWhichCause) {
  ScenarioResult result;
  result.id = "family/line";
  result.verdict = score::Verdict::kFail;
  result.checks.push_back(score::AtMost("solvers omega_1", "solvers", 0.1, 0.2, "1", "made up"));
  result.checks.push_back(
      score::AtMost("golden T", "tube", 3.0, 1.0, "half-widths", "made up", "apart from t = 1 s on"));
  const auto lead_of = [&result] {
    const std::string page = RunPage(1).Finish({result});
    const std::size_t at = page.find("class=\"lead\"");
    return page.substr(page.find("<title>"), page.find("</title>") - page.find("<title>")) +
           page.substr(at, page.find("</p>", at) - at);
  };
  EXPECT_THAT(lead_of(), HasSubstr("<title>family/line: fail (dynoproof)"));
  EXPECT_THAT(lead_of(),
              HasSubstr("golden T: 3 half-widths (at most 1 half-widths). apart from t = 1 s on. 1 of 2 checks"));
  result.checks.back().cause = "gain 1.05";
  EXPECT_THAT(lead_of(), HasSubstr("<title>family/line: fail, gain 1.05 (dynoproof)"));
  EXPECT_THAT(lead_of(), HasSubstr("Likely cause: gain 1.05. 1 of 2 checks does not pass."));
  result.checks.pop_back();
  result.verdict = score::Verdict::kPass;
  EXPECT_THAT(lead_of(),
              HasSubstr("The one check holds. The closest to its limit is solvers omega_1: 0.1 (at most 0.2)."));
}

TEST(RunPage, ShowsABrokenRunFirstAndEscapesItsTexts) {
  ScenarioResult good, bad;
  good.id = "family/good";
  good.verdict = score::Verdict::kPass;
  score::Check check;
  check.name = "<i>check</i>";
  check.verdict = score::Verdict::kPass;
  good.checks.push_back(check);
  bad.id = "bad<script>";
  bad.title = "<img src=x onerror=alert(1)>";
  bad.verdict = score::Verdict::kBroken;
  bad.broken = "it & \"that\" broke";
  const std::string page = RunPage(2).Finish({good, bad});
  EXPECT_THAT(page, HasSubstr("it &amp; &quot;that&quot; broke"));
  EXPECT_THAT(page, Not(HasSubstr("<i>check")));
  EXPECT_THAT(page, Not(HasSubstr("<img src=x")));
  EXPECT_THAT(page, Not(HasSubstr("bad<script>")));
  EXPECT_LT(page.find("bad&lt;script&gt;"), page.find("family/good")) << "worst first";
}

}  // namespace
}  // namespace dynoproof::reports
