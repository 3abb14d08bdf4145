// Checks of an engine's answer to a load step: what Fig. 6.10 of the thesis shows, as numbers.
#pragma once

#include <string>
#include <vector>

#include "experiment/checks.h"

namespace dynoproof {

/// A speed and a power after the one step of an input. Figures: speed_drop_percent, the deepest place below the mean of
/// the last second before the step; drop_s, when it is there; recovery_s, from the step into `band_percent` of that
/// mean for good; speed_end_percent, what the mean of the last second is above it;
/// power_before_W, that of the power; power_peak_W, the largest within `peak_within_s` of the step; power_dip_W, the
/// least between there and recovery; power_end_W, the mean of the last second. The speed drops between two limits and
/// recovers; the power rises at once, is taken back while the speed is low (by dip_percent of the rise at least) and
/// comes to its new level. The same figures, without limits, for every [variant.NAME], as NAME.speed_drop_percent.
class LoadStepCheck : public CheckPlan {
 public:
  struct Params {
    std::string speed, power, load, origin;
    std::vector<double> drop_percent;
    double recovery_s = 0.0, band_percent = 0.5, peak_within_s = 0.2, dip_percent = 0.0, end_percent = 1.0;
    void Visit(auto& v) {
      v.Required("speed", speed, Any(), "output that drops");
      v.Required("power", power, Any(), "output that rises");
      v.Required("load", load, Any(), "[input.NAME] that steps once");
      v.Required("drop_percent", drop_percent, Positive("%"), "from and to: how deep the speed drops");
      v.Required("recovery_s", recovery_s, Positive(), "longest time into the band for good");
      v.Optional("band_percent", band_percent, Positive("%"), "recovered: within this share of the speed before");
      v.Optional("peak_within_s", peak_within_s, Positive(), "the first rise of the power is over by then");
      v.Optional("dip_percent", dip_percent, NonNegative("%"),
                 "of the final rise that the power is taken back, at least");
      v.Optional("end_percent", end_percent, Positive("%"), "the power ends within this share of its first rise");
      v.Required("origin", origin, Any(), "why these limits");
    }
    void Check(Faults& faults) const;
  };
  static constexpr const char* kName = "load_step";
  static constexpr const char* kSummary =
      "drop and recovery of an engine's speed, course of its power, after a load step";
  explicit LoadStepCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.speed, p_.power}; }
  std::vector<std::string> Inputs() const override { return {p_.load}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  void ReportVariants(CheckContext& context, std::size_t step) const;
  Params p_;
};

}  // namespace dynoproof
