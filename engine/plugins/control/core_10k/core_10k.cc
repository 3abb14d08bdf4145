#include "plugins/control/core_10k/core_10k.h"

#include <cstring>

namespace dynoproof::controls {
namespace {

using control10k::CoreState;

constexpr int kStateSize = static_cast<int>(sizeof(CoreState) / sizeof(double));

}  // namespace

PluginInfo Core10k::Info() {
  return {"control",
          "core_10k",
          "the 10 kHz core: speed control, torque feedthrough, adaptive notch filters",
          "T_ref = k_P e + k_I int e - k_V H_1 .. H_n T_shaft, e = omega_ref - omega; filters placed by Fig. 5.17",
          "thesis (2.3), (5.1), (5.23)-(5.37), Appendices D, E",
          {}};
}

void Core10k::Params::Check(Faults& faults) const {
  const auto& c = core.suppression;
  if (c.f_min_Hz >= c.f_max_Hz) {
    faults.At("f_max_Hz", fmt::format("f_min_Hz is {} and f_max_Hz is {}", c.f_min_Hz, c.f_max_Hz), "f_min < f_max");
  } else if (!control10k::IsUsable(core)) {
    faults.At("bins", "the numbers do not fit together",
              "frequencies below half the sampling rate, 2 bins < block, edges smaller than bins");
  }
}

std::unique_ptr<Core10k> Core10k::Create(const Params& params, const Value& table, BuildContext& context) {
  control10k::CoreConfig config = params.core;
  const Value* period = table.Find("period_s");
  config.suppression.period_s = period != nullptr && period->is_number() ? period->number() : context.period_s;
  if (!control10k::IsUsable(config)) {
    context.diagnostics.Error(table.where(),
                              fmt::format("{}: a frequency lies above half the sampling rate", context.context),
                              "a shorter period_s, or lower frequencies");
    return nullptr;
  }
  if (config.suppression.radius < control10k::kSmallestAdvisableRadius) {
    const Value* radius = table.Find("radius");
    context.diagnostics.Warning(
        radius != nullptr ? radius->where() : table.where(),
        fmt::format(
            "a pole radius of {} amplifies noise: at {} Hz the gain at half the sampling rate is {:.2f}",
            config.suppression.radius, config.suppression.f_min_Hz,
            control10k::NyquistGain(2.0 * 3.14159265358979 * config.suppression.f_min_Hz * config.suppression.period_s,
                                    config.suppression.radius)),
        fmt::format("stay above {} (thesis Appendix D)", control10k::kSmallestAdvisableRadius));
  }
  return std::make_unique<Core10k>(config);
}

Core10k::Core10k(const control10k::CoreConfig& config) : core_(config) {
  layout_.inputs = {{"T_shaft", "N m", "shaft torque, positive when the rotor drives the device", 1000.0},
                    {"omega", "rad/s", "speed of the rotor", 100.0},
                    {"omega_ref", "rad/s", "set point of the speed", 100.0},
                    {"k_V", "1", "feedthrough gain", 1.0},
                    {"adapt", "1", "adaptation on above 0.5", 1.0}};
  layout_.outputs = {{"T_ref", "N m", "torque that is asked of the machine", 1000.0},
                     {"T_filtered", "N m", "shaft torque behind the notch filters", 1000.0}};
  for (int i = 1; i <= config.suppression.notches; ++i) {
    layout_.outputs.push_back(
        {fmt::format("notch_{}_Hz", i), "Hz", fmt::format("frequency of notch filter {}", i), 1000.0});
    layout_.outputs.push_back(
        {fmt::format("eta_{}", i), "N m", fmt::format("amplitude stored with filter {}", i), 100.0});
  }
  layout_.outputs.push_back({"placements", "1", "placements so far", 1.0});
  layout_.outputs.push_back(
      {"outcome", "1", "of the last block: 1 quiet, 2 edge, 3 mixed, 4 moving, 5 weaker, 6 placed", 1.0});
  layout_.outputs.push_back({"found_Hz", "Hz", "frequency of the largest line of the last block", 1000.0});
  layout_.outputs.push_back({"found_Nm", "N m", "amplitude of that line", 100.0});
  layout_.states.push_back({"started", "1", "0 before the first tick", 1.0});
  for (int i = 0; i < kStateSize; ++i) {
    layout_.states.push_back({fmt::format("core[{}]", i), "1", "memory of the core", 1.0});
  }
}

void Core10k::Report(const CoreState& state, std::span<double> outputs) const {
  std::size_t next = 0;
  outputs[next++] = state.T_ref_Nm;
  outputs[next++] = state.T_filtered_Nm;
  for (int i = 0; i < core_.config().suppression.notches; ++i) {
    outputs[next++] = state.suppression.f_Hz[i];
    outputs[next++] = state.suppression.eta_Nm[i];
  }
  outputs[next++] = state.suppression.placements;
  outputs[next++] = state.suppression.outcome;
  outputs[next++] = state.suppression.found_Hz;
  outputs[next++] = state.suppression.found_Nm;
}

void Core10k::Output(const View& view, std::span<double> outputs) const {
  CoreState state;
  core_.Start(state);
  if (view.states[0] != 0.0) std::memcpy(static_cast<void*>(&state), view.states.data() + 1, sizeof state);
  Report(state, outputs);
}

void Core10k::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  CoreState state;
  if (states[0] == 0.0) {
    core_.Start(state);
    states[0] = 1.0;
  } else {
    std::memcpy(static_cast<void*>(&state), states.data() + 1, sizeof state);
  }
  const std::span<const double> in = view.inputs;
  core_.Step(state, {.omega_ref_rad_per_s = in[2],
                     .omega_rad_per_s = in[1],
                     .T_shaft_Nm = in[0],
                     .k_V = in[3],
                     .adapt = in[4] > 0.5});
  std::memcpy(states.data() + 1, &state, sizeof state);
  Report(state, outputs);
}

}  // namespace dynoproof::controls
