// A control alone, tick by tick.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/support/build.h"

namespace dynoproof::testing {

struct Ticking {
  std::unique_ptr<Component> control;
  std::vector<double> states, outputs;
  explicit Ticking(const Value& table, double period_s = 0.01) {
    std::string faults;
    control = Build("control", table, {.period_s = period_s}, &faults);
    EXPECT_NE(control, nullptr) << faults;
    states.assign(control->layout().states.size(), 0.0);
    outputs.assign(control->layout().outputs.size(), 0.0);
  }
  const std::vector<double>& Tick(std::vector<double> inputs) {
    control->Tick({0.0, inputs, states, {}}, states, outputs);
    return outputs;
  }
};

}  // namespace dynoproof::testing
