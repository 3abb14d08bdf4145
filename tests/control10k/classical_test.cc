// The adaptive notch filters of Sec. 5.3: each finds a lone tone from nearby, stands still where it should, and keeps
// its bounds whatever it hears.
#include "control10k/classical.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"

namespace control10k {
namespace {

constexpr double kPeriod = 1e-4, kTone_Hz = 600.0;

struct Case {
  ClassicalLaw law;
  double mu, radius;
  double bias_Hz;  // what the law leaves on a clean tone
  const char* name;
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
// mu: so that each needs some thousand samples. The complex notch hears a real tone as two, which shifts it; the pair
// swings by its increment over the samples that it looks back.
const Case kCases[] = {{ClassicalLaw::kComplexGradient, 0.01, 0.98, 15.0, "complex_gradient"},
                       {ClassicalLaw::kContinuousGradient, 1e-3, 0.98, 3.0, "continuous_gradient"},
                       {ClassicalLaw::kBalance, 1e-3, 0.98, 3.0, "balance"},
                       {ClassicalLaw::kLms, 1e-7, 0.9, 3.0, "lms"},
                       {ClassicalLaw::kBandPassPair, 0.0, 0.98, 5.0, "band_pass_pair"}};

class ClassicalLaws : public ::testing::TestWithParam<Case> {
 protected:
  ClassicalConfig Config(double initial_Hz) const {
    ClassicalConfig config;
    config.law = GetParam().law;
    config.mu = GetParam().mu;
    config.radius = GetParam().radius;
    config.notches = 1;
    config.initial_Hz = initial_Hz;
    config.increment_Hz = 0.05;
    return config;
  }
};

double Tone(int n) { return 100.0 * std::sin(2.0 * std::numbers::pi * kTone_Hz * kPeriod * n); }

double FrequencyOf(const ClassicalState& state) { return state.notch[0].nu_0 / (2.0 * std::numbers::pi * kPeriod); }

TEST_P(ClassicalLaws, FindALoneToneFromBothSides) {
  for (const double initial_Hz : {540.0, 660.0}) {
    const Classical filter(Config(initial_Hz));
    ASSERT_TRUE(IsUsable(filter.config()));
    ClassicalState state;
    filter.Start(state);
    double left = 0.0;
    for (int n = 0; n < 60000; ++n) {
      const double y = filter.Step(state, Tone(n), true);
      if (n >= 50000) left = std::max(left, std::abs(y));
    }
    EXPECT_NEAR(FrequencyOf(state), kTone_Hz, GetParam().bias_Hz) << "from " << initial_Hz;
    EXPECT_LT(left, 100.0) << "the tone comes through undiminished";
  }
}

TEST_P(ClassicalLaws, StandStillWhenTheyAreNotToAdapt) {
  const Classical filter(Config(700.0));
  ClassicalState state;
  filter.Start(state);
  const double before = FrequencyOf(state);
  for (int n = 0; n < 5000; ++n) filter.Step(state, Tone(n), false);
  EXPECT_EQ(FrequencyOf(state), before);
}

TEST_P(ClassicalLaws, KeepTheirBoundsUnderNoiseAndSilence) {
  const ClassicalConfig config = Config(600.0);
  const Classical filter(config);
  ClassicalState state;
  filter.Start(state);
  for (int n = 0; n < 20000; ++n) {
    const double torque = n < 10000 ? 100.0 * dynoproof::RandomNormal(1, 0, static_cast<std::uint64_t>(n)) : 0.0;
    ASSERT_TRUE(std::isfinite(filter.Step(state, torque, true)));
    ASSERT_GE(FrequencyOf(state), config.lowest_Hz * (1.0 - 1e-12));
    ASSERT_LE(FrequencyOf(state), config.highest_Hz * (1.0 + 1e-12));
  }
}

INSTANTIATE_TEST_SUITE_P(Thesis, ClassicalLaws, ::testing::ValuesIn(kCases),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace control10k
