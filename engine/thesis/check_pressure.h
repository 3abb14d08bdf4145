// Checks of pressures that follow load ramps: overshoot, settling, steady positions, limits between signals.
#pragma once

#include <string>
#include <vector>

#include "experiment/checks.h"

namespace dynoproof {

/// An output follows ramps or steps of an input. Every stretch in which the input stands still for `steady_s` and
/// before which it changed is a phase; its step is the change of the input's level. Figures, the worst of all phases:
/// overshoot_percent beyond the level, of the step; settling_s from the begin of the phase into `band_percent` of the
/// step for good; delay_s of the ramps; <steady>_steady, the mean of another output over the last tenth of the phase,
/// where it is farthest from `steady_at`. The same, without limits, for every [variant.NAME], as
/// NAME.overshoot_percent. With `mean_s` the limits hold for the centred moving mean of the output, whose figures are
/// mean.overshoot_percent and NAME.mean.overshoot_percent; those without it are of the output as it pulsates.
class RampsCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, reference, steady, origin;
    std::vector<std::string> worse;
    double steady_s = 5.0, band_percent = 1.0, overshoot_percent = 0.0, settling_s = 0.0, steady_at = 0.0,
           steady_within = 0.0, worse_factor = 2.0, mean_s = 0.0;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that follows");
      v.Required("reference", reference, Any(), "name of the [input.NAME] it follows, in the same unit");
      v.Optional("steady_s", steady_s, Positive(), "how long the input stands still in a phase, at least");
      v.Optional("band_percent", band_percent, Positive("%"), "settled: within this share of the step");
      v.Required("overshoot_percent", overshoot_percent, Positive("%"), "largest overshoot, of the step");
      v.Required("settling_s", settling_s, Positive(), "longest settling");
      v.Optional("steady", steady, Any(), "another output that returns to a place in every phase");
      v.Optional("steady_at", steady_at, Any("1"), "that place, in the output's unit");
      v.Optional("steady_within", steady_within, NonNegative("1"), "largest distance from it");
      v.Optional("mean_s", mean_s, NonNegative(), "the limits hold for the mean over this time, a cycle of an engine");
      v.Optional("worse", worse, Any(), "variants that must settle later or not at all");
      v.Optional("worse_factor", worse_factor, Positive("1"), "by this factor at least");
      v.Required("origin", origin, Any(), "why these limits");
    }
    void Check(Faults& faults) const;
  };
  static constexpr const char* kName = "ramps";
  static constexpr const char* kSummary = "overshoot and settling of an output that follows ramps of an input";
  explicit RampsCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override;
  std::vector<std::string> Inputs() const override { return {p_.reference}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// An output stays strictly between two bounds: numbers, other outputs, or these times a factor. Figure
/// <signal>_margin: the least distance to a bound, of all such checks of the signal.
class BoundedCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, above, below, origin;
    double above_factor = 1.0, below_factor = 1.0;
    std::vector<double> between, during_s;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that is bounded");
      v.Optional("above", above, Any(), "output that it stays above");
      v.Optional("above_factor", above_factor, Positive("1"), "times this");
      v.Optional("below", below, Any(), "output that it stays below");
      v.Optional("below_factor", below_factor, Positive("1"), "times this");
      v.Optional("between", between, Any("1"), "two numbers that it stays between, in its unit");
      v.Optional("during_s", during_s, NonNegative("s"), "from and to: the stretch of the run; all when left out");
      v.Required("origin", origin, Any(), "why these bounds");
    }
    void Check(Faults& faults) const;
  };
  static constexpr const char* kName = "bounded";
  static constexpr const char* kSummary = "an output stays between bounds, which may be other outputs";
  explicit BoundedCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override;
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

}  // namespace dynoproof
