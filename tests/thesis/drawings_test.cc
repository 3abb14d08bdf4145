// The figures that show a formula: each drawing against a property that the formula has to have.
#include "thesis/drawings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control10k/classical.h"
#include "tests/support/registry.h"
#include "thesis/distributed.h"

namespace dynoproof {
namespace {

Picture Drawn(const std::string& name) {
  Result<Picture> picture = Drawings().at(name)(testing::FullRegistry());
  EXPECT_TRUE(picture.ok()) << picture.failure().ToString();
  return picture.ok() ? *picture : Picture{};
}

const Curve& Labelled(const Picture& picture, const std::string& label) {
  static const Curve none;
  const auto found = std::ranges::find(picture.curves, label, &Curve::label);
  EXPECT_NE(found, picture.curves.end()) << label;
  return found == picture.curves.end() ? none : *found;
}

TEST(Drawings, EachHasLabelsUnitsAndNumbers) {
  for (const auto& [name, drawing] : Drawings()) {
    const Picture picture = Drawn(name);
    EXPECT_NE(picture.title, "") << name;
    ASSERT_FALSE(picture.curves.empty()) << name;
    for (const Axis& axis : {picture.x, picture.y}) EXPECT_TRUE(axis.label != "" && axis.unit != "") << name;
    for (const Curve& curve : picture.curves) {
      EXPECT_NE(curve.label, "") << name;
      EXPECT_EQ(curve.x.size(), curve.y.size()) << name;
      EXPECT_FALSE(curve.x.empty()) << name << " " << curve.label;
    }
  }
}

/// Sturm: mode n of a chain has n changes of sign, and its angular momentum is zero.
TEST(Drawings, ModeShapesOfTheChainChangeSignOnceMoreEach) {
  const Picture picture = Drawn("mode_shapes");
  ASSERT_EQ(picture.curves.size(), 4u);
  const double inertia[] = {25.082, 6.352, 1.572, 0.159, 0.140};  // Table A.1
  const char* labels[] = {"390.8 Hz", "548.7 Hz", "713.9 Hz", "1558.5 Hz"};
  for (std::size_t n = 0; n < 4; ++n) {
    const Curve& mode = picture.curves[n];
    EXPECT_EQ(mode.label, labels[n]);
    ASSERT_EQ(mode.y.size(), 5u);
    int changes = 0;
    double momentum = 0.0;
    for (std::size_t i = 0; i < 5; ++i) {
      momentum += inertia[i] * mode.y[i];
      if (i > 0 && mode.y[i] * mode.y[i - 1] < 0.0) ++changes;
    }
    EXPECT_EQ(changes, static_cast<int>(n) + 1);
    EXPECT_NEAR(momentum, 0.0, 1e-10);  // round-off of an eigenvector
  }
}

/// The roots are the exact eigenfrequencies of a rotor with a pinned inertia, found by counting.
TEST(Drawings, SpatialEquationMeetsAtTheExactEigenfrequencies) {
  const Picture picture = Drawn("spatial_equation");
  const Curve& roots = Labelled(picture, "eigenfrequencies");
  const auto exact = mechanics::ExactEigenfrequencies({25.308, 16.5e6, 0.0, 0.394, {}}, 2000.0);
  ASSERT_TRUE(exact.ok());
  ASSERT_EQ(roots.x.size(), 3u);
  for (std::size_t i = 0; i < roots.x.size(); ++i) {
    EXPECT_NEAR(-roots.x[i] / std::tan(roots.x[i]), roots.y[i], 1e-7 * roots.y[i]);
    EXPECT_NEAR(roots.x[i] * std::sqrt(16.5e6 / 25.308) / (2.0 * std::numbers::pi), (*exact)[i], 1e-9 * (*exact)[i]);
  }
}

TEST(Drawings, FrequencyDependentInertiaAddsOneRootBelowThePlainOnes) {
  const Picture picture = Drawn("frequency_dependent_inertia");
  const Curve &roots = Labelled(picture, "roots of (B.4)"), &plain = Labelled(picture, "roots of (2.111)");
  ASSERT_EQ(roots.x.size(), plain.x.size() + 1);
  const double wave = std::sqrt(30e6 / 20.0) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(roots.x[0] * wave, 269.032, 1e-3);
  EXPECT_NEAR(roots.x[1] * wave, 601.923, 1e-3);
  EXPECT_NEAR(plain.x[0] * wave, 601.850, 1e-3);
  for (std::size_t i = 0; i < roots.x.size(); ++i)  // both sides of (B.4) are equal there
    EXPECT_NEAR(-roots.x[i] / std::tan(roots.x[i]), roots.y[i], 1e-6 * std::abs(roots.y[i]));
}

TEST(Drawings, GainsShiftTheMagnitudeAndTheResonancesCrossZeroFirst) {
  const Picture picture = Drawn("loop_gains");
  ASSERT_EQ(picture.curves.size(), 3u);
  const Curve &high = picture.curves[0], &low = picture.curves[2];
  for (std::size_t i = 0; i < high.y.size(); ++i) EXPECT_NEAR(high.y[i] - low.y[i], 20.0 * std::log10(9.7 / 2.1), 1e-9);
  // Of the lowest gain, what is highest is a resonance of Table A.7.
  const auto top = std::ranges::max_element(low.y) - low.y.begin();
  EXPECT_LT(std::min(std::abs(low.x[static_cast<std::size_t>(top)] - 605.1),
                     std::abs(low.x[static_cast<std::size_t>(top)] - 832.2)),
            3.0);
}

/// Table A.7: resonances at 605.1, 832.2 and 1372.8 Hz. The line alone has no zero between the last two and passes -180
/// degrees there; before them it does not.
TEST(Drawings, OnlyTheActuatorOrAShiftedTorqueTurnsThePhaseTo180Degrees) {
  const Picture picture = Drawn("loop_phases");
  const auto crossing = [](const Curve& curve) {
    for (std::size_t i = 0; i < curve.y.size(); ++i) {
      if (curve.y[i] <= -180.0) return curve.x[i];
    }
    return 0.0;
  };
  EXPECT_NEAR(crossing(Labelled(picture, "1: with actuator")), 606.0, 3.0);
  EXPECT_NEAR(crossing(Labelled(picture, "2: line alone")), 1061.0, 15.0);
  EXPECT_NEAR(crossing(Labelled(picture, "3: slices 1 to 18")), 700.0, 15.0);
  const Curve& zeros = Labelled(picture, "zeros, 2: line alone");
  EXPECT_TRUE(std::ranges::any_of(zeros.x, [](double f) { return f > 605.1 && f < 832.2; }));
  EXPECT_TRUE(std::ranges::none_of(zeros.x, [](double f) { return f > 832.2 && f < 1372.8; }));
  // The shifted torque leaves no zero at all in sight, so that nothing brings its phase back.
  EXPECT_TRUE(
      std::ranges::none_of(picture.curves, [](const Curve& c) { return c.label == "zeros, 3: slices 1 to 18"; }));
}

/// Largest value in a stretch of time.
double Peak(const Curve& curve, double from_s, double to_s) {
  double peak = 0.0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (curve.x[i] >= from_s && curve.x[i] < to_s) peak = std::max(peak, std::abs(curve.y[i]));
  }
  return peak;
}

TEST(Drawings, AFilterEndsAnOscillationOfTheLoopAndLeavesOneFromOutside) {
  const Picture resonance = Drawn("filter_on_resonance"), excitation = Drawn("filter_on_excitation");
  const Curve &own = Labelled(resonance, "T_shaft"), &foreign = Labelled(excitation, "T_shaft");
  EXPECT_GT(Peak(own, 0.25, 0.3), 500.0);
  EXPECT_LT(Peak(own, 0.8, 0.9), 0.05 * Peak(own, 0.25, 0.3));
  EXPECT_GT(Peak(foreign, 0.25, 0.3), 100.0);
  EXPECT_GT(Peak(foreign, 0.8, 0.9), 0.5 * Peak(foreign, 0.25, 0.3));
}

/// The filters of the law (5.13) themselves, on a tone: after 0.2 s nothing is left of the start.
TEST(Drawings, TheBandPassPairHasTheMagnitudesOfTheFiltersThatRun) {
  const Picture picture = Drawn("band_pass_pair");
  const control10k::ClassicalConfig config;
  for (const auto& [label, centre_Hz] : {std::pair{"W_l", 600.0 / config.spread}, {"W_h", 600.0 * config.spread}}) {
    const Curve& curve = Labelled(picture, label);
    for (const double f : {400.0, 545.0, 640.0, 900.0}) {
      const double g = std::tan(std::numbers::pi * centre_Hz * config.period_s);
      control10k::StateVariable filter;
      double low = 0.0, band = 0.0, cosine = 0.0, sine = 0.0;
      constexpr int kSettled = 2000, kCounted = 2000;  // 400 Hz to 900 Hz in steps of 5 Hz: whole turns
      for (int n = 0; n < kSettled + kCounted; ++n) {
        const double phase = 2.0 * std::numbers::pi * f * config.period_s * n;
        filter.Step(std::sin(phase), g, config.damping, low, band);
        if (n < kSettled) continue;
        cosine += band * std::cos(phase);
        sine += band * std::sin(phase);
      }
      const double magnitude = 2.0 / kCounted * std::hypot(cosine, sine) * 2.0 * config.damping;
      EXPECT_NEAR(curve.y[static_cast<std::size_t>(f - 300.0)], magnitude, 1e-6) << label << " " << f;
    }
  }
  // Fig. 5.10: the tone lies above the middle, so that the upper filter gives more.
  EXPECT_GT(Labelled(picture, "W_h").y[340], Labelled(picture, "W_l").y[340]);
}

/// The largest bin is the one next to the tone; without a window every bin has something of it, (5.16).
TEST(Drawings, ATonesBinsLieOnItsLobes) {
  for (const auto& [name, height] : {std::pair{"plain_tone", 128.0}, {"windowed_tone", 0.42 * 128.0}}) {
    const Picture picture = Drawn(name);
    const Curve &bins = Labelled(picture, "bins"), &lobes = Labelled(picture, "between the bins");
    ASSERT_EQ(bins.y.size(), 25u);
    EXPECT_EQ(std::ranges::max_element(bins.y) - bins.y.begin(), 10);
    EXPECT_NEAR(*std::ranges::max_element(lobes.y), height, 1e-9 * height) << name;
    for (std::size_t k = 0; k < bins.y.size(); ++k) {
      const double away = 10.3 - static_cast<double>(k), x = std::numbers::pi * away;
      if (name == std::string("plain_tone")) {
        EXPECT_NEAR(bins.y[k], std::abs(std::sin(x) / std::sin(x / 128.0)), 1e-9) << k;
      } else if (std::abs(away) > 3.0) {  // beyond the main lobe: below -58 dB
        EXPECT_LT(bins.y[k], 1.3e-3 * height) << k;
      }
    }
  }
}

TEST(Drawings, TheLineOfTheOffsetLeavesItsInverseBeyondHalfABinOnly) {
  const Picture picture = Drawn("offset_of_bins");
  const Curve &inverse = Labelled(picture, "exact inverse"), &line = Labelled(picture, "0.75 b");
  double within = 0.0, beyond = 0.0;
  for (std::size_t i = 0; i < inverse.y.size(); ++i) {
    double& worst = std::abs(inverse.y[i]) < 0.5 ? within : beyond;
    worst = std::max(worst, std::abs(line.y[i] - inverse.y[i]));
  }
  EXPECT_LT(within, 0.0083);  // 5.26-almost-identical: 0.0082 bin
  EXPECT_GT(beyond, 5.0 * within);
}

TEST(Drawings, TheGaussianMeetsTheLobeAtItsTopAndOneBinAway) {
  const Picture picture = Drawn("lobe_and_gaussian");
  const Curve &lobe = Labelled(picture, "lobe"), &gaussian = Labelled(picture, "Gaussian, (5.28)");
  for (const auto& [at, height] : {std::pair{350u, 42.0}, {250u, 25.0}, {450u, 25.0}}) {
    EXPECT_NEAR(lobe.y[at], height, 1e-9);
    EXPECT_NEAR(gaussian.y[at], height, 1e-9);
  }
  EXPECT_GT(gaussian.y[50], lobe.y[50] + 0.1);  // three bins away the lobe has ended
}

TEST(Drawings, NotchHasItsZerosOnTheUnitCircleAndItsPolesWithin) {
  const Picture picture = Drawn("notch_poles");
  const double angle = 2.0 * std::numbers::pi * 832.0 * 1e-4;
  for (const auto& [label, radius] :
       {std::pair{"zeros", 1.0}, {"poles, r = 0.995", 0.995}, {"poles, r = 0.95", 0.95}}) {
    const Curve& roots = Labelled(picture, label);
    ASSERT_EQ(roots.x.size(), 2u) << label;
    EXPECT_NEAR(std::hypot(roots.x[0], roots.y[0]), radius, 1e-12) << label;
    EXPECT_NEAR(std::atan2(roots.y[0], roots.x[0]), angle, 1e-9) << label;
    EXPECT_EQ(roots.y[1], -roots.y[0]) << label;
  }
}

}  // namespace
}  // namespace dynoproof
