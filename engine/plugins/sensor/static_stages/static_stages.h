// Sensor stages without memory: `offset`, `drift`, `rectified`.
#pragma once

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

}  // namespace dynoproof::stages
