#include "plugins/control/encoder/encoder.h"

#include <cmath>
#include <numbers>

namespace dynoproof::controls {

PluginInfo Encoder::Info() {
  return {"control",
          "encoder",
          "speed from the steps of a rotary encoder, counted over a period",
          "n = floor(angle N/(2 pi)), speed = 2 pi (n - n_before)/(N period)",
          "thesis Secs. 2, 2.1.1, Tables 2.3, 2.6 (speed by rotary encoder)",
          {}};
}

Encoder::Encoder(const Params& params, const BuildContext& context)
    : steps_per_rad_(params.steps_per_turn / (2.0 * std::numbers::pi)),
      speed_per_step_(1.0 / (steps_per_rad_ * context.period_s)),
      initial_speed_(params.initial_speed_rad_per_s) {
  layout_.inputs = {{"angle", "rad", "angle of the shaft", 1.0}};
  layout_.outputs = {{"speed", "rad/s", "speed over the last period", 100.0}};
  layout_.states = {{"begun", "1", "0 before the first tick", 1.0}, {"count", "1", "steps at the last tick", 1e6}};
}

void Encoder::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  const double count = std::floor(view.inputs[0] * steps_per_rad_);
  outputs[0] = states[0] == 0.0 ? initial_speed_ : (count - states[1]) * speed_per_step_;
  states[0] = 1.0;
  states[1] = count;
}

}  // namespace dynoproof::controls
