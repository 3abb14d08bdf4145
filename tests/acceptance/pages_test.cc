// Every kind of page that the program writes, looked at: what counts is pixels. Each picture must show its curves, each
// curve its colour, in light and dark.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <sstream>

#include "tests/support/browser.h"
#include "tests/support/noisy_record.h"
#include "tests/support/program.h"
#include "trace/csv_write.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Opens all parts, draws each picture as it is at first and then with each of its curves alone. Answers the faults:
/// pictures without a curve's colour at first, and curves that leave less than three pixels more of their colour than
/// the same picture without any curve. A curve counts when it has a value in the range that is shown. Samples that
/// could not be told apart are hidden on purpose, beside the curve they are compared with.
constexpr const char* kLook = R"((async () => {
  const frame = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)));
  document.querySelectorAll('details').forEach((part) => { part.open = true; });
  const rgb = (k) => curveColour(k).match(/\d+/g).slice(0, 3).map(Number);
  const faults = [];
  let pictures = 0, curves = 0;
  for (const host of document.querySelectorAll('.plot')) {
    host.drawNow();
    const { chart } = host, title = host.getAttribute('aria-label');
    await frame();
    const canvas = host.querySelector('canvas');
    const ctx = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true });
    const pixels = () => {
      ctx.clearRect(0, 0, canvas.width, canvas.height);
      ctx.drawImage(canvas, 0, 0);
      return ctx.getImageData(0, 0, canvas.width, canvas.height).data;
    };
    const count = (data, [r, g, b]) => {
      let n = 0;
      for (let i = 0; i < data.length; i += 4)
        if (data[i + 3] > 200 && Math.abs(data[i] - r) + Math.abs(data[i + 1] - g) + Math.abs(data[i + 2] - b) < 30) ++n;
      return n;
    };
    const show = async (which) => {
      chart.curves.forEach((curve, k) => { curve.shown = which(k); });
      chart.canvas.draw();
      await null;  // uPlot paints when the event is over
      return pixels();
    };
    const first = pixels(), atFirst = chart.curves.map((curve) => curve.shown);
    const shownAtFirst = chart.curves.some((curve, k) => atFirst[k] && count(first, rgb(k)) >= 3);
    ++pictures;
    if (!shownAtFirst) faults.push(`${title}: no curve at first`);
    const none = await show(() => false);
    for (let k = 0; k < chart.curves.length; ++k) {
      const curve = chart.curves[k], [from, to] = chart.x;
      if (!curve.y.some((y, i) => Number.isFinite(y) && curve.x[i] >= from && curve.x[i] <= to)) continue;
      const alone = await show((other) => other === k);
      if (curve.style === 'samples' && shownAtFirst) continue;
      ++curves;
      const seen = count(alone, rgb(k)) - count(none, rgb(k));
      if (seen < 3) faults.push(`${title}: "${curve.label}" (${curve.style}) has ${seen} pixels`);
    }
    await show((k) => atFirst[k]);
  }
  return { pictures, curves, faults };
})())";

std::string Budgets(double instructions) {
  return "[{\"name\": \"core\", \"value\": " + std::to_string(instructions) +
         ", \"limit\": 342.3, \"unit\": \"instructions\", \"verdict\": \"pass\"}]";
}

constexpr const char* kCampaign = R"(title = "a line with uncertain inertia"
scenario = "line.toml"
samples = 300
seed = 7

[[axis]]
key = "plant.inertia.I3"
uniform = [0.8, 1.2]
relative = true

[figure.T_peak]
of = "T_shaft"
take = "peak"
at_most = 1000.0
)";

class Pages : public ::testing::Test {
 protected:
  void SetUp() override {
    DYNOPROOF_NEEDS_BROWSER();
    browser_ = std::make_unique<Browser>();
    browser_->Size(1200, 900);
  }

  void Made(const std::vector<std::string>& arguments, int exit = 0) {
    const Outcome outcome = bench_.Call(arguments);
    ASSERT_EQ(outcome.exit, exit) << ::testing::PrintToString(arguments) << outcome.Both();
  }

  /// The page, in both themes; at least this many pictures. Its title says the verdict.
  void Look(const std::string& page, int pictures, const std::string& said) {
    browser_->complaints.clear();
    browser_->Open("file://" + (bench_ / page).string());
    const std::string title = browser_->Ask("document.title"),
                      lead = browser_->Ask("document.querySelector('.lead').innerText");
    EXPECT_THAT(title, HasSubstr(said)) << page;
    EXPECT_THAT(lead, Not(IsEmpty())) << page;
    std::set<std::string> backs;
    for (int theme = 0; theme < 2; ++theme) {
      backs.insert(browser_->Ask("getComputedStyle(document.body).backgroundColor"));
      const nlohmann::json seen = browser_->Ask(kLook);
      EXPECT_GE(seen["pictures"], pictures) << page;
      EXPECT_GE(seen["curves"], pictures) << page;
      EXPECT_THAT(seen["faults"], IsEmpty()) << page << seen["faults"].dump(1);
      AskAxe(page);
      browser_->Ask("document.getElementById('theme').click()");
    }
    EXPECT_EQ(backs.size(), 2u) << "light and dark";
    EXPECT_THAT(browser_->complaints, IsEmpty());
  }

  /// Contrast, labels, headings, tables: what axe-core finds amiss in what is unfolded. Without npm it is not there.
  void AskAxe(const std::string& page) {
    static const std::string axe = ReadBytes(DYNOPROOF_AXE);
    if (axe.empty()) {
      if (Browser::Required())
        ADD_FAILURE() << DYNOPROOF_AXE << " is missing, CI is set: npm fetches it at configuration";
      return;
    }
    browser_->Ask(axe + "; 0");
    const nlohmann::json found = browser_->Ask(
        "axe.run({ resultTypes: ['violations'] }).then((all) => all.violations.map((one) => "
        "[one.id, one.help, one.nodes.slice(0, 3).map((node) => node.html.slice(0, 200))]))");
    EXPECT_THAT(found, IsEmpty()) << page << found.dump(1);
  }

  Bench bench_;
  std::unique_ptr<Browser> browser_;
};

TEST_F(Pages, OfARunThatPasses) {
  Made({"run", "line.toml", "--html", "run.html"});
  Look("run.html", 5, "line: pass");
}

TEST_F(Pages, OfARunThatFails) {
  Made({"run", "line.toml", "--set", "check.0.nrmse=1e-30", "--html", "run.html"}, 1);
  EXPECT_THAT(ReadBytes(bench_ / "run.html"), HasSubstr("fail"));
  Look("run.html", 5, "line: fail");
}

TEST_F(Pages, OfAClaimWithItsFigures) {
  Made({"reproduce", "5.6.1-notch-1", "--html", "atlas.html"});
  Look("atlas.html", 1, "all claims as expected");
}

TEST_F(Pages, OfADiagnosis) {
  const std::vector<trace::Column> columns =
      NoisyRecord(bench_, {"line.toml", "--set", "run.duration_s=0.6", "--set", "plant.inertia.I3=0.65"}, "out/line.h5",
                  {"T_airgap"}, {"T_shaft", "omega_1"});
  ASSERT_FALSE(trace::WriteCsv(bench_ / "record.csv", columns));
  Made({"diagnose", "line.toml", "--data", "record.csv", "--out", "found", "--html", "diagnosis.html"});
  Look("diagnosis.html", 3, "record.csv: inertia_change at inertia:I3");
}

TEST_F(Pages, OfACampaignWhoseRunsAllPass) {
  bench_.Write("spread.toml", kCampaign);
  Made({"sweep", "spread.toml", "--html", "sweep.html"});
  const std::string page = ReadBytes(bench_ / "sweep.html");
  EXPECT_THAT(page, HasSubstr("All runs passed"));
  EXPECT_THAT(page, HasSubstr("Closest to its limit: run "));
  EXPECT_THAT(page, Not(HasSubstr("worst first")));
  Look("sweep.html", 1, "all 300 runs pass");
}

TEST_F(Pages, OfACampaignWithRunsThatFail) {
  std::string text = kCampaign;
  bench_.Write("spread.toml", text.replace(text.find("1000.0"), 6, "85.0"));
  Made({"sweep", "spread.toml", "--html", "sweep.html"}, 1);
  EXPECT_THAT(ReadBytes(bench_ / "sweep.html"), HasSubstr("Runs that did not pass, worst first"));
  Look("sweep.html", 1, "of 300 runs do not pass");
}

TEST_F(Pages, OfAProbe) {
  bench_.Write("probed.toml", R"(include = ["line.toml"]
[run]
duration_s = 0.5
[[check]]
kind = "peak"
signal = "T_shaft"
figure = "tone"
band_Hz = [5.0, 100.0]
between_Hz = [5.0, 99.0]
origin = "the first resonance is beyond"
)");
  Made({"probe", "probed.toml", "--html", "probe.html", "--effects",
        "stiffness_change,sensor_offset,turned_sign,backlash"});
  EXPECT_THAT(ReadBytes(bench_ / "probe.html"), HasSubstr("passes at any"));
  Look("probe.html", 0, "usual errors would pass");
}

TEST_F(Pages, OfTheNightlyRecord) {
  for (int night = 1; night <= 6; ++night) {
    bench_.Write("budgets.json", Budgets(night < 5 ? 338.9 : 349.0));
    Made({"history", "add", "budgets.json", "--db", "h.sqlite", "--machine", "m", "--commit",
          "c" + std::to_string(night), "--time", "2026-03-0" + std::to_string(night) + "T02:00:00Z"});
  }
  Made({"history", "show", "--db", "h.sqlite", "--html", "show.html"});
  Look("show.html", 1, "nightly record");
  Made({"history", "check", "--db", "h.sqlite", "--html", "check.html"}, 5);
  Look("check.html", 1, "1 series became worse");
}

TEST_F(Pages, OfTheModesOfALine) {
  Made({"modes", "line.toml", "--html", "modes.html"});
  Look("modes.html", 4, "modes of line: 2 below");
  Made({"modes", "heavy_duty/alternative_setup_1", "--html", "branched.html"});
  Look("branched.html", 4, "modes of heavy_duty/alternative_setup_1: 4 below 2000 Hz");
}

TEST_F(Pages, OfTwoTraces) {
  Made({"run", "line.toml", "--out", "a", "--set", "run.duration_s=0.3"});
  Made({"run", "line.toml", "--out", "b", "--set", "run.duration_s=0.3", "--set", "plant.inertia.I3=0.51"});
  Made({"compare", "a/line.h5", "b/line.h5", "--html", "parted.html"}, 1);
  Look("parted.html", 3, "signals do not agree");
  Made({"compare", "a/line.h5", "a/line.h5", "--html", "same.html"});
  Look("same.html", 2, "signals agree");
}

TEST_F(Pages, OfABenchmark) {
  const Outcome outcome = bench_.Call({"bench", "suppression/adaptive", "--html", "bench.html"});
  ASSERT_TRUE(outcome.exit == 0 || outcome.exit == 4 || outcome.exit == 5)
      << outcome.Both();  // as fit as the machine is
  Look("bench.html", 1, "bench of suppression/adaptive: ");
}

/// Commands, and those below them, whose help names --html.
void CollectPages(const Bench& bench, const std::vector<std::string>& command, std::set<std::string>& pages) {
  std::vector<std::string> words = command;
  words.push_back("--help");
  const Outcome help = bench.Call(words);
  ASSERT_EQ(help.exit, 0) << help.Both();
  std::istringstream lines(help.out);
  bool below = false;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(" ")) below = line.find("ubcommands:") != std::string::npos;
    std::istringstream of_line(line);
    std::string first;
    of_line >> first;
    if (first.starts_with("--html")) {
      std::string name;
      for (const std::string& word : command) name += (name.empty() ? "" : " ") + word;
      pages.insert(name);
    }
    if (!below || !line.starts_with("  ") || line.starts_with("   ") || first.empty()) continue;
    words = command;
    words.push_back(first);
    CollectPages(bench, words, pages);
  }
}

TEST(PagesOfTheProgram, AreAllLookedAtAbove) {
  const Bench bench;
  std::set<std::string> pages;
  CollectPages(bench, {}, pages);
  EXPECT_EQ(pages, (std::set<std::string>{"run", "reproduce", "diagnose", "bench", "probe", "sweep", "history show",
                                          "history check", "modes", "compare"}))
      << "a command that writes another page needs a test here";
}

}  // namespace
}  // namespace dynoproof::test
