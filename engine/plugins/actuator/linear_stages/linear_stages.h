// Linear stages, for inputs and outputs alike: `gain`, `first_order_lag`, `delay`. All are propagated exactly.
#pragma once

#include "model/linear_part.h"
#include "plugins/stage.h"

namespace dynoproof::stages {

/// out = gain in.
class Gain : public StaticStage {
 public:
  struct Params {
    double gain = 1.0;
    void Visit(auto& v) { v.Required("gain", gain, Any(), "factor"); }
  };
  static PluginInfo Describe(const char* kind);
  Gain(const Params& params, const BuildContext& context);

  double Map(double, double in) const override { return gain_ * in; }
  const LinearPart* linear_part() const override { return &linear_part_; }

 private:
  double gain_;
  LinearPart linear_part_;
};

/// tau d(out)/dt = in - out, in steady state at the start. tau = 0 passes the input through and has no state.
class FirstOrderLag : public Stage {
 public:
  struct Params {
    double tau_s = 0.0;
    void Visit(auto& v) { v.Required("tau_s", tau_s, NonNegative(), "time constant; 0: none"); }
  };
  static PluginInfo Describe(const char* kind);
  FirstOrderLag(const Params& params, const BuildContext& context);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int, int) const override { return tau_ == 0.0; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;
  const LinearPart* linear_part() const override { return &linear_part_; }

 private:
  double tau_;
  LinearPart linear_part_;
};

/// out(t) = in(t - delay); before the first sample arrives, the first input. The engine realises the delay in front of
/// the stages (delay_s()), the stage itself passes its input through. Constant linear stages commute with it.
class Delay : public StaticStage {
 public:
  struct Params {
    double delay_s = 0.0;
    void Visit(auto& v) { v.Required("delay_s", delay_s, Between(0.0, 10.0, "s"), "delay"); }
  };
  static PluginInfo Describe(const char* kind);
  Delay(const Params& params, const BuildContext& context);

  double Map(double, double in) const override { return in; }
  double delay_s() const override { return delay_; }
  const LinearPart* linear_part() const override { return &linear_part_; }

 private:
  double delay_;
  LinearPart linear_part_;
};

}  // namespace dynoproof::stages
