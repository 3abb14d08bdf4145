// Check `resonances`.
#pragma once

#include <string>
#include <vector>

#include "experiment/checks.h"

namespace dynoproof {

/// The resonances that a chirp run shows, against those of the frequency response: position and height.
class ResonancesCheck : public CheckPlan {
 public:
  struct Params {
    std::vector<double> band_Hz;
    double tolerance_Hz = 0.0, tolerance_gain = 0.0, prominence_db = 6.0, narrowest_Hz = 0.0;
    std::string origin;
    void Visit(auto& v) {
      v.Required("band_Hz", band_Hz, Positive("Hz"), "from and to: where resonances are looked for");
      v.Required("tolerance_Hz", tolerance_Hz, Positive(), "largest shift of a resonance");
      v.Required("tolerance_gain", tolerance_gain, Positive("1"), "largest relative error of its height");
      v.Optional("prominence_db", prominence_db, Positive("dB"), "a peak stands out by this much on both sides");
      v.Optional("narrowest_Hz", narrowest_Hz, NonNegative(),
                 "heights count for resonances at least this wide (-3 dB)");
      v.Required("origin", origin, Any(), "why these limits");
    }
    void Check(Faults& faults) const;
  };
  static constexpr bool kNeedsAnalysis = true;
  static constexpr const char* kName = "resonances";
  static constexpr const char* kRelativeLimits[] = {"tolerance_gain"};
  static constexpr const char* kSummary = "peaks of the chirp run against the frequency response of [analysis]";
  explicit ResonancesCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

}  // namespace dynoproof
