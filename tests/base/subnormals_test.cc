#include "base/subnormals.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/cpu.h"

namespace dynoproof {
namespace {

/// Half of the smallest normal number, computed at run time.
[[maybe_unused]] double HalfOfSmallest() {
  const volatile double smallest = std::numeric_limits<double>::min();
  const volatile double half = smallest * 0.5;
  return half;
}

#if defined(__x86_64__) || defined(__aarch64__)
TEST(FlushSubnormals, HoldsInItsScopeAndRestores) {
  EXPECT_NE(HalfOfSmallest(), 0.0);
  {
    const FlushSubnormals outer;
    EXPECT_EQ(HalfOfSmallest(), 0.0);
    {
      const FlushSubnormals inner;
      EXPECT_EQ(HalfOfSmallest(), 0.0);
    }
    EXPECT_EQ(HalfOfSmallest(), 0.0);  // the inner one restores what it found, not the standard
  }
  EXPECT_NE(HalfOfSmallest(), 0.0);
}
#endif

TEST(CpuClass, NamesAreDistinctAndTheMachineHasOne) {
  EXPECT_EQ(CpuFeatureClass(), ToString(DetectCpuClass()));
  EXPECT_EQ(ToString(CpuClass::kAvx2Fma), "x86-64-avx2-fma");
  EXPECT_EQ(ToString(CpuClass::kAvx512), "x86-64-avx512");
  EXPECT_FALSE(ToString(CpuClass::kBaseline).empty());
}

}  // namespace
}  // namespace dynoproof
