#include "plugins/control/indication/indication.h"

namespace dynoproof::controls {

PluginInfo Indication::Info() {
  return {"control",
          "indication",
          "evaluates the cylinder pressure, and gives it a period later",
          "out(k) = in(k - 1)",
          "thesis Sec. 6.1.3: the measured pressure is fed back",
          {}};
}

Indication::Indication(const Params&) {
  layout_.inputs = {{"p_evo", "Pa", "pressure as the exhaust opened last", 1e6},
                    {"work", "J", "work of the closed part of that cycle", 1e5}};
  layout_.outputs = layout_.inputs;
  layout_.states = {{"p_evo", "Pa", "seen at the last tick", 1e6},
                    {"work", "J", "seen at the last tick", 1e5},
                    {"begun", "1", "0 before the first tick", 1.0}};
}

void Indication::Output(const View& view, std::span<double> outputs) const {
  const bool begun = view.states[2] != 0.0;
  for (int i = 0; i < 2; ++i) outputs[i] = begun ? view.states[i] : view.inputs[i];
}

void Indication::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  Output(view, outputs);
  for (int i = 0; i < 2; ++i) states[i] = view.inputs[i];
  states[2] = 1.0;
}

}  // namespace dynoproof::controls
