// NRMSE, largest error and the gain-offset-shift fit: hand values, recovery, and what must never pass.
#include "score/nrmse.h"

#include <gtest/gtest.h>

#include "score/align.h"
#include "tests/score/signals.h"

namespace dynoproof::score {
namespace {

TEST(Nrmse, ByHand) {
  // Standard deviation of {1, -1, 1, -1} is 1; errors {0.1, 0.1, 0.1, 0.7}: RMS sqrt(0.52 / 4).
  const Signal reference{{0, 1, 2, 3}, {1, -1, 1, -1}}, test{{0, 1, 2, 3}, {1.1, -0.9, 1.1, -0.3}};
  const NrmseResult r = Nrmse(reference.View(), test.View(), {.limit = 0.37});
  ASSERT_TRUE(r.nrmse.has_value());
  EXPECT_NEAR(*r.nrmse, std::sqrt(0.13), 1e-15);
  EXPECT_TRUE(r.ok());
  EXPECT_NEAR(r.max_error, 0.7, 1e-15);
  EXPECT_EQ(r.max_error_time_s, 3.0);
  const NrmseResult tight = Nrmse(reference.View(), test.View(), {.limit = 0.36});
  EXPECT_FALSE(tight.ok());
  EXPECT_TRUE(IsOneLine(tight.reason));
  EXPECT_EQ(NrmseCheck(tight, {.limit = 0.36}, "a", "b").verdict, Verdict::kFail);
}

TEST(Nrmse, MeanOfTheReferenceAloneGivesOne) {
  const Signal reference = Sampled(1000, 0.01, [](double t) { return 3.0 + std::sin(7 * t) + t; });
  Signal mean = reference;
  for (double& v : mean.v) v = Mean(reference.v);
  EXPECT_NEAR(*Nrmse(reference.View(), mean.View(), {.limit = 2.0}).nrmse, 1.0, 1e-12);
}

TEST(Nrmse, ConstantReferencePassesOnlyWithinItsOwnLimit) {
  const Signal flat = Sampled(50, 0.1, [](double) { return 5.0; });
  const Signal near = Sampled(50, 0.1, [](double) { return 5.002; });
  NrmseOptions options{.limit = 1e9};
  EXPECT_FALSE(Nrmse(flat.View(), flat.View(), options).ok());  // no limit was stated for this case
  options.nominal = 10.0;
  options.constant_limit = 1e-3;  // 0.01 allowed
  const NrmseResult r = Nrmse(flat.View(), near.View(), options);
  EXPECT_TRUE(r.ok()) << r.reason;
  EXPECT_FALSE(r.nrmse.has_value());
  const Check check = NrmseCheck(r, options, "a", "b");
  EXPECT_EQ(check.verdict, Verdict::kPass);
  EXPECT_NEAR(check.value, 0.0002, 1e-12);
  options.constant_limit = 1e-4;
  EXPECT_FALSE(Nrmse(flat.View(), near.View(), options).ok());
  const Signal rounded = Sampled(50, 0.1, [](double t) { return 5.0 + (t > 2 ? 1e-15 : 0.0); });
  EXPECT_FALSE(Nrmse(rounded.View(), near.View(), options).ok());  // constant within round-off
}

TEST(MaxError, ByHandAndOnTheEdge) {
  const Signal reference{{0, 1, 2}, {0, 0, 0}}, test{{0, 1, 2}, {0.5, -2.0, 1.0}};
  const MaxErrorResult r = MaxError(reference.View(), test.View(), 4.0, 0.5);
  EXPECT_TRUE(r.ok());
  EXPECT_DOUBLE_EQ(r.relative_error, 0.5);
  EXPECT_EQ(r.time_s, 1.0);
  EXPECT_FALSE(MaxError(reference.View(), test.View(), 4.0, 0.4999).ok());
}

TEST(Fit, RecoversGainOffsetAndSubSampleShift) {
  const auto law = [](double t) {
    return std::sin(2 * kPi * 5 * t) + 0.5 * std::cos(2 * kPi * 13.7 * t + t * t) + 4.0;
  };
  const Signal reference = Sampled(2000, 1e-3, law);
  for (double shift : {-0.0371234, -0.0004, 0.0, 0.00025, 0.0123, 0.1}) {
    const Signal test = Sampled(2000, 1e-3, [&](double t) { return 1.7 * law(t - shift) - 2.0; });
    const AlignmentFit fit = FitGainOffsetShift(reference.View(), test.View());
    ASSERT_TRUE(fit.ok()) << fit.reason;
    // The ripple of the windowed sinc is about 1e-5 (Kaiser, 8): times gain, level 4, and a slope of 1/50 a sample.
    EXPECT_NEAR(fit.shift_s, shift, 1e-6);
    EXPECT_NEAR(fit.gain, 1.7, 1e-4);
    EXPECT_NEAR(fit.offset, -2.0, 4e-4);
    EXPECT_LT(fit.unexplained, 1e-8);
  }
}

TEST(Fit, PeriodicSignalGivesTheSmallestShift) {
  const Signal reference = Sampled(1000, 1e-2, [](double t) { return std::sin(2 * kPi * t); });
  const Signal test = Sampled(1000, 1e-2, [](double t) { return std::sin(2 * kPi * (t - 0.1)); });
  EXPECT_NEAR(FitGainOffsetShift(reference.View(), test.View(), {.gain = false, .offset = false}).shift_s, 0.1, 1e-6);
}

TEST(Fit, FixedParametersStayFixed) {
  const Signal reference = Sampled(300, 1e-2, [](double t) { return 1.0 + std::sin(3 * t); });
  const Signal test = Sampled(300, 1e-2, [](double t) { return 2.0 + 2.0 * std::sin(3 * t); });
  const AlignmentFit gain = FitGainOffsetShift(reference.View(), test.View(), {.offset = false, .shift = false});
  EXPECT_NEAR(gain.gain, 2.0, 1e-12);
  EXPECT_EQ(gain.offset, 0.0);
  EXPECT_EQ(gain.shift_s, 0.0);
  const AlignmentFit offset = FitGainOffsetShift(reference.View(), test.View(), {.gain = false, .shift = false});
  EXPECT_EQ(offset.gain, 1.0);
  EXPECT_NEAR(offset.offset, Mean(test.v) - Mean(reference.v), 1e-12);
}

TEST(Nrmse, NothingUnsoundPasses) {
  const Signal good = Sampled(100, 0.01, [](double t) { return std::sin(20 * t); });
  const NrmseOptions wide{.limit = 1e9, .nominal = 1.0, .constant_limit = 1e9};
  const auto both = [&](const Bad& bad, const Series& a, const Series& b) {
    const NrmseResult n = Nrmse(a, b, wide);
    const MaxErrorResult m = MaxError(a, b, 1.0, 1e9);
    const AlignmentFit f = FitGainOffsetShift(a, b);
    EXPECT_FALSE(n.ok()) << bad.what;
    EXPECT_FALSE(m.ok()) << bad.what;
    EXPECT_FALSE(f.ok()) << bad.what;
    EXPECT_TRUE(IsOneLine(n.reason) && IsOneLine(m.reason) && IsOneLine(f.reason)) << bad.what;
    EXPECT_EQ(NrmseCheck(n, wide, "a", "b").verdict, Verdict::kFail);
  };
  for (const Bad& bad : Gallery(good)) {
    both(bad, bad.signal.View(), good.View());
    both(bad, good.View(), bad.signal.View());
  }
  for (const Bad& bad : Uncovering(good)) both(bad, good.View(), bad.signal.View());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Nrmse(good.View(), good.View(), {.limit = nan}).ok());
  EXPECT_FALSE(MaxError(good.View(), good.View(), nan, 1.0).ok());
  EXPECT_FALSE(MaxError(good.View(), good.View(), 0.0, 1.0).ok());
  EXPECT_FALSE(MaxError(good.View(), good.View(), 1.0, nan).ok());
  Signal uneven = good;
  uneven.t[50] += 0.003;
  EXPECT_FALSE(FitGainOffsetShift(uneven.View(), good.View()).ok());
}

}  // namespace
}  // namespace dynoproof::score
