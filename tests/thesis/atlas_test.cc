// The figures of the atlas, and the settings and pictures that the report shows of a run.
#include "thesis/atlas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiment/golden.h"
#include "experiment/settings.h"
#include "tests/support/registry.h"
#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

const Picture* Find(const RunPictures& run, const std::string& key) {
  const auto found =
      std::find_if(run.pictures.begin(), run.pictures.end(), [&](const Picture& one) { return one.key == key; });
  return found == run.pictures.end() ? nullptr : &*found;
}

std::unique_ptr<Prepared> Shipped(const std::string& file, const std::vector<std::string>& overrides = {}) {
  Diagnostics diagnostics;
  auto prepared = Prepare("scenarios/" + file, {overrides, "", nullptr}, testing::FullRegistry(), diagnostics);
  EXPECT_NE(prepared, nullptr) << diagnostics.Format();
  return prepared;
}

TEST(Atlas, TheShippedFiguresAreSound) {
  Diagnostics diagnostics;
  const std::vector<AtlasFigure> figures = ReadFigures(GoldenFolder() + "/figures.toml", diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.Format();
  EXPECT_GE(figures.size(), 20u);
}

TEST(Atlas, FaultyFiguresAreAnswered) {
  const test::TempDir folder;
  folder.Write("f.toml",
               "[[figure]]\nnumber = \"1.1\"\ntitle = \"t\"\nscenarios = [\"no/such\"]\npictures = [\"p\"]\n");
  Diagnostics diagnostics;
  ReadFigures((folder / "f.toml").string(), diagnostics);
  EXPECT_THAT(diagnostics.Format(), ::testing::HasSubstr("no/such"));
}

TEST(Atlas, PlacesNameFigures) {
  EXPECT_TRUE(Names("Figs. 3.6, 3.7", "3.7"));
  EXPECT_TRUE(Names("Sec. 5.6.1, Fig. 5.19", "5.19"));
  EXPECT_TRUE(Names("Figs. 5.21-5.29", "5.25"));
  EXPECT_FALSE(Names("Figs. 5.21-5.29", "5.30"));
  EXPECT_FALSE(Names("Sec. 3.6", "3.6"));
  EXPECT_FALSE(Names("Fig. 5.1", "5.19"));
  EXPECT_FALSE(Names("Fig. 2.4, Sec. 3.6", "3.6"));
  EXPECT_TRUE(Names("App. B, Fig. B.2", "B.2"));
  EXPECT_EQ(NumbersIn("Figs. 2.11(b), 2.32(b), Table A.5, (2.111)", "Fig"), (std::vector<std::string>{"2.11", "2.32"}));
  EXPECT_EQ(NumbersIn("Sec. 2.2.7, Tables 2.1, A.5, Figs. 5.21-5.23", "Table"),
            (std::vector<std::string>{"2.1", "A.5"}));
  EXPECT_EQ(NumbersIn("Figs. 5.21-5.23", "Fig"), (std::vector<std::string>{"5.21", "5.22", "5.23"}));
  EXPECT_TRUE(NumbersIn("footnote 3 of chapter 5, App. D", "Fig").empty());
}

TEST(Atlas, AMissingPictureIsAFaultOfTheFigure) {
  AtlasFigure figure;
  figure.number = "5.5";
  figure.scenarios = {"backlash/clamped"};
  figure.pictures = {"no such picture"};
  const std::vector<DrawnFigure> drawn = Draw(testing::FullRegistry(), {figure});
  ASSERT_EQ(drawn.size(), 1u);
  EXPECT_THAT(drawn[0].fault, ::testing::HasSubstr("no such picture"));
}

/// Inputs of one unit share a picture, which bears the name of the first.
TEST(Atlas, ASignalIsFoundInThePictureThatItShares) {
  AtlasFigure figure;
  figure.number = "5.24";
  figure.scenarios = {"suppression/r2r_experiment_2"};
  figure.pictures = {"time:T_airgap"};
  const std::vector<DrawnFigure> drawn = Draw(testing::FullRegistry(), {figure});
  ASSERT_EQ(drawn.size(), 1u);
  EXPECT_EQ(drawn[0].fault, "");
  ASSERT_EQ(drawn[0].pictures.size(), 1u);
  EXPECT_TRUE(
      std::ranges::any_of(drawn[0].pictures[0].curves, [](const Curve& one) { return one.label == "T_airgap"; }));
}

TEST(Atlas, SetupsSideBySideShareTheirOrdinate) {
  AtlasFigure figure;
  figure.number = "3.1";
  figure.scenarios = {"backlash/clamped", "backlash/clamped_damped"};
  figure.pictures = {"time:omega_7"};
  const std::vector<DrawnFigure> drawn = Draw(testing::FullRegistry(), {figure}, {});
  ASSERT_EQ(drawn.size(), 1u);
  ASSERT_EQ(drawn[0].fault, "");
  const std::vector<Picture>& pictures = drawn[0].pictures;
  ASSERT_EQ(pictures.size(), 2u);
  ASSERT_TRUE(pictures[0].y.from && pictures[0].y.to);
  EXPECT_EQ(pictures[0].y.from, pictures[1].y.from);
  EXPECT_EQ(pictures[0].y.to, pictures[1].y.to);
  for (const Picture& one : pictures) {
    for (const Curve& curve : one.curves) {
      EXPECT_LT(*one.y.from, *std::ranges::min_element(curve.y));
      EXPECT_GT(*one.y.to, *std::ranges::max_element(curve.y));
    }
  }
}

TEST(Atlas, AFigureKeepsTheCurvesItNamesAndNoOther) {
  AtlasFigure figure;
  figure.number = "3.1";
  figure.scenarios = {"backlash/clamped"};
  figure.pictures = {"time:omega_7"};
  const std::vector<DrawnFigure> all = Draw(testing::FullRegistry(), {figure});
  ASSERT_EQ(all[0].fault, "");
  ASSERT_GT(all[0].pictures[0].curves.size(), 1u);
  figure.curves = {all[0].pictures[0].curves[1].label};
  figure.from = 0.01;
  figure.to = 0.04;
  const std::vector<DrawnFigure> one = Draw(testing::FullRegistry(), {figure});
  EXPECT_EQ(one[0].fault, "");
  ASSERT_EQ(one[0].pictures[0].curves.size(), 1u);
  EXPECT_EQ(one[0].pictures[0].curves[0].label, figure.curves[0]);
  EXPECT_TRUE(one[0].pictures[0].curves[0].shown);
  EXPECT_EQ(one[0].pictures[0].x.from, 0.01);
  EXPECT_EQ(one[0].pictures[0].x.to, 0.04);
  figure.curves = {"nobody"};
  EXPECT_THAT(Draw(testing::FullRegistry(), {figure})[0].fault, ::testing::HasSubstr("no curve \"nobody\""));
}

TEST(Atlas, ADrawingNeedsNoScenario) {
  const test::TempDir folder;
  const auto read = [&folder](const std::string& body, Diagnostics& diagnostics) {
    return ReadFigures(folder.Write("f.toml", "[[figure]]\nnumber = \"D.1\"\ntitle = \"t\"\n" + body).string(),
                       diagnostics);
  };
  Diagnostics good, unknown, none;
  const std::vector<AtlasFigure> figures = read("drawings = [\"notch_poles\"]\n", good);
  ASSERT_FALSE(good.has_errors()) << good.Format();
  const std::vector<DrawnFigure> drawn = Draw(testing::FullRegistry(), figures);
  EXPECT_EQ(drawn[0].fault, "");
  ASSERT_EQ(drawn[0].pictures.size(), 1u);
  EXPECT_EQ(drawn[0].pictures[0].key, "notch_poles");
  read("drawings = [\"nothing\"]\n", unknown);
  EXPECT_THAT(unknown.Format(), ::testing::HasSubstr("no drawing \"nothing\""));
  read("", none);
  EXPECT_THAT(none.Format(), ::testing::HasSubstr("needs scenarios with pictures, or drawings"));
}

TEST(Settings, TellWhatWasGivenWhereAndWhatWasNot) {
  const auto prepared = Shipped("suppression/adaptive.toml", {"plant.inertia.I5=0.1"});
  std::map<std::string, Setting> settings;
  for (const Setting& setting : SettingsOf(prepared->plan, testing::FullRegistry())) settings[setting.path] = setting;
  EXPECT_EQ(settings.at("plant.inertia.I5").value, "0.1");
  EXPECT_EQ(settings.at("plant.inertia.I5").from, "--set");
  EXPECT_THAT(settings.at("plant.inertia.I4").from, ::testing::HasSubstr("_soft_rotor.toml:"));
  EXPECT_EQ(settings.at("control.core.radius").from, "default");
  EXPECT_EQ(settings.at("control.core.radius").value, "0.995");
  EXPECT_EQ(settings.at("run.realtime.substeps").from, "default");
  EXPECT_FALSE(settings.contains("title"));
}

TEST(Pictures, EachHasLabelsUnitsAndNumbers) {
  for (const char* file : {"suppression/adaptive.toml", "backlash/experiment_1.toml", "coupling/startup_oil.toml"}) {
    const auto prepared = Shipped(file, {"run.duration_s=0.8", "check=[]"});
    const Result<RunPictures> run = PicturesOf(*prepared);
    ASSERT_TRUE(run.ok()) << run.failure().ToString();
    std::map<std::string, int> keys;
    for (const Picture& picture : run->pictures) {
      EXPECT_EQ(++keys[picture.key], 1) << picture.key;
      for (const Axis& axis : {picture.x, picture.y}) {
        EXPECT_NE(axis.label, "") << picture.key;
        EXPECT_NE(axis.unit, "") << picture.key;
      }
      ASSERT_FALSE(picture.curves.empty()) << picture.key;
      for (const Curve& curve : picture.curves) {
        EXPECT_EQ(curve.x.size(), curve.y.size()) << picture.key;
        EXPECT_NE(curve.label, "") << picture.key;
      }
    }
  }
}

/// Nothing is compared a second time: the distances, the band and the place are those of the check.
TEST(Pictures, DrawWhatWasJudged) {
  std::vector<double> time, reference, run;
  for (int i = 0; i <= 100; ++i) {
    time.push_back(0.01 * i);
    reference.push_back(i % 7);
    run.push_back(reference.back() + (i == 60 ? 3.0 : 0.5));
  }
  score::Check check = score::AtMost("golden T", "tube", 3.0, 1.0, "half-widths", "a test");
  check.stated = "golden";
  check.evidence = score::BandEvidence({"T", "N m", "golden", "run"}, score::Evidence::Rule::kEverySample,
                                       {time, reference}, {time, run}, 1.0);
  ASSERT_NE(check.evidence, nullptr);
  Rig rig;
  rig.outputs.emplace_back().name = "T";
  RunPictures pictures;
  AddComparisons(rig, {&check, 1}, pictures);
  const Picture *distances = Find(pictures, "distances"), *close_up = Find(pictures, "close_up:T");
  ASSERT_TRUE(distances != nullptr && close_up != nullptr);
  EXPECT_EQ(distances->curves.at(0).label, "golden T");
  EXPECT_EQ(distances->curves[0].y, check.evidence->distance);
  EXPECT_EQ(close_up->curves.at(0).y, check.evidence->test);
  EXPECT_EQ(close_up->curves.at(1).y, check.evidence->reference);
  EXPECT_NEAR(close_up->marks.at(0).at, 0.6, 1e-12);
  EXPECT_THAT(close_up->title, ::testing::HasSubstr("leaves the tube around the golden trace"));

  check.verdict = score::Verdict::kPass;
  RunPictures passed;
  AddComparisons(rig, {&check, 1}, passed);
  EXPECT_EQ(Find(passed, "close_up:T"), nullptr) << "what passed needs no close-up";
}

/// At rest, sides touch at the half gap; at speed, with damping c, later or earlier by what the law says.
TEST(Pictures, ActivationAreasAreThoseOfTheLaw) {
  const auto prepared = Shipped("backlash/experiment_1.toml", {"run.duration_s=0.2", "check=[]"});
  const Result<RunPictures> run = PicturesOf(*prepared);
  ASSERT_TRUE(run.ok());
  const Picture* plane = Find(*run, "phase_plane:phase_plane");
  ASSERT_NE(plane, nullptr);
  ASSERT_EQ(plane->areas.size(), 2u);
  const double half_gap = 0.09599310885968812, k = 15e3, c = 0.5;
  const Area& plus = plane->areas[0];
  for (std::size_t i = 0; i + 2 < plus.x.size(); ++i) {
    const double rate = plus.y[i];
    // (3.4): contact is lost where k (d - alpha) + c w = 0, and made at alpha, as the exponential is nothing by then.
    const double expected = rate <= 0.0 ? half_gap - c / k * rate : half_gap;
    EXPECT_NEAR(plus.x[i], expected, 1e-9) << "at " << rate << " rad/s";
  }
}

TEST(Pictures, TheOpenLoopIsThatOfTheStudies) {
  const auto prepared = Shipped("suppression/unsuppressed.toml", {"run.duration_s=0.1", "check=[]"});
  const Result<RunPictures> run = PicturesOf(*prepared);
  ASSERT_TRUE(run.ok());
  const Picture* poles = Find(*run, "loop_poles");
  ASSERT_NE(poles, nullptr);
  const Curve& curve = poles->curves.front();
  EXPECT_NEAR(curve.y[0], 831.7, 0.1);  // the thesis' second resonance grows by 14.9 1/s
  EXPECT_NEAR(curve.x[0], 14.9, 0.1);
  EXPECT_NEAR(curve.y[1], 605.8, 0.1);
  EXPECT_NEAR(curve.x[1], 8.2, 0.1);
  EXPECT_NE(Find(*run, "nyquist"), nullptr);
}

}  // namespace
}  // namespace dynoproof
