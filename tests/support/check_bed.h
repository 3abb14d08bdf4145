// Checks on courses made by hand.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "experiment/checks.h"
#include "tests/support/plan_builder.h"
#include "tests/support/registry.h"
#include "tests/support/run_plan.h"

namespace dynoproof::testing {

/// One check on the air path's rig, whose input u_1 and outputs p_ch, p_s are replaced by given courses.
struct CheckBed {
  Plan plan = testing::AirPlan();
  std::unique_ptr<Rig> rig;
  Samples samples;

  explicit CheckBed(Value check) {
    plan.root["check"] = Value::Array{std::move(check)};
    rig = testing::RigOf(plan);
    for (int k = 0; k <= 4000; ++k) samples.time.push_back(0.01 * k);
    samples.inputs.assign(4, std::vector<double>(samples.time.size(), 1.0));
    samples.outputs.assign(2, std::vector<double>(samples.time.size(), 1.0));
  }

  template <class F>
  static void Fill(std::vector<double>& values, const std::vector<double>& time, const F& course) {
    for (std::size_t k = 0; k < time.size(); ++k) values[k] = course(time[k]);
  }
  template <class F>
  void Input(const F& course) {
    Fill(samples.inputs[0], samples.time, course);
  }
  template <class F>
  void Output(int index, const F& course) {
    Fill(samples.outputs[static_cast<std::size_t>(index)], samples.time, course);
  }

  std::vector<score::Check> Run(Figures* figures = nullptr) const {
    Diagnostics diagnostics;
    const auto checks = ReadChecks(plan, *rig, testing::FullRegistry(), diagnostics);
    EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.Format();
    CheckContext context(plan, *rig, samples, "realtime");
    std::vector<score::Check> made = RunChecks(checks, context);
    if (figures != nullptr) *figures = context.figures;
    return made;
  }
};

}  // namespace dynoproof::testing
