// The check of chaotic motion: the realtime solver put back on the state of the reference every window.
#pragma once

#include <string>
#include <vector>

#include "experiment/checks.h"

namespace dynoproof {

/// `realtime` against `reference`, started anew from its state every window.
class WindowsCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, origin;
    double nrmse = 0.0, window_s = 0.0;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that is compared");
      v.Required("nrmse", nrmse, Positive("1"), "largest distance over all windows");
      v.Optional("window_s", window_s, NonNegative(), "length of a window; 0: prediction_window_s of the scenario");
      v.Required("origin", origin, Any(), "why this limit");
    }
  };
  static constexpr const char* kName = "windows";
  static constexpr bool kFollowsPlan = true;
  static constexpr const char* kRelativeLimits[] = {"nrmse"};
  static constexpr bool kComparesSolvers = true;
  static constexpr const char* kSummary = "`realtime` against `reference` in windows that restart from its state";
  explicit WindowsCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

}  // namespace dynoproof
