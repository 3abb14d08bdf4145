#include "plugins/actuator/play/play.h"

#include <algorithm>

namespace dynoproof::stages {

PluginInfo Play::Info() {
  return {
      "actuator",   "play", "what is moved follows only beyond a play", "out = clamp(y, in - width/2, in + width/2)",
      "definition", {}};
}

Play::Play(const Params& params, const BuildContext& context) : Stage(context.nominal), half_(0.5 * params.width) {
  if (half_ == 0.0) return;
  layout_.states = {{"y", "1", "position of what is moved, in the signal's unit", context.nominal}};
  layout_.modes = 1;  // the side that it touches: -1, 1, or 0 in between
}

void Play::Start(std::span<const double> inputs, std::span<double> states, std::span<int>) const {
  if (half_ > 0.0) states[0] = inputs[0];
}

void Play::Output(const View& view, std::span<double> outputs) const {
  const double in = view.inputs[0];
  // Written so, and not as std::clamp, an input that is no number is passed on.
  outputs[0] = half_ > 0.0 ? std::max(in - half_, std::min(view.states[0], in + half_)) : in;
}

void Play::Derivative(const View&, std::span<double> rates) const {
  if (half_ > 0.0) rates[0] = 0.0;
}

void Play::OnEvent(const View& view, int, std::span<double> states, std::span<int> modes) const {
  const double low = view.inputs[0] - half_, high = view.inputs[0] + half_;
  modes[0] = view.states[0] < low ? -1 : view.states[0] > high ? 1 : 0;
  states[0] = std::clamp(view.states[0], low, high);
}

}  // namespace dynoproof::stages
