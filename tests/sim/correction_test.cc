// A correction is a shift of the states, whatever coordinates a solver has.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "sim/simulate.h"
#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

namespace dynoproof {
namespace {

Plan With(const std::string& law) {
  Plan plan = testing::LumpedPlan();
  plan.root["input"]["T_airgap"]["source"] = Value{{"type", "constant"}, {"value", 80.0}};
  if (law == "friction") plan.root["plant"]["load"]["rubs"] = Value{{"on", "I5"}, {"law", "coulomb"}, {"T_c_Nm", 20.0}};
  return plan;
}

class EachSolver : public ::testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(EachSolver, CorrectsAsItShifts) {
  const auto& [solver_name, law] = GetParam();
  const std::unique_ptr<Rig> rig = testing::RigOf(With(law));
  const auto solver = MakeSolver(solver_name, *rig);
  ASSERT_TRUE(solver.ok());
  const std::size_t n = rig->state_ports.size();
  std::vector<std::vector<double>> gains(2, std::vector<double>(n));
  for (std::size_t i = 0; i < n; ++i) {
    gains[0][i] = 1e-3 * std::sin(1.0 + static_cast<double>(i)) * rig->state_ports[i].nominal;
    gains[1][i] = 1e-3 * std::cos(2.0 * static_cast<double>(i)) * rig->state_ports[i].nominal;
  }
  const std::unique_ptr<Correction> correction = (*solver)->MakeCorrection(gains);
  Simulation corrected(*rig, **solver), shifted(*rig, **solver);
  ASSERT_FALSE(corrected.Start());
  shifted.Restore(corrected.frame());
  for (int step = 0; step < 50; ++step) {
    const std::vector<double> errors = {0.3 * std::sin(0.1 * step), step % 7 == 0 ? 0.0 : 0.2};
    ASSERT_FALSE(corrected.Tick());
    corrected.Correct(*correction, errors);
    ASSERT_FALSE(corrected.Integrate());
    ASSERT_FALSE(shifted.Tick());
    std::vector<double> change(n);
    for (std::size_t i = 0; i < n; ++i) change[i] = gains[0][i] * errors[0] + gains[1][i] * errors[1];
    Frame frame = shifted.frame();
    (*solver)->Shift(frame, change);
    shifted.Restore(frame);
    ASSERT_FALSE(shifted.Integrate());
  }
  const std::vector<double> one = (*solver)->States(corrected.frame()), other = (*solver)->States(shifted.frame());
  // Round-off; `reference` locates events to its tolerance of 1e-9 a step.
  const double allowed = solver_name == "reference" ? 1e-7 : 1e-10;
  for (std::size_t i = 0; i < n; ++i)
    EXPECT_NEAR(one[i], other[i], allowed * rig->state_ports[i].nominal) << rig->state_ports[i].name;
}

INSTANTIATE_TEST_SUITE_P(Correction, EachSolver,
                         ::testing::Values(std::pair("realtime", "linear"), std::pair("realtime", "friction"),
                                           std::pair("reference", "linear"), std::pair("reference", "friction")),
                         [](const auto& one) { return one.param.first + "_" + one.param.second; });

TEST(Correction, OfAnErrorThatWasTakenEarlierIsWhatTheStatesHaveMadeOfIt) {
  // A sensor that is late by 2.6 periods looks at the run between two ticks, where a cut is.
  Plan plan = With("linear");
  plan.root["output"].table().front().value["sensor"] =
      Value(Value::Array{Value{{"type", "delay"}, {"delay_s", 2.6 * plan.root.NumberOr("run.period_s", 1e-4)}}});
  const std::unique_ptr<Rig> rig = testing::RigOf(plan);
  ASSERT_EQ(rig->intervals.size(), 2U);
  const auto solver = MakeSolver("realtime", *rig);
  ASSERT_TRUE(solver.ok());
  std::vector<double> gain(rig->state_ports.size());
  for (std::size_t i = 0; i < gain.size(); ++i)
    gain[i] = 1e-3 * std::sin(1.0 + static_cast<double>(i)) * rig->state_ports[i].nominal;
  Simulation simulation(*rig, **solver);
  ASSERT_FALSE(simulation.Start());
  ASSERT_FALSE(simulation.Tick());
  Frame then = simulation.frame(), later = simulation.frame();
  ASSERT_FALSE((*solver)->Advance(then, 0));
  (*solver)->Shift(then, gain);
  ASSERT_FALSE((*solver)->Advance(then, 1));
  for (const int index : {0, 1}) ASSERT_FALSE((*solver)->Advance(later, index));
  (*solver)->MakeCorrection({gain}, {1})->Apply(later, std::vector<double>{1.0});
  const std::vector<double> one = (*solver)->States(then), other = (*solver)->States(later);
  for (std::size_t i = 0; i < gain.size(); ++i)
    EXPECT_NEAR(one[i], other[i], 1e-10 * rig->state_ports[i].nominal) << rig->state_ports[i].name;
}

TEST(Correction, OnlyALinearRigIsCarriedExactly) {
  const std::unique_ptr<Rig> plain = testing::RigOf(With("linear")), rubs = testing::RigOf(With("friction"));
  EXPECT_TRUE((*MakeSolver("realtime", *plain))->linear());
  EXPECT_FALSE((*MakeSolver("realtime", *rubs))->linear());
}

}  // namespace
}  // namespace dynoproof
