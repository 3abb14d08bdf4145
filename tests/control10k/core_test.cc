// The control law, that a step takes no memory, and that a state is an array.
#include "control10k/core.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>
#include <cstring>
#include <numbers>

namespace control10k {
namespace {

CoreConfig Plain() {
  CoreConfig config;
  config.speed.k_P_Nms_per_rad = 3.0;
  config.speed.k_I_Nm_per_rad = 20.0;
  return config;
}

TEST(Core, IsThePrintedLawWithTheFeedthroughTurned) {
  const Core core(Plain());
  CoreState state;
  core.Start(state);
  EXPECT_EQ(core.Step(state, {10.0, 8.0, 0.0, 0.0, false}), 6.0);
  EXPECT_DOUBLE_EQ(core.Step(state, {10.0, 8.0, 0.0, 0.0, false}), 6.0 + 20.0 * 1e-4 * 2.0);
  // A steady torque passes the filters: the feedthrough becomes -k_V T_shaft.
  core.Start(state);
  double T = 0.0;
  for (int n = 0; n < 5000; ++n) T = core.Step(state, {0.0, 0.0, 100.0, 4.5, false});
  EXPECT_NEAR(T, -450.0, 1e-8);
}

TEST(Core, TheLimitHoldsAndTheIntegratorRests) {
  CoreConfig config = Plain();
  config.speed.T_limit_Nm = 50.0;
  const Core core(config);
  CoreState state;
  core.Start(state);
  for (int n = 0; n < 20000; ++n) EXPECT_EQ(core.Step(state, {100.0, 0.0, 0.0, 0.0, false}), 50.0);
  EXPECT_EQ(state.speed.integral_Nm, 0.0);
  EXPECT_LT(core.Step(state, {0.0, 1.0, 0.0, 0.0, false}), 0.0);  // no wind-up to come back from
}

double Torque(int n) {
  return 300.0 + 200.0 * std::sin(2 * std::numbers::pi * 0.0832 * n) + 30.0 * std::sin(0.7 * n * n);
}

TEST(Core, AStepTakesNoMemory) {
  const Core core(Plain());
  CoreState state;
  core.Start(state);
  const auto used = [] { return mallinfo2().uordblks; };
  const auto before = used();
  for (int n = 0; n < 20000; ++n) core.Step(state, {10.0, 9.0, Torque(n), 9.7, true});
  EXPECT_EQ(used(), before);
  void* volatile taken = std::malloc(1000);
  EXPECT_GT(used(), before);  // the counter does count
  std::free(taken);
}

TEST(Core, AStateCopiedAndContinuedRepeatsItself) {
  const Core core(Plain());
  CoreState state;
  core.Start(state);
  for (int n = 0; n < 1777; ++n) core.Step(state, {10.0, 9.0, Torque(n), 9.7, true});
  double array[sizeof(CoreState) / sizeof(double)];
  std::memcpy(array, &state, sizeof state);
  double first = 0.0, second = 0.0;
  for (int n = 1777; n < 4000; ++n) first = core.Step(state, {10.0, 9.0, Torque(n), 9.7, true});
  std::memcpy(static_cast<void*>(&state), array, sizeof state);
  for (int n = 1777; n < 4000; ++n) second = core.Step(state, {10.0, 9.0, Torque(n), 9.7, true});
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace control10k
