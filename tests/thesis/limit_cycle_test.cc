// The describing function of the torque limit against its Fourier integral, and the limit cycle that it predicts against
// the loop's own run.
#include "thesis/limit_cycle.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "base/subnormals.h"
#include "experiment/prepare.h"
#include "experiment/run_scenario.h"
#include "tests/support/registry.h"
#include "thesis/tone.h"

namespace dynoproof {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi, kPeriod_s = 1e-4;

TEST(SaturationGain, IsTheFundamentalOfTheLimitedSine) {
  for (const double a : {0.5, 1.0, 1.2, 2.0, 10.0}) {
    double sum = 0.0;
    constexpr int kPoints = 100'000;
    for (int i = 0; i < kPoints; ++i) {
      const double s = std::sin(kTurn * (i + 0.5) / kPoints);
      sum += std::clamp(a * s, -1.0, 1.0) * s;
    }
    // The midpoint rule errs by the kinks, of second order: 1e-9.
    EXPECT_NEAR(SaturationGain(a), 2.0 * sum / kPoints / a, 1e-8) << a;
  }
}

Result<std::vector<FilteredLoopMode>> IdleModes(double k_V) {
  control10k::NotchCoefficients idle;
  EXPECT_TRUE(control10k::DesignNotch(kTurn * 1500.0 * kPeriod_s, 0.995, idle));
  return FilteredLoopModes(R2RPlant(), k_V, 0, {idle, idle});
}

TEST(LimitCycle, IsWhereTheLoopWithTheLagEnds) {
  const auto predicted = PredictLimitCycle(IdleModes, 9.7, 832.0, 4000.0);
  ASSERT_TRUE(predicted.ok());
  const FlushSubnormals flush;
  control10k::CoreConfig config;
  config.speed = {20.0, 20.0, 4000.0};
  auto loop = SuppressionLoop::Create(R2RPlant(), config);
  ASSERT_TRUE(loop.ok());
  std::vector<double> last;
  for (int n = 0; n < 30'000; ++n) {
    loop->Step(0.0, RandomNormal(5, 0, static_cast<std::uint64_t>(n)), 9.7, false);
    if (n >= 28'000) last.push_back(loop->T_shaft_Nm());
  }
  const Tone tone = StrongestTone(last, kPeriod_s, predicted->frequency_Hz, 20.0);
  // What the describing function leaves out: the third harmonic comes back through the line with 1e-3 of the fundamental.
  EXPECT_NEAR(tone.frequency_Hz, predicted->frequency_Hz, 0.1);
  EXPECT_NEAR(tone.amplitude / predicted->T_shaft_Nm, 1.0, 0.01);
}

TEST(LimitCycle, NeedsAModeThatGrowsAndFallsWithTheGain) {
  EXPECT_FALSE(PredictLimitCycle(IdleModes, 2.1, 832.0, 4000.0).ok()) << "nothing grows at 2.1";
  using Modes = std::vector<FilteredLoopMode>;
  const auto always = [](double) -> Result<Modes> { return Modes{{600.0, 1.0}}; };
  EXPECT_FALSE(PredictLimitCycle(always, 2.1, 600.0, 4000.0).ok());
}

/// The verdicts on frequency and amplitude of suppression/limit_cycle_machine when these are expected.
std::vector<score::Verdict> Judged(double frequency_Hz, double amplitude) {
  Diagnostics diagnostics;
  const std::string check = fmt::format(
      "check=[{{ kind = \"oscillation\", signal = \"T_shaft\", frequency_Hz = {}, amplitude = {}, during_s = [1.0, "
      "1.2], "
      "tolerance_Hz = 0.3, tolerance = 0.01, origin = \"test\" }}]",
      frequency_Hz, amplitude);
  const auto prepared = Prepare("scenarios/suppression/limit_cycle_machine.toml",
                                {{check, "run.duration_s=1.3"}, "", nullptr}, testing::FullRegistry(), diagnostics);
  EXPECT_NE(prepared, nullptr) << diagnostics.Format();
  RunOptions options;
  options.out = "";
  std::vector<score::Verdict> verdicts;
  for (const score::Check& one : RunScenario(*prepared, options).checks) verdicts.push_back(one.verdict);
  return verdicts;
}

TEST(OscillationCheck, SeesAnotherFrequencyAndAnotherAmplitude) {
  using enum score::Verdict;
  EXPECT_EQ(Judged(603.92, 686.3), (std::vector{kPass, kPass}));
  EXPECT_EQ(Judged(604.32, 686.3), (std::vector{kFail, kPass}));
  EXPECT_EQ(Judged(603.92, 700.1), (std::vector{kPass, kFail}));
}

}  // namespace
}  // namespace dynoproof
