// Sensor stages whose output jumps from sample to sample: `noise`, `quantisation`. They stand last in a chain.
#pragma once

#include "plugins/stage.h"

namespace dynoproof::stages {

/// out = in + std n_i, with n_i the standard normal number of (seed, i) and i the nearest sample of the run's period.
class Noise : public StaticStage {
 public:
  struct Params {
    double std = 0.0;
    std::int64_t seed = 0;
    void Visit(auto& v) {
      v.Required("std", std, NonNegative(), "standard deviation, in the signal's unit");
      v.Optional("seed", seed, Any(), "seed; 0: that of the run");
    }
  };
  static PluginInfo Info();
  Noise(const Params& params, const BuildContext& context);
  double Map(double time_s, double in) const override;
  bool sampled() const override { return true; }

 private:
  double std_, period_;
  std::uint64_t seed_;
};

/// out = the nearest whole multiple of step.
class Quantisation : public StaticStage {
 public:
  struct Params {
    double step = 0.0;
    void Visit(auto& v) { v.Required("step", step, Positive(), "resolution, in the signal's unit"); }
  };
  static PluginInfo Info();
  Quantisation(const Params& params, const BuildContext& context);
  double Map(double time_s, double in) const override;
  bool sampled() const override { return true; }

 private:
  double step_;
};

}  // namespace dynoproof::stages
