// The engine runs exactly the core that a target would: what the stand-alone harness answers to the samples of a run is
// what the run commanded, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "base/subnormals.h"
#include "experiment/prepare.h"
#include "plugins/plant/induction_machine/rating.h"
#include "sim/simulate.h"
#include "sim/solver.h"
#include "tests/support/build.h"
#include "tests/support/registry.h"
#include "tests/support/run_plan.h"
#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

std::vector<double> AskHarness(const std::vector<double>& numbers, const char* mode = "") {
  const test::TempDir dir;
  const std::string in = dir / "in.bin", out = dir / "out.bin";
  std::ofstream(in, std::ios::binary)
      .write(reinterpret_cast<const char*>(numbers.data()),
             static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  const std::string command = std::string(DYNOPROOF_CORE_HARNESS) + " " + mode + " < " + in + " > " + out;
  EXPECT_EQ(std::system(command.c_str()), 0);
  const std::string bytes = test::ReadBytes(out);
  std::vector<double> answer(bytes.size() / sizeof(double));
  std::memcpy(answer.data(), bytes.data(), answer.size() * sizeof(double));
  return answer;
}

TEST(Core, InTheEngineIsBitForBitThatOfTheHarness) {
  Diagnostics diagnostics;
  const auto prepared =
      Prepare("scenarios/suppression/adaptive.toml", {{"check=[]", "run.duration_s=1.2"}, "", nullptr},
              testing::FullRegistry(), diagnostics);
  ASSERT_NE(prepared, nullptr) << diagnostics.Format();
  const Rig& rig = *prepared->rig;
  const auto solver = MakeSolver("realtime", rig);
  ASSERT_TRUE(solver.ok());
  const auto samples = Simulate(rig, **solver);
  ASSERT_TRUE(samples.ok());
  const auto input = [&](const char* name) { return samples->inputs[static_cast<std::size_t>(FindInput(rig, name))]; };
  const auto output = [&](const char* name) {
    return samples->outputs[static_cast<std::size_t>(FindOutput(rig, name))];
  };
  const std::vector<double> T_shaft = output("T_shaft"), omega = output("omega_1"), omega_ref = input("omega_ref"),
                            k_V = input("k_V"), adapt = input("adapt"), T_ref = input("T_airgap");
  std::vector<double> numbers = {20.0, 20.0, 4000.0};
  for (std::size_t k = 0; k < T_shaft.size(); ++k) {
    // A set point is held at the end of a tick: the core sees that of the tick before. They are constant here.
    numbers.insert(numbers.end(), {omega_ref[k], omega[k], T_shaft[k], k_V[k], adapt[k], 0.0});
  }
  const std::vector<double> answer = AskHarness(numbers);
  ASSERT_EQ(answer.size(), T_ref.size());
  EXPECT_EQ(answer, T_ref);  // 12001 steps with both placements: equal, not close
  EXPECT_GT(output("notch_2").back(), 600.0);
  EXPECT_LT(output("notch_2").back(), 612.0);
}

TEST(Core10k, WarnsOfARadiusThatAmplifiesNoise) {
  std::string faults;
  EXPECT_NE(testing::Build("control", {{"type", "core_10k"}, {"radius", 0.94}}, {}, &faults), nullptr);
  EXPECT_NE(faults.find("amplifies noise"), std::string::npos) << faults;
  EXPECT_NE(testing::Build("control", {{"type", "core_10k"}, {"radius", 0.95}}, {}, &faults), nullptr);
  EXPECT_EQ(faults, "");
}

TEST(TorqueControl, InTheEngineIsBitForBitThatOfTheHarness) {
  Diagnostics diagnostics;
  auto prepared =
      Prepare("scenarios/backlash/experiment_1.toml", {{"check=[]", "variant={}", "run.duration_s=0.3"}, "", nullptr},
              testing::FullRegistry(), diagnostics);
  ASSERT_NE(prepared, nullptr) << diagnostics.Format();
  Value& outputs = prepared->plan.root["output"];
  outputs["i_a"] = Value{{"of", "part.im1.i_alpha"}};
  outputs["i_b"] = Value{{"of", "part.im1.i_beta"}};
  outputs["u_a"] = Value{{"of", "control.im1.u_alpha"}};
  const std::unique_ptr<Rig> rig = testing::RigOf(std::move(prepared->plan));
  const Samples samples = testing::RunRig(*rig, "realtime");
  const auto output = [&](const char* name) {
    return samples.outputs.at(static_cast<std::size_t>(FindOutput(*rig, name)));
  };
  const std::vector<double> i_a = output("i_a"), i_b = output("i_b"), speed = output("omega_1"), u_a = output("u_a"),
                            set = samples.inputs.at(static_cast<std::size_t>(FindInput(*rig, "T_1_set")));
  Rating plate;
  plate.rated_torque_Nm = 12.0;
  plate.rated_speed_rad_per_s = 171.2;
  plate.rated_voltage_V = 390.0;
  plate.rated_current_A = 4.8;
  control10k::MachineModel m;
  ASSERT_TRUE(plate.Derive(m));
  std::vector<double> numbers = {
      m.R_s, m.R_R, m.L_M, m.L_sigma, m.pole_pairs, m.rated_flux, m.rated_i_d, m.rated_i_q, m.rated_peak_current, -1.0};
  // A set point is held at the end of a tick: the control sees that of the tick before.
  for (std::size_t k = 0; k < u_a.size(); ++k) {
    numbers.insert(numbers.end(), {set[k == 0 ? 0 : k - 1], i_a[k], i_b[k], speed[k]});
  }
  std::vector<double> answer = AskHarness(numbers, "torque");
  ASSERT_EQ(answer.size(), u_a.size());
  // What a tick puts out is sampled at the next.
  answer.insert(answer.begin(), u_a.front());
  answer.pop_back();
  EXPECT_EQ(answer, u_a);  // 3001 steps with the jump of the torque: equal, not close
  EXPECT_GT(*std::max_element(u_a.begin(), u_a.end()), 10.0);
}

}  // namespace
}  // namespace dynoproof
