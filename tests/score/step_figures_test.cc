// Step and ramp figures against closed forms, with and without noise, and what must never pass.
#include "score/step_figures.h"

#include <gtest/gtest.h>

#include "tests/score/signals.h"

namespace dynoproof::score {
namespace {

constexpr double kZeta = 0.3, kOmega = 20.0, kStepTime = 0.5;

// A second-order step response from 10 to 10 + height.
Signal SecondOrder(double height, double noise = 0.0, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double wd = kOmega * std::sqrt(1 - kZeta * kZeta);
  return Sampled(4001, 5e-4, [&](double t) {
    const double s = t - kStepTime;
    const double y =
        s <= 0 ? 0 : 1 - std::exp(-kZeta * kOmega * s) * (std::cos(wd * s) + kZeta * kOmega / wd * std::sin(wd * s));
    return 10.0 + height * y + noise * normal(random);
  });
}

TEST(Step, SecondOrderRisingAndFalling) {
  for (double height : {4.0, -4.0}) {
    const StepFigures f = AnalyseStep(SecondOrder(height).View(), {.step_time_s = kStepTime, .target = 10.0 + height});
    ASSERT_TRUE(f.ok()) << f.reason;
    // The steady value still rings with exp(-0.3 * 20 * 1.35) = 3e-4 when the last part starts.
    EXPECT_NEAR(f.steady, 10.0 + height, 4.0 * 3e-4);
    EXPECT_NEAR(f.step, height, 4.0 * 3e-4);
    EXPECT_NEAR(*f.steady_error, 0.0, 4.0 * 3e-4);
    EXPECT_NEAR(f.overshoot_percent, 100 * std::exp(-kPi * kZeta / std::sqrt(1 - kZeta * kZeta)), 0.1);
    EXPECT_NEAR(f.peak_time_s, kPi / (kOmega * std::sqrt(1 - kZeta * kZeta)), 5e-4);  // one sample
    EXPECT_EQ(f.undershoot_percent, 0.0);
    // Solved numerically from the closed form, scaled time omega t: 10 % at 0.4873, 90 % at 1.8095; last 2 % at 11.22.
    EXPECT_NEAR(f.rise_time_s, (1.8095 - 0.4873) / kOmega, 1e-3);
    EXPECT_NEAR(f.settling_time_s, 11.22 / kOmega, 5e-3);
  }
}

TEST(Step, FirstOrderByHand) {
  const double tau = 0.1;
  const Signal s =
      Sampled(2001, 1e-3, [&](double t) { return t < 0.2 ? 1.0 : 3.0 - 2.0 * std::exp(-(t - 0.2) / tau); });
  const StepFigures f = AnalyseStep(s.View(), {.step_time_s = 0.2, .settling_band = 0.05});
  ASSERT_TRUE(f.ok()) << f.reason;
  EXPECT_NEAR(f.rise_time_s, tau * std::log(9.0), 1e-4);  // linear interpolation over a hundredth of tau
  EXPECT_NEAR(f.settling_time_s, tau * std::log(20.0), 1e-4);
  EXPECT_NEAR(f.overshoot_percent, 0.0, 1e-4);  // the last part is not quite at the end of the exponential
}

TEST(Step, UndershootOfANonMinimumPhasePlant) {
  const Signal s = Sampled(3001, 1e-3, [](double t) {
    return t < 1 ? 0.0 : 1.0 - std::exp(-(t - 1) / 0.1) - 4.0 * (t - 1) * std::exp(-(t - 1) / 0.05) / 0.1;
  });
  const StepFigures f = AnalyseStep(s.View(), {.step_time_s = 1.0});
  ASSERT_TRUE(f.ok()) << f.reason;
  EXPECT_NEAR(f.undershoot_percent, -100.0 * *std::min_element(s.v.begin(), s.v.end()),
              1e-6);  // exp(-18) is still to come at the end
  EXPECT_GT(f.undershoot_percent, 10.0);
}

TEST(Step, NoiseFollowsTheStatedRule) {
  const StepFigures clean = AnalyseStep(SecondOrder(4.0).View(), {.step_time_s = kStepTime});
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const double sigma = 0.02;  // 0.5 % of the step
    const StepFigures f = AnalyseStep(SecondOrder(4.0, sigma, seed).View(), {.step_time_s = kStepTime});
    ASSERT_TRUE(f.ok()) << f.reason;
    EXPECT_NEAR(f.noise_sigma, sigma,
                0.3 * sigma);  // 400 differences, of which the median deviation: 15 % at two sigma
    EXPECT_NEAR(f.steady, 14.0, 0.01);
    // The median of five leaves 0.54 sigma, its largest of many near the peak two or three of these; 1.6 sigma are
    // taken off.
    EXPECT_NEAR(f.overshoot_percent, clean.overshoot_percent, 1.0);
    EXPECT_EQ(f.undershoot_percent, 0.0);
    EXPECT_NEAR(f.rise_time_s, clean.rise_time_s, 2e-3);
    EXPECT_NEAR(f.settling_time_s, clean.settling_time_s, 0.17);  // half a period of the ringing, pi / wd
  }
}

TEST(Step, LoneOutliersDoNotCountInNoise) {
  Signal s = SecondOrder(4.0, 0.02, 4);
  const StepFigures before = AnalyseStep(s.View(), {.step_time_s = kStepTime});
  s.v[2500] += 50.0;
  s.v[4000] += 50.0;
  const StepFigures after = AnalyseStep(s.View(), {.step_time_s = kStepTime});
  ASSERT_TRUE(after.ok()) << after.reason;
  EXPECT_NEAR(after.overshoot_percent, before.overshoot_percent, 0.1);
  EXPECT_NEAR(after.steady, before.steady, 0.01);
}

TEST(Step, NoStepUnsettledOrOutsideFails) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const Signal noise = Sampled(1000, 0.01, [&](double) { return normal(random); });
  EXPECT_FALSE(AnalyseStep(noise.View(), {.step_time_s = 5.0}).ok());
  const Signal flat = Sampled(1000, 0.01, [](double) { return 2.0; });
  EXPECT_FALSE(AnalyseStep(flat.View(), {.step_time_s = 5.0}).ok());
  const Signal ramp = Sampled(1000, 0.01, [](double t) { return std::max(0.0, t - 5.0); });
  const StepFigures f = AnalyseStep(ramp.View(), {.step_time_s = 5.0});
  EXPECT_FALSE(f.ok());
  EXPECT_NE(f.reason.find("not settled"), std::string::npos) << f.reason;
  for (double when : {-1.0, 2.0, 1e9, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_FALSE(AnalyseStep(SecondOrder(4.0).View(), {.step_time_s = when}).ok());
}

TEST(Ramp, TrackingErrorOfAFirstOrderLag) {
  // Behind a ramp of slope b a lag tau trails by b tau (1 - exp(-t/tau)).
  const double tau = 0.05;
  for (double slope : {3.0, -3.0}) {
    const Signal command = Sampled(1001, 1e-3, [&](double t) { return 7.0 + slope * t; });
    const Signal response =
        Sampled(501, 2e-3, [&](double t) { return 7.0 + slope * (t - tau * (1 - std::exp(-t / tau))); });
    const RampFigures f = AnalyseRamp(command.View(), response.View(), {.from_s = 0, .to_s = 1});
    ASSERT_TRUE(f.ok()) << f.reason;
    EXPECT_NEAR(f.steady_error, slope * tau, 1e-6);
    EXPECT_NEAR(f.delay_s, tau, 1e-6);
    EXPECT_NEAR(f.command_slope, slope, 1e-12);
    EXPECT_NEAR(f.response_slope, slope, 1e-4);  // exp(-10) of transient over the last half
    EXPECT_NEAR(f.largest_error, std::abs(slope) * tau, 1e-6);
  }
}

TEST(StepAndRamp, NothingUnsoundPasses) {
  const Signal good = SecondOrder(4.0);
  for (const Bad& bad : Gallery(good)) {
    const StepFigures f = AnalyseStep(bad.signal.View(), {.step_time_s = kStepTime});
    EXPECT_FALSE(f.ok()) << bad.what;
    EXPECT_TRUE(IsOneLine(f.reason));
    const RampOptions ramp{.from_s = 0, .to_s = 2};
    EXPECT_FALSE(AnalyseRamp(bad.signal.View(), good.View(), ramp).ok()) << bad.what;
    EXPECT_FALSE(AnalyseRamp(good.View(), bad.signal.View(), ramp).ok()) << bad.what;
  }
  const RampOptions ramp{.from_s = 0, .to_s = 2};
  for (const Bad& bad : Uncovering(good))
    EXPECT_FALSE(AnalyseRamp(good.View(), bad.signal.View(), ramp).ok()) << bad.what;
  EXPECT_FALSE(AnalyseRamp(good.View(), good.View(), {.from_s = 1, .to_s = 1}).ok());
  EXPECT_FALSE(AnalyseRamp(good.View(), good.View(), {.from_s = 0, .to_s = 9}).ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(AnalyseRamp(good.View(), good.View(), {.from_s = nan, .to_s = 1}).ok());
  EXPECT_FALSE(AnalyseStep(good.View(), {.step_time_s = kStepTime, .settling_band = nan}).ok());
  EXPECT_FALSE(AnalyseStep(good.View(), {.step_time_s = kStepTime, .start = nan}).ok());
}

}  // namespace
}  // namespace dynoproof::score
