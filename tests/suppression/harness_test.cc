// The engine runs exactly the core that a target would: what the stand-alone harness answers to the samples of a run is
// what the run commanded, bit for bit.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "base/subnormals.h"
#include "experiment/prepare.h"
#include "sim/simulate.h"
#include "sim/solver.h"
#include "tests/support/build.h"

namespace dynoproof {
namespace {

std::vector<double> AskHarness(const std::vector<double>& numbers) {
  const std::string in = ::testing::TempDir() + "core_in.bin", out = ::testing::TempDir() + "core_out.bin";
  std::ofstream(in, std::ios::binary)
      .write(reinterpret_cast<const char*>(numbers.data()),
             static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  const std::string command = std::string(DYNOPROOF_CORE_HARNESS) + " < " + in + " > " + out;
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream file(out, std::ios::binary | std::ios::ate);
  std::vector<double> answer(static_cast<std::size_t>(file.tellg()) / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(answer.data()), static_cast<std::streamsize>(answer.size() * sizeof(double)));
  std::remove(in.c_str());
  std::remove(out.c_str());
  return answer;
}

TEST(Core, InTheEngineIsBitForBitThatOfTheHarness) {
  Diagnostics diagnostics;
  const auto prepared = Prepare("scenarios/suppression/adaptive.toml",
                                {{"check=[]", "run.duration_s=1.2"}, "", nullptr}, testing::BuiltIns(), diagnostics);
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

}  // namespace
}  // namespace dynoproof
