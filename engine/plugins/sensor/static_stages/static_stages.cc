#include "plugins/sensor/static_stages/static_stages.h"

namespace dynoproof::stages {

PluginInfo Offset::Info() { return {"sensor", "offset", "a constant error", "out = in + offset", "definition", {}}; }

PluginInfo Drift::Info() { return {"sensor", "drift", "an error that grows", "out = in + slope t", "definition", {}}; }

PluginInfo Rectified::Info() { return {"sensor", "rectified", "magnitude only", "out = |in|", "definition", {}}; }

}  // namespace dynoproof::stages
