// Source `noise`: seeded white Gaussian noise, held for sample_period_s.
//
// value(t) = offset + std n_i with i = floor(t / sample_period) and n_i the standard normal number of (seed, i): a pure
// function of time. Coloured noise would need a state and is therefore an actuator stage behind this source.
#pragma once

#include "plugins/source/source.h"

namespace dynoproof::sources {

class NoiseSource : public Source {
 public:
  struct Params {
    double std = 0.0, offset = 0.0, sample_period_s = 0.0, start_time_s = 0.0;
    std::int64_t seed = 0;
    void Visit(auto& v) {
      v.Required("std", std, NonNegative(), "standard deviation");
      v.Optional("offset", offset, Any(), "added from the start on");
      v.Optional("sample_period_s", sample_period_s, NonNegative(), "how long a value is held; 0: the run's period");
      v.Optional("start_time_s", start_time_s, Any(), "until then the value is 0");
      v.Optional("seed", seed, Any(), "seed; 0: that of the run");
    }
  };
  static PluginInfo Info();
  NoiseSource(const Params& params, const BuildContext& context);
  double Value(double time_s) const override;

 private:
  Params p_;
  std::uint64_t seed_;
};

}  // namespace dynoproof::sources
