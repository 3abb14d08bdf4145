#include "plugins/sensor/static_stages/static_stages.h"

namespace dynoproof::stages {

PluginInfo Offset::Info() { return {"sensor", "offset", "a constant error", "out = in + offset", "definition", {}}; }

PluginInfo Drift::Info() { return {"sensor", "drift", "an error that grows", "out = in + slope t", "definition", {}}; }

PluginInfo Rectified::Info() { return {"sensor", "rectified", "magnitude only", "out = |in|", "definition", {}}; }

PluginInfo Range::Info() {
  return {"sensor", "range", "an end to what it shows", "out = clamp(in, low, high)", "definition", {}};
}

void Range::Params::Check(Faults& faults) const {
  if (!(low < high)) faults.At("high", "the range ends where it begins, or below", "give high above low");
}

}  // namespace dynoproof::stages
