// Sensor stages without memory: `offset`, `drift`, `rectified`, `range`.
#pragma once

#include <algorithm>
#include <span>

#include "plugins/stage.h"

namespace dynoproof::stages {

/// out = in + offset.
class Offset : public StaticStage {
 public:
  struct Params {
    double offset = 0.0;
    void Visit(auto& v) { v.Required("offset", offset, Any(), "added value, in the signal's unit"); }
  };
  static PluginInfo Info();
  Offset(const Params& params, const BuildContext& context) : StaticStage(context.nominal), offset_(params.offset) {}
  double Map(double, double in) const override { return in + offset_; }

 private:
  double offset_;
};

/// out = in + slope t.
class Drift : public StaticStage {
 public:
  struct Params {
    double slope_per_s = 0.0;
    void Visit(auto& v) {
      v.Required("slope_per_s", slope_per_s, Any("1/s"), "growth, in the signal's unit per second");
    }
  };
  static PluginInfo Info();
  Drift(const Params& params, const BuildContext& context) : StaticStage(context.nominal), slope_(params.slope_per_s) {}
  double Map(double time_s, double in) const override { return in + slope_ * time_s; }

 private:
  double slope_;
};

/// out = |in|, with a guard at the kink.
class Rectified : public StaticStage {
 public:
  struct Params {
    void Visit(auto&) {}
  };
  static PluginInfo Info();
  Rectified(const Params&, const BuildContext& context) : StaticStage(context.nominal) { layout_.guards = 1; }
  double Map(double, double in) const override { return in < 0.0 ? -in : in; }
  void Guards(const View& view, std::span<double> values) const override { values[0] = view.inputs[0]; }
};

/// out = in within the range and its nearer end beyond, with guards at the two kinks.
class Range : public StaticStage {
 public:
  struct Params {
    double low = 0.0, high = 0.0;
    void Visit(auto& v) {
      v.Required("low", low, Any(), "smallest value that it shows, in the signal's unit");
      v.Required("high", high, Any(), "largest value that it shows, in the signal's unit");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  Range(const Params& params, const BuildContext& context)
      : StaticStage(context.nominal), low_(params.low), high_(params.high) {
    layout_.guards = 2;
  }
  double Map(double, double in) const override { return std::clamp(in, low_, high_); }
  void Guards(const View& view, std::span<double> values) const override {
    values[0] = view.inputs[0] - low_;
    values[1] = high_ - view.inputs[0];
  }

 private:
  double low_, high_;
};

}  // namespace dynoproof::stages
