#include "plugins/source/noise/noise.h"

#include <cmath>

namespace dynoproof::sources {
namespace {

constexpr std::uint64_t kNoiseStream = 2;

}  // namespace

PluginInfo NoiseSource::Info() {
  return {"source",
          "noise",
          "seeded white Gaussian noise, held per sample",
          "offset + std n_i, i = floor((t - start_time) / sample_period)",
          "definition",
          {}};
}

NoiseSource::NoiseSource(const Params& params, const BuildContext& context)
    : p_(params), seed_(SeedOf(params.seed, context)) {
  if (p_.sample_period_s == 0.0) p_.sample_period_s = context.period_s;
}

double NoiseSource::Value(double time_s) const {
  const double tau = time_s - p_.start_time_s + kTimeSlack;
  if (tau < 0.0) return 0.0;
  const auto index = static_cast<std::uint64_t>(std::floor(tau / p_.sample_period_s));
  return p_.offset + p_.std * RandomNormal(seed_, kNoiseStream, index);
}

}  // namespace dynoproof::sources
