#include "plugins/actuator/static_stages/static_stages.h"

#include <algorithm>
#include <cmath>

namespace dynoproof::stages {

PluginInfo Saturation::Info() {
  return {"actuator", "saturation", "limited magnitude", "out = clamp(in, -limit, limit)", "definition", {}};
}

PluginInfo DeadZone::Info() {
  return {"actuator",   "dead_zone", "nothing within a band, shifted outside", "out = sgn(in) max(|in| - width/2, 0)",
          "definition", {}};
}

PluginInfo Harmonic::Info() {
  return {"actuator",
          "harmonic",
          "second and third harmonic of a sine",
          "out = u + h2 u^2/u_n + h3 u^3/u_n^2",
          "thesis Sec. 2.2 (an airgap torque that is not perfectly sinusoidal)",
          {}};
}

Saturation::Saturation(const Params& params, const BuildContext& context)
    : StaticStage(context.nominal), limit_(params.limit) {
  layout_.guards = 2;
}

double Saturation::Map(double, double in) const { return std::clamp(in, -limit_, limit_); }

void Saturation::Guards(const View& view, std::span<double> values) const {
  values[0] = limit_ - view.inputs[0];
  values[1] = limit_ + view.inputs[0];
}

DeadZone::DeadZone(const Params& params, const BuildContext& context)
    : StaticStage(context.nominal), half_(0.5 * params.width) {
  layout_.guards = 2;
}

double DeadZone::Map(double, double in) const { return in - std::clamp(in, -half_, half_); }

void DeadZone::Guards(const View& view, std::span<double> values) const {
  values[0] = half_ - view.inputs[0];
  values[1] = half_ + view.inputs[0];
}

Harmonic::Harmonic(const Params& params, const BuildContext& context)
    : StaticStage(context.nominal),
      h2_(params.h2),
      h3_(params.h3),
      nominal_(params.nominal > 0.0 ? params.nominal : context.nominal) {}

double Harmonic::Map(double, double in) const {
  const double u = in / nominal_;
  return in * (1.0 + u * (h2_ + u * h3_));
}

}  // namespace dynoproof::stages
