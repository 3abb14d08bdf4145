// The realtime solver's period allocates nothing: linear lines, nonlinear laws, sticking friction, delays and stages
// alike.
#include "tests/support/count_allocations.h"
#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

namespace dynoproof::testing {
namespace {

long AllocationsOfAHundredPeriods(const Plan& plan) {
  const std::unique_ptr<Rig> rig = RigOf(plan);
  if (rig == nullptr) return -1;
  Result<std::unique_ptr<Solver>> solver = MakeRealtimeSolver(*rig);
  if (!solver.ok()) return -1;
  Simulation simulation(*rig, **solver);
  if (simulation.Start()) return -1;
  const auto periods = [&simulation](int count) {
    for (int i = 0; i < count; ++i) {
      if (simulation.Tick() || simulation.Integrate()) return false;
    }
    return true;
  };
  if (!periods(10)) return -1;
  const long before = allocations;
  if (!periods(100)) return -1;
  return allocations - before;
}

TEST(RealtimeHeap, TheCounterCounts) {
  const long before = allocations;
  const auto memory = std::make_unique<int>(1);
  EXPECT_GT(allocations, before);
}

TEST(RealtimeHeap, LinearLine) { EXPECT_EQ(AllocationsOfAHundredPeriods(SoftPlan()), 0); }

TEST(RealtimeHeap, NonlinearLawsStagesAndDelays) {
  Plan plan = LumpedPlan();
  plan.root["plant"]["load"]["dry"] =
      Value{{"on", "I5"}, {"law", "stribeck"}, {"T_c_Nm", 3.0}, {"T_s_Nm", 5.0}, {"w_s_rad_per_s", 0.1}};
  plan.root["plant"]["load"]["dahl"] = Value{{"on", "I4"}, {"law", "dahl"}, {"F_c_Nm", 4.0}, {"sigma_Nm_per_rad", 1e4}};
  plan.root["plant"]["shaft"]["k2"]["law"] = Value("cubic_spring");
  plan.root["plant"]["shaft"]["k2"]["k3_Nm_per_rad3"] = Value(1e9);
  plan.root["input"]["T_airgap"]["actuator"] = Value(Value::Array{Value{{"type", "delay"}, {"delay_s", 1.7e-4}},
                                                                  Value{{"type", "first_order_lag"}, {"tau_s", 1e-3}},
                                                                  Value{{"type", "saturation"}, {"limit", 0.8}}});
  plan.root["output"]["omega_1"]["sensor"] = Value(Value::Array{Value{{"type", "delay"}, {"delay_s", 0.4e-4}}});
  EXPECT_EQ(AllocationsOfAHundredPeriods(plan), 0);
}

TEST(RealtimeHeap, EquationsThatAScenarioWritesDown) { EXPECT_EQ(AllocationsOfAHundredPeriods(EquationsPlan()), 0); }

TEST(RealtimeHeap, ContactsInAGap) {
  for (const char* law : {"phase_plane", "full_state_backlash"}) {
    Plan plan = PlayPlan();
    plan.root["plant"]["shaft"]["k2"]["law"] = Value(law);
    plan.root["plant"]["shaft"]["k2"]["half_gap_rad"] = Value(2e-3);
    if (std::string_view(law) == "full_state_backlash") {
      plan.root["plant"]["shaft"]["k2"]["contact_free_damping_Nms_per_rad"] = Value(0.1);
    }
    EXPECT_EQ(AllocationsOfAHundredPeriods(plan), 0) << law;  // the first contact is at 5 ms
  }
}

}  // namespace
}  // namespace dynoproof::testing
