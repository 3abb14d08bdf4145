#include "plugins/control/classical_core/classical_core.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numbers>

namespace dynoproof::controls {
namespace {

using control10k::ClassicalLaw;

struct Memory {
  double started = 0.0, T_ref_Nm = 0.0, T_filtered_Nm = 0.0;
  control10k::SpeedState speed;
  control10k::ClassicalState filter;
};
constexpr int kSize = static_cast<int>(sizeof(Memory) / sizeof(double));

control10k::ClassicalConfig ConfigOf(const ClassicalCore::Params& params, double period_s) {
  static constexpr std::array kNames = {"complex_gradient", "continuous_gradient", "balance", "lms", "band_pass_pair"};
  control10k::ClassicalConfig config = params.filter;
  config.law = static_cast<ClassicalLaw>(std::find(kNames.begin(), kNames.end(), params.law) - kNames.begin());
  config.period_s = period_s;
  return config;
}

}  // namespace

PluginInfo ClassicalCore::Info() {
  return {"control",
          "classical_core",
          "speed control with a classical adaptive notch filter",
          "T_ref = k_P e + k_I int e - k_V H_1 .. H_n T_shaft; notch frequencies by a gradient law or a band-pass pair",
          "thesis (2.3), (5.4), (5.6), (5.7), (5.8)-(5.12), (5.13)-(5.14)",
          {}};
}

void ClassicalCore::Params::Check(Faults& faults) const {
  if (!control10k::IsUsable(ConfigOf(*this, filter.period_s))) {
    faults.At("initial_Hz", "the frequencies do not fit together",
              "lowest <= initial <= highest, and highest times spread below half the sampling rate");
  }
}

ClassicalCore::ClassicalCore(const Params& params, const BuildContext& context)
    : speed_(params.speed), filter_(ConfigOf(params, context.period_s)) {
  layout_.inputs = {{"T_shaft", "N m", "shaft torque, positive when the rotor drives the device", 1000.0},
                    {"omega", "rad/s", "speed of the rotor", 100.0},
                    {"omega_ref", "rad/s", "set point of the speed", 100.0},
                    {"k_V", "1", "feedthrough gain", 1.0},
                    {"adapt", "1", "adaptation on above 0.5", 1.0}};
  layout_.outputs = {{"T_ref", "N m", "torque that is asked of the machine", 1000.0},
                     {"T_filtered", "N m", "shaft torque behind the notch filters", 1000.0}};
  for (int i = 1; i <= params.filter.notches; ++i) {
    layout_.outputs.push_back(
        {fmt::format("notch_{}_Hz", i), "Hz", fmt::format("frequency of notch filter {}", i), 1000.0});
  }
  for (int i = 0; i < kSize; ++i) {
    layout_.states.push_back({fmt::format("core[{}]", i), "1", "memory of the filters and the speed control", 1.0});
  }
}

void ClassicalCore::Output(const View& view, std::span<double> outputs) const {
  Memory memory;
  std::memcpy(static_cast<void*>(&memory), view.states.data(), sizeof memory);
  if (memory.started == 0.0) filter_.Start(memory.filter);
  outputs[0] = memory.T_ref_Nm;
  outputs[1] = memory.T_filtered_Nm;
  for (int i = 0; i < filter_.config().notches; ++i) {
    outputs[2 + i] = memory.filter.notch[i].nu_0 / (2.0 * std::numbers::pi * filter_.config().period_s);
  }
}

void ClassicalCore::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  Memory memory;
  std::memcpy(static_cast<void*>(&memory), states.data(), sizeof memory);
  if (memory.started == 0.0) {
    memory = {};
    filter_.Start(memory.filter);
    memory.started = 1.0;
  }
  const std::span<const double> in = view.inputs;
  memory.T_filtered_Nm = filter_.Step(memory.filter, in[0], in[4] > 0.5);
  memory.T_ref_Nm =
      control10k::SpeedStep(speed_, memory.speed, filter_.config().period_s, in[2], in[1], in[3], memory.T_filtered_Nm);
  std::memcpy(states.data(), &memory, sizeof memory);
  Output({view.time_s, view.inputs, states, view.modes}, outputs);
}

}  // namespace dynoproof::controls
