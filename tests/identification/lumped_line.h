// The scenario that most tests of the diagnosis hide something in.
#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "experiment/checks.h"
#include "experiment/prepare.h"
#include "scenario/load.h"

namespace dynoproof::identification {

/// The lumped heavy-duty line with all built-in plugins and kinds of checks.
class LumpedLine : public ::testing::Test {
 protected:
  LumpedLine() {
    RegisterBuiltIns(registry_);
    RegisterChecks(registry_);
    Diagnostics diagnostics;
    plan_ = LoadPlan("scenarios/diagnose/heavy_duty_lumped.toml", {}, diagnostics);
  }

  Registry registry_;
  std::optional<Plan> plan_;
};

}  // namespace dynoproof::identification
