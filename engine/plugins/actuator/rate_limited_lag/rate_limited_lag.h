// Actuator stage `rate_limited_lag`: a positioner that follows its command with a first-order lag and moves no faster than
// a rate: d(out)/dt = (in - out)/tau within -+rate. tau = 0 passes the input through and has no state. It starts in
// steady state; behind a control, which has not ticked yet then, where `start` says.
#pragma once

#include <vector>

#include "plugins/stage.h"

namespace dynoproof::stages {

class RateLimitedLag : public Stage {
 public:
  struct Params {
    double tau_s = 0.0, rate_per_s = 0.0;
    std::vector<double> start;
    void Visit(auto& v) {
      v.Required("tau_s", tau_s, NonNegative(), "time constant; 0: none, and no limit");
      v.Required("rate_per_s", rate_per_s, Positive("1/s"), "largest rate, in the signal's unit per second");
      v.Optional("start", start, Any("1"), "[position at t = 0]; left out: that of the first input");
    }
    void Check(Faults& faults) const {
      if (start.size() > 1) faults.At("start", "a stage starts at one place", "one number in brackets");
    }
  };
  static PluginInfo Info();
  RateLimitedLag(const Params& params, const BuildContext& context);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int, int) const override { return tau_ == 0.0; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;

 private:
  double Wanted(const View& view) const { return (view.inputs[0] - view.states[0]) / tau_; }
  double tau_, rate_;
  std::vector<double> start_;
};

}  // namespace dynoproof::stages
