// Nonlinear actuator stages without memory: `saturation`, `dead_zone`, `harmonic`. The two with kinks offer guards at
// the kinks, so that an adaptive solver can stop there when the stage follows a continuous one.
#pragma once

#include "plugins/stage.h"

namespace dynoproof::stages {

/// out = in limited to +-limit.
class Saturation : public StaticStage {
 public:
  struct Params {
    double limit = 0.0;
    void Visit(auto& v) { v.Required("limit", limit, NonNegative(), "largest magnitude, in the signal's unit"); }
  };
  static PluginInfo Info();
  Saturation(const Params& params, const BuildContext& context);
  double Map(double time_s, double in) const override;
  void Guards(const View& view, std::span<double> values) const override;

 private:
  double limit_;
};

/// out = 0 for |in| <= width/2, else in shifted towards 0 by width/2.
class DeadZone : public StaticStage {
 public:
  struct Params {
    double width = 0.0;
    void Visit(auto& v) { v.Required("width", width, NonNegative(), "total width, in the signal's unit"); }
  };
  static PluginInfo Info();
  DeadZone(const Params& params, const BuildContext& context);
  double Map(double time_s, double in) const override;
  void Guards(const View& view, std::span<double> values) const override;

 private:
  double half_;
};

/// out = u + h2 u^2/u_n + h3 u^3/u_n^2: a sine gains a second and a third harmonic. u_n is the nominal value of the
/// input in the scenario unless the key `nominal` is given.
class Harmonic : public StaticStage {
 public:
  struct Params {
    double h2 = 0.0, h3 = 0.0, nominal = 0.0;
    void Visit(auto& v) {
      v.Optional("h2", h2, Any(), "share of the square");
      v.Optional("h3", h3, Any(), "share of the cube");
      v.Optional("nominal", nominal, NonNegative(), "u_n, in the signal's unit; 0: the nominal of the input");
    }
  };
  static PluginInfo Info();
  Harmonic(const Params& params, const BuildContext& context);
  double Map(double time_s, double in) const override;

 private:
  double h2_, h3_, nominal_;
};

}  // namespace dynoproof::stages
