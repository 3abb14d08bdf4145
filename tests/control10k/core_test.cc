// The control law, that a step takes no memory, and that a state is an array.
#include "control10k/core.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>

#include "control10k/torque_control.h"
#include "tests/support/count_allocations.h"

namespace control10k {
namespace {

using dynoproof::testing::allocations;

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
  const long before = allocations;
  for (int n = 0; n < 20000; ++n) core.Step(state, {10.0, 9.0, Torque(n), 9.7, true});
  EXPECT_EQ(allocations, before);
  const auto taken = std::make_unique<int>(1);
  EXPECT_GT(allocations, before);  // the counter does count
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

TorqueConfig SmallMachine() {
  TorqueConfig config;
  config.machine = {.R_s = 3.9,
                    .R_R = 2.6,
                    .L_M = 0.236,
                    .L_sigma = 0.03,
                    .pole_pairs = 2.0,
                    .rated_flux = 0.73,
                    .rated_i_d = 3.1,
                    .rated_i_q = 6.04,
                    .rated_peak_current = 6.79};
  return config;
}

TEST(TorqueControl, AStepTakesNoMemory) {
  const TorqueControl control(SmallMachine());
  TorqueState state;
  const long before = allocations;
  for (int n = 0; n < 20000; ++n) control.Step(state, {std::sin(0.01 * n), 3.0, 0.01 * n, 10.0});
  EXPECT_EQ(allocations, before);
}

TEST(TorqueControl, VoltageAndCurrentStayWithinTheirLimits) {
  const TorqueControl control(SmallMachine());
  TorqueState state;
  for (int n = 0; n < 2000; ++n) {
    const TorqueOutputs out = control.Step(state, {1e6, 0.0, 0.0, 100.0});  // asks for far too much, no current comes
    EXPECT_LE(std::hypot(out.u_alpha_V, out.u_beta_V), 565.0 / std::sqrt(3.0) + 1e-9);
    EXPECT_LE(out.i_q_set_A, 2.0 * 6.79);
    EXPECT_TRUE(std::isfinite(out.u_alpha_V));
  }
}

TEST(TorqueControl, RefusesAMachineThatIsNone) {
  EXPECT_TRUE(IsUsable(SmallMachine()));
  TorqueConfig config = SmallMachine();
  config.machine.L_sigma = 0.0;
  EXPECT_FALSE(IsUsable(config));
  config = SmallMachine();
  config.overload = 0.5;
  EXPECT_FALSE(IsUsable(config));
  EXPECT_FALSE(IsUsable(TorqueConfig{}));
}

}  // namespace
}  // namespace control10k
