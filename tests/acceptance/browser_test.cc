// The report in a browser, as its reader has it: opened from the disk, without a network, with mouse and keyboard.
// Needs Debian's chromium (support/browser.h says what its absence means).
#include "tests/support/browser.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <sstream>

#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// Draws every picture of the open parts, then tells of each how many of its canvas' pixels have a curve's colour:
/// neither nearly grey (axes, text) nor empty.
constexpr const char* kColouredPixels = R"((async () => {
  const hosts = [...document.querySelectorAll('details[open] .plot')];
  for (const host of hosts) host.drawNow();
  await new Promise((done) => requestAnimationFrame(() => setTimeout(done, 100)));
  return hosts.map((host) => {
    const canvas = host.querySelector('canvas');
    const ctx = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true });
    ctx.drawImage(canvas, 0, 0);
    const { data } = ctx.getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
      const [r, g, b, a] = data.subarray(i, i + 4);
      if (a > 100 && Math.max(r, g, b) - Math.min(r, g, b) > 60) ++count;
    }
    return count;
  });
})())";
constexpr const char* kRange = "document.querySelector('.plot').chart.x";

class InTheBrowser : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!Browser::Installed()) return;
    bench_ = new Bench;
    const Outcome run = bench_->Call({"run", "line.toml", "r2r/soft_rotor_setup_1", "suppression/adaptive", "--set",
                                      "check=[]", "--jobs", "2", "--html", "r.html"});
    ASSERT_NE(run.exit, 2) << run.Both();
  }
  static void TearDownTestSuite() {
    delete bench_;
    bench_ = nullptr;
  }
  void SetUp() override {
    DYNOPROOF_NEEDS_BROWSER();
    browser_ = std::make_unique<Browser>();
    browser_->Size(1200, 900);
    browser_->Open("file://" + (*bench_ / "r.html").string());
  }
  /// Frames go by: drawing follows events.
  void Settle() {
    browser_->Ask(
        "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 150))))");
  }
  std::vector<double> Range() { return browser_->Ask(kRange).get<std::vector<double>>(); }
  /// The middle of the first picture's plotting area and its size.
  std::vector<double> Over() {
    browser_->Ask("document.querySelector('.plot').scrollIntoView({ block: 'center' })");
    Settle();
    return browser_->Ask(
        "(() => { const b = document.querySelector('.plot .u-over').getBoundingClientRect();"
        "return [b.x + b.width / 2, b.y + b.height / 2, b.width, b.height]; })()");
  }

  static Bench* bench_;
  std::unique_ptr<Browser> browser_;
};
Bench* InTheBrowser::bench_ = nullptr;

TEST_F(InTheBrowser, EveryPictureIsDrawnAndNothingComplains) {
  const std::vector<int> coloured = browser_->Ask(kColouredPixels);
  EXPECT_GE(coloured.size(), 20u);
  EXPECT_THAT(coloured, Each(::testing::Ge(20)));
  Settle();
  EXPECT_THAT(browser_->complaints, IsEmpty());
  EXPECT_THAT(browser_->requests, Each(::testing::AnyOf(StartsWith("file://"), StartsWith("data:"))));
}

TEST_F(InTheBrowser, EveryLinkLeadsSomewhereAndOpensIt) {
  EXPECT_EQ(browser_->Ask("[...document.links].filter((a) => !document.getElementById(decodeURIComponent("
                          "a.hash.slice(1)))).length"),
            0);
  browser_->Ask("document.querySelectorAll('details').forEach((d) => { d.open = false; }); document.links[1].click()");
  Settle();
  EXPECT_EQ(browser_->Ask("document.getElementById(decodeURIComponent(document.links[1].hash.slice(1))).open"), true);
}

TEST_F(InTheBrowser, ShowsOfManyScenariosThoseThatAreLookedFor) {
  const std::string shown =
      "[...document.querySelectorAll('details.part')].filter((part) => !part.hidden).map((part) => part.id).join(' ')";
  const std::string all = browser_->Ask(shown);
  const auto with = [&](const char* text, const char* verdict) {
    browser_->Ask(
        fmt::format("(() => {{ const f = document.getElementById('filter');"
                    "f.querySelector('input').value = '{}'; f.querySelector('select').value = '{}';"
                    "f.dispatchEvent(new Event('input')); }})()",
                    text, verdict));
    EXPECT_EQ(browser_->Ask("document.querySelectorAll('#overview tbody tr:not([hidden])').length"),
              browser_->Ask("document.querySelectorAll('details.part:not([hidden])').length"));
    return browser_->Ask(shown).get<std::string>();
  };
  EXPECT_EQ(with("SOFT r2r", ""), "r2r.2fsoft_rotor_setup_1");
  EXPECT_EQ(with("no such words", ""), "");
  EXPECT_EQ(with("", "fail"), all) << "without checks none passes";
  browser_->Ask("document.querySelector('details.part').dataset.verdict = 'pass'");
  EXPECT_EQ(all.find(with("", "fail")), all.find(' ') + 1) << "all but the first";
  EXPECT_EQ(with("", ""), all);
}

TEST_F(InTheBrowser, ZoomsByDraggingWheelAndKeysAndCoursesFollowEachOther) {
  browser_->Ask(kColouredPixels);
  const std::vector<double> whole = Range(), over = Over();
  if (over.empty()) GTEST_SKIP() << "without uPlot pictures are not dragged";
  browser_->Mouse("mouseMoved", over[0] - 0.2 * over[2], over[1], 0);
  browser_->Mouse("mousePressed", over[0] - 0.2 * over[2], over[1], 1);
  browser_->Mouse("mouseMoved", over[0], over[1], 1);
  browser_->Mouse("mouseMoved", over[0] + 0.2 * over[2], over[1], 1);
  browser_->Mouse("mouseReleased", over[0] + 0.2 * over[2], over[1], 0);
  Settle();
  const std::vector<double> dragged = Range();
  EXPECT_NEAR((dragged[1] - dragged[0]) / (whole[1] - whole[0]), 0.4, 0.05);
  EXPECT_EQ(browser_->Ask("document.querySelectorAll('.plot')[1].chart.x").get<std::vector<double>>(), dragged);

  browser_->Mouse("mouseWheel", over[0], over[1], 0, {{"deltaX", 0}, {"deltaY", -100}});
  Settle();
  const std::vector<double> wheeled = Range();
  EXPECT_NEAR((wheeled[1] - wheeled[0]) / (dragged[1] - dragged[0]), 0.8, 0.01);

  browser_->Key("ArrowRight");
  Settle();
  EXPECT_GT(Range()[0], wheeled[0]);
  browser_->Key("-");
  Settle();
  EXPECT_GT(Range()[1] - Range()[0], 1.1 * (wheeled[1] - wheeled[0]));
  browser_->Key("0");
  Settle();
  EXPECT_EQ(Range(), whole);
  EXPECT_THAT(browser_->complaints, IsEmpty());
}

TEST_F(InTheBrowser, ShowsValuesWithUnitsAtThePointer) {
  browser_->Ask(kColouredPixels);
  const std::vector<double> over = Over();
  browser_->Mouse("mouseMoved", over[0], over[1], 0);
  Settle();
  const std::string legend = browser_->Ask("document.querySelector('.plot').nextElementSibling.textContent");
  EXPECT_THAT(legend, HasSubstr(" N m"));
  EXPECT_THAT(legend, HasSubstr(" s"));
}

TEST_F(InTheBrowser, SavesAPictureAndItsData) {
  browser_->Ask(kColouredPixels);
  const std::vector<std::string> names = browser_->Ask(R"((async () => {
    const names = [], click = HTMLAnchorElement.prototype.click;
    HTMLAnchorElement.prototype.click = function () { names.push(this.download); };
    for (const button of charts[0].list.querySelectorAll('.save')) button.click();
    await new Promise((done) => setTimeout(done, 300));
    HTMLAnchorElement.prototype.click = click;
    return names.sort();
  })())");
  ASSERT_EQ(names.size(), 2u);
  EXPECT_THAT(names[0], ::testing::EndsWith(".csv"));
  EXPECT_THAT(names[1], ::testing::EndsWith(".png"));
  const std::string csv = browser_->Ask("asCsv(charts[0])");
  std::istringstream lines(csv);
  std::string head, first;
  std::getline(lines, head);
  std::getline(lines, first);
  EXPECT_THAT(head, StartsWith("\"time [s]\",\""));
  EXPECT_EQ(std::count(head.begin(), head.end(), ','), std::count(first.begin(), first.end(), ','));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + browser_->Ask("charts[0].curves[0].x.length").get<int>());
  // As large as what is drawn, with the curve's colour in it.
  const std::vector<int> seen = browser_->Ask(R"((async () => {
    const image = await createImageBitmap(await asPng(charts[0])), drawn = charts[0].host.querySelector('canvas');
    const ctx = new OffscreenCanvas(image.width, image.height).getContext('2d');
    ctx.drawImage(image, 0, 0);
    const { data } = ctx.getImageData(0, 0, image.width, image.height), [r, g, b] = curveColour(0).match(/\d+/g).map(Number);
    let count = 0;
    for (let i = 0; i < data.length; i += 4)
      if (Math.abs(data[i] - r) + Math.abs(data[i + 1] - g) + Math.abs(data[i + 2] - b) < 30) ++count;
    return [image.width - drawn.width, image.height - drawn.height, count];
  })())");
  EXPECT_EQ(seen[0], 0);
  EXPECT_EQ(seen[1], 40);
  EXPECT_GT(seen[2], 50);
  EXPECT_THAT(browser_->complaints, IsEmpty());
}

TEST_F(InTheBrowser, IsReachedByTheKeyboardAndShowsWhereItIs) {
  browser_->Ask(kColouredPixels);
  std::set<std::string> reached;
  for (int i = 0; i < 60; ++i) {
    browser_->Key("Tab");
    reached.insert(browser_->Ask(
        "document.activeElement.className || document.activeElement.id || document.activeElement.tagName"));
    if (browser_->Ask("document.activeElement.classList.contains('plot')") == true) {
      EXPECT_NE(browser_->Ask("getComputedStyle(document.activeElement).outlineStyle"), "none");
    }
  }
  EXPECT_TRUE(reached.contains("theme"));
  EXPECT_TRUE(reached.contains("plot"));
}

TEST_F(InTheBrowser, FitsANarrowScreenAndTurnsDark) {
  browser_->Size(400, 800);
  browser_->Ask(kColouredPixels);
  Settle();
  EXPECT_LE(browser_->Ask("document.documentElement.scrollWidth").get<int>(), 400);
  const std::string light = browser_->Ask("getComputedStyle(document.body).backgroundColor");
  browser_->Ask("document.getElementById('theme').click()");
  Settle();
  EXPECT_NE(browser_->Ask("getComputedStyle(document.body).backgroundColor"), light);
  EXPECT_THAT(browser_->Ask(kColouredPixels).get<std::vector<int>>(), Each(::testing::Ge(20)));
  EXPECT_THAT(browser_->complaints, IsEmpty());
}

TEST_F(InTheBrowser, DrawsPlainlyWithoutUPlot) {
  std::string page = ReadBytes(*bench_ / "r.html");
  const std::string begin = "<script id=\"uplot\">";
  const std::size_t at = page.find(begin) + begin.size();
  page.erase(at, page.find("</script>", at) - at);
  bench_->Write("plain.html", page);
  browser_->Open("file://" + (*bench_ / "plain.html").string());
  EXPECT_EQ(browser_->Ask("typeof uPlot"), "undefined");
  const std::vector<int> coloured = browser_->Ask(kColouredPixels);
  EXPECT_GE(coloured.size(), 20u);
  EXPECT_THAT(coloured, Each(::testing::Ge(20)));
  const std::vector<double> whole = Range();
  browser_->Ask("document.querySelector('.plot').focus()");
  browser_->Key("+");
  EXPECT_LT(Range()[1] - Range()[0], whole[1] - whole[0]);
  EXPECT_THAT(browser_->complaints, IsEmpty());
}

TEST_F(InTheBrowser, DrawsFewPointsOfAHundredThousandSamples) {
  browser_->Ask(kColouredPixels);
  // Twenty zooms of all courses of the chirp, each with everything redrawn; the time is for the record.
  const double ms = browser_->Ask(R"((async () => {
    const chart = charts.find((one) => one.curves[0].x.length > 90000);
    const start = performance.now();
    for (let i = 0; i < 20; ++i) {
      chart.show([0.1 * i, 10 - 0.1 * i]);
      await null;  // uPlot paints when the event is over
    }
    return (performance.now() - start) / 20;
  })())");
  RecordProperty("ms_per_zoom", std::to_string(ms));
  // What is drawn is short, and has the peak that is in the data.
  EXPECT_EQ(browser_->Ask(R"((() => {
    const chart = charts.find((one) => one.curves[0].x.length > 90000), curve = chart.curves[0];
    const largest = (values) => values.reduce((a, b) => Math.max(a, b));
    const shown = visible(curve, 0, 10, 500)[1];
    return shown.length < 2500 && largest(shown) === largest(curve.y);
  })())"),
            true);
}

}  // namespace
}  // namespace dynoproof::test
