// Records that the engine itself makes: a scenario's own run with something hidden in it, and noise on its outputs.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/random.h"
#include "experiment/checks.h"
#include "experiment/records.h"
#include "scenario/load.h"
#include "score/series.h"
#include "tests/support/registry.h"
#include "tests/support/run_plan.h"

namespace dynoproof::estimation {

/// A scenario, as it stands, with changes ("run.duration_s=1").
inline Plan Scenario(const std::string& file, const std::vector<std::string>& changes = {}) {
  Diagnostics diagnostics;
  std::optional<Plan> plan = LoadPlan(file, changes, diagnostics);
  EXPECT_TRUE(plan.has_value()) << diagnostics.Format();
  return plan ? *plan : Plan();
}

/// The soft rotor of the diagnosis under a torque that swings twice a second, so that friction is seen in both directions.
inline Plan Reversing() {
  return Scenario("scenarios/diagnose/r2r_soft.toml",
                  {"run.duration_s=2", "input.T_airgap.source.sources.1.frequencies_Hz=[2.0]",
                   "input.T_airgap.source.sources.1.amplitudes=[40.0]",
                   "input.T_airgap.source.sources.1.phases_rad=[1.5707963267948966]"});
}

/// A motor that is turned by two radians within these seconds, in a model that has no numbers of its own: its current holds it.
inline Plan HeldMotor(int duration_s) {
  const std::string end = std::to_string(duration_s) + ".0";
  return Scenario(
      "tests/real/cogging_standstill.toml",
      {"run.duration_s=" + end, "input.x.source.times_s=[0.0, " + end + "]", "input.x.source.values=[0.0, 2.0]",
       "input.v.source.times_s=[0.0, " + end + "]",
       "input.v.source.values=[" + std::to_string(2.0 / duration_s) + ", " + std::to_string(2.0 / duration_s) + "]"});
}

inline Plan WithEffect(Plan plan, const std::string& effect, const std::string& at,
                       const std::vector<double>& parameters) {
  const Effect* known = testing::BuiltIns().FindEffect(effect);
  if (known == nullptr) {
    ADD_FAILURE() << effect;
    return plan;
  }
  known->Apply(plan, *ParsePlace(at), parameters);
  return plan;
}

/// The run of a plan as a record of these outputs with noise of `share` of each output's spread: white, or of a first-order lag
/// with this pole.
inline MappedRecord RecordOf(const Plan& plan, double share, const std::vector<std::string>& outputs,
                             std::uint64_t seed = 5, double pole = 0.0) {
  const std::unique_ptr<Rig> rig = testing::RigOf(plan);
  const Samples samples = testing::RunRig(*rig, "realtime");
  MappedRecord record;
  const auto time = std::make_shared<const std::vector<double>>(samples.time);
  for (std::size_t i = 0; i < rig->inputs.size(); ++i)
    record.inputs[rig->inputs[i].name] = {time, std::make_shared<const std::vector<double>>(samples.inputs[i])};
  for (std::size_t j = 0; j < rig->outputs.size(); ++j) {
    const std::string& name = rig->outputs[j].name;
    if (std::find(outputs.begin(), outputs.end(), name) == outputs.end()) continue;
    std::vector<double> values = samples.outputs[j];
    const double sigma = share * score::StandardDeviation(values);
    double noise = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      noise = pole * noise + std::sqrt(1.0 - pole * pole) * RandomNormal(seed, j, i);
      values[i] += sigma * noise;
    }
    record.outputs[name] = {time, std::make_shared<const std::vector<double>>(std::move(values))};
  }
  record.end_s = samples.time.back();
  for (auto* signals : {&record.inputs, &record.outputs}) {
    for (const auto& [name, series] : *signals) record.step_s[name] = Seconds(rig->period);
  }
  return record;
}

/// Every n-th sample of a record, as a slower logger keeps them.
inline MappedRecord Slower(MappedRecord record, std::size_t n) {
  for (auto* signals : {&record.inputs, &record.outputs}) {
    for (auto& [name, series] : *signals) {
      std::vector<double> time, values;
      for (std::size_t i = 0; i < series.time->size(); i += n) {
        time.push_back((*series.time)[i]);
        values.push_back((*series.values)[i]);
      }
      series = {std::make_shared<const std::vector<double>>(std::move(time)),
                std::make_shared<const std::vector<double>>(std::move(values))};
      record.step_s[name] *= static_cast<double>(n);
    }
  }
  return record;
}

/// Lets the sensor of an output warm up, within a fifth of the record, by so many times the output's spread.
inline void WarmUp(MappedRecord& record, const std::string& output, double size) {
  Series& series = record.outputs.at(output);
  std::vector<double> values = *series.values;
  const double height = size * score::StandardDeviation(values);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] -= height * std::expm1(-(*series.time)[i] / (0.2 * record.end_s));
  series.values = std::make_shared<const std::vector<double>>(std::move(values));
}

/// Adds a tone to an output, with an amplitude of so many times its spread.
inline void AddTone(MappedRecord& record, const std::string& output, double frequency_hz, double size) {
  Series& series = record.outputs.at(output);
  std::vector<double> values = *series.values;
  const double amplitude = size * score::StandardDeviation(values);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] += amplitude * std::sin(2.0 * std::numbers::pi * frequency_hz * (*series.time)[i] + 0.4);
  series.values = std::make_shared<const std::vector<double>>(std::move(values));
}

}  // namespace dynoproof::estimation
