#include "plugins/sensor/sampled_stages/sampled_stages.h"

#include <cmath>

#include "base/random.h"

namespace dynoproof::stages {
namespace {

constexpr std::uint64_t kSensorStream = 4;

}  // namespace

PluginInfo Noise::Info() {
  return {"sensor",     "noise", "seeded white Gaussian noise", "out = in + std n_i, i = round(t / period)",
          "definition", {}};
}

PluginInfo Quantisation::Info() {
  return {"sensor", "quantisation", "limited resolution", "out = step round(in / step)", "definition", {}};
}

Noise::Noise(const Params& params, const BuildContext& context)
    : StaticStage(context.nominal),
      std_(params.std),
      period_(context.period_s),
      seed_(static_cast<std::uint64_t>(params.seed != 0 ? params.seed : context.seed)) {}

double Noise::Map(double time_s, double in) const {
  return in + std_ * RandomNormal(seed_, kSensorStream, static_cast<std::uint64_t>(std::llround(time_s / period_)));
}

Quantisation::Quantisation(const Params& params, const BuildContext& context)
    : StaticStage(context.nominal), step_(params.step) {}

double Quantisation::Map(double, double in) const { return step_ * std::round(in / step_); }

}  // namespace dynoproof::stages
