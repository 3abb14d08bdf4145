#include "plugins/actuator/rate_limited_lag/rate_limited_lag.h"

#include <algorithm>

namespace dynoproof::stages {

PluginInfo RateLimitedLag::Info() {
  return {"actuator",
          "rate_limited_lag",
          "first-order lag with a largest rate: a positioner",
          "d(out)/dt = clamp((in - out)/tau, -rate, rate)",
          "definition",
          {}};
}

RateLimitedLag::RateLimitedLag(const Params& params, const BuildContext& context)
    : Stage(context.nominal), tau_(params.tau_s), rate_(params.rate_per_s), start_(params.start) {
  if (tau_ == 0.0) return;
  layout_.states = {{"out", "1", "position, in the signal's unit", context.nominal}};
}

void RateLimitedLag::Start(std::span<const double> inputs, std::span<double> states, std::span<int>) const {
  if (tau_ > 0.0) states[0] = start_.empty() ? inputs[0] : start_[0];
}

void RateLimitedLag::Output(const View& view, std::span<double> outputs) const {
  outputs[0] = tau_ > 0.0 ? view.states[0] : view.inputs[0];
}

void RateLimitedLag::Derivative(const View& view, std::span<double> rates) const {
  if (tau_ > 0.0) rates[0] = std::clamp(Wanted(view), -rate_, rate_);
}

}  // namespace dynoproof::stages
