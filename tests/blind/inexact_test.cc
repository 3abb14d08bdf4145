#include "tests/blind/inexact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "score/series.h"

namespace dynoproof::blind {
namespace {

constexpr double kPeriod_s = 1e-3;

/// An input and an output of 4 s, sines of 3 Hz.
Columns Sines() {
  Columns columns;
  for (int i = 0; i < 4000; ++i) {
    columns.time.push_back(i * kPeriod_s);
    columns.inputs["u"].push_back(std::sin(2.0 * std::numbers::pi * 3.0 * columns.time.back()));
  }
  columns.outputs["y"] = columns.inputs["u"];
  return columns;
}

struct Made {
  Case hidden;
  Columns columns;
  std::vector<double> added;  // to the output
};

Made With(const char* what) {
  Made made{.hidden = {}, .columns = Sines(), .added = {}};
  made.hidden.noise = 0.01;
  made.hidden.inexact = {what};
  Dice dice(1, 1);
  RecordInexactly(made.columns, made.hidden, dice);
  const Columns exact = Sines();
  const std::vector<double>&before = exact.outputs.at("y"), &after = made.columns.outputs.at("y");
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) made.added.push_back(after[i] - before[i]);
  return made;
}

TEST(RecordInexactly, SaysHowMuchItShows) {
  const Made hum = With("hum");
  EXPECT_NEAR(hum.hidden.inexact_size, score::RootMeanSquare(hum.added) / (0.01 * std::numbers::sqrt2 / 2.0), 0.1);
  EXPECT_GT(hum.hidden.inexact_size, 0.7);  // the smallest amplitude is a standard deviation of the noise
  EXPECT_TRUE(hum.hidden.near.empty());     // no effect of the list stands for it
}

TEST(RecordInexactly, AFilterIsLateAndStandsForASensorsEffects) {
  const Made filtered = With("filtered");
  EXPECT_TRUE(filtered.hidden.near.contains("output:y"));
  // At frequencies far below its cut-off it passes all, later: y' times a delay of sqrt(2) / (2 pi cut-off).
  const double late = score::RootMeanSquare(filtered.added) / (2.0 * std::numbers::pi * 3.0 * std::sqrt(0.5));
  EXPECT_GT(late, 0.9 * std::numbers::sqrt2 / (2.0 * std::numbers::pi * 150.0));
  EXPECT_LT(late, 1.1 * std::numbers::sqrt2 / (2.0 * std::numbers::pi * 50.0));
}

TEST(Quantise, RoundsToOneStep) {
  Columns columns = Sines();
  Case hidden;
  hidden.noise = 0.01;
  Dice dice(1, 1);
  Quantise(columns, hidden, dice);
  EXPECT_EQ(columns.outputs, Sines().outputs);
  hidden.inexact = {"quantised"};
  Quantise(columns, hidden, dice);
  const std::set<double> values(columns.outputs.at("y").begin(), columns.outputs.at("y").end());
  EXPECT_LT(values.size(), 150U);
  EXPECT_GT(values.size(), 30U);
}

TEST(RecordInexactly, AWarmingSensorComesToRest) {
  const Made drifting = With("drifting");
  EXPECT_NEAR(drifting.added.front(), 0.0, 1e-12);
  EXPECT_GT(std::abs(drifting.added.back()), 0.8 * 0.03 * std::sqrt(0.5));
  EXPECT_LT(std::abs(drifting.added[3999] - drifting.added[3000]), std::abs(drifting.added[999]));
}

TEST(RecordInexactly, AThinnedRecordKeepsWhatItsInputsWereOnAverage) {
  const Made thinned = With("decimated");
  const Columns whole = Sines();
  const std::size_t rows = 4000 / thinned.columns.time.size();
  ASSERT_GE(rows, 2U);
  EXPECT_DOUBLE_EQ(thinned.columns.time[7], whole.time[7 * rows]);
  EXPECT_DOUBLE_EQ(thinned.columns.outputs.at("y")[7], whole.outputs.at("y")[7 * rows]);
  double mean = 0.0;
  for (std::size_t k = 0; k < rows; ++k) mean += whole.inputs.at("u")[7 * rows + k] / static_cast<double>(rows);
  EXPECT_NEAR(thinned.columns.inputs.at("u")[7], mean, 1e-12);
}

TEST(RecordInexactly, NoiseOfAnInputIsInTheRecordAlone) {
  const Made noisy = With("noisy_input");
  EXPECT_EQ(noisy.hidden.inexact_size, 0.0);
  EXPECT_NE(noisy.columns.inputs.at("u"), Sines().inputs.at("u"));
}

TEST(DrawInexact, FrictionThatCreepsIsForHiddenFriction) {
  for (std::uint64_t number = 0; number < 200; ++number) {
    Dice dice(1, number);
    Case hidden;
    hidden.kind = "null";
    hidden.scenario = "diagnose/r2r_soft";
    DrawInexact(hidden, dice);
    ASSERT_TRUE(hidden.inexact.size() == 1 || (hidden.inexact.size() == 2 && hidden.inexact[0] != hidden.inexact[1]));
    for (const std::string& what : hidden.inexact) EXPECT_NE(what, "creeping");
  }
}

}  // namespace
}  // namespace dynoproof::blind
