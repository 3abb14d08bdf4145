// The shaft torque of a shipped scenario that was changed.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "experiment/checks.h"
#include "experiment/prepare.h"
#include "sim/simulate.h"
#include "sim/solver.h"
#include "tests/support/registry.h"

namespace dynoproof {

/// By solver `realtime`, [steps + 1]; empty, with a failure of the test, where it cannot be run.
inline std::vector<double> ShaftTorqueOf(const std::string& scenario, const std::vector<std::string>& changes) {
  Diagnostics diagnostics;
  const auto prepared =
      Prepare("scenarios/" + scenario + ".toml", {changes, "", nullptr}, testing::FullRegistry(), diagnostics);
  if (prepared == nullptr) {
    ADD_FAILURE() << diagnostics.Format();
    return {};
  }
  const auto solver = MakeSolver("realtime", *prepared->rig);
  const auto samples = Simulate(*prepared->rig, **solver);
  if (!samples.ok()) {
    ADD_FAILURE() << samples.failure().ToString();
    return {};
  }
  return samples->outputs[static_cast<std::size_t>(FindOutput(*prepared->rig, "T_shaft"))];
}

}  // namespace dynoproof
