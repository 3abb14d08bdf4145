// The checks of thesis chapter 3: `contacts`, impacts in a shaft with play; `divergence`, the rate at which runs part.
#pragma once

#include <string>
#include <vector>

#include "experiment/checks.h"

namespace dynoproof {

/// Contacts in a shaft with play, of every [variant.NAME] or of the scenario itself: both solvers up to the second
/// impact, order of the impacts, halved steps. Figures NAME.impact_1_ms, NAME.impact_1_rad_per_s, ...
class ContactsCheck : public CheckPlan {
 public:
  struct Params {
    std::string shaft, signal, origin;
    std::vector<std::string> alike, unlike;
    double from_s = 0.0, impact_ms = 0.0, nrmse = 0.0, alike_nrmse = 0.0, unlike_nrmse = 0.0;
    int order_of = 2;
    void Visit(auto& v) {
      v.Required("shaft", shaft, Any(), "the shaft with play");
      v.Required("signal", signal, Any(), "output that is compared");
      v.Required("from_s", from_s, NonNegative(), "time from which impacts are counted and timed");
      v.Required("impact_ms", impact_ms, Positive("ms"), "largest distance of an impact's time between the solvers");
      v.Required("nrmse", nrmse, Positive("1"), "largest distance of the solvers from from_s to the second impact");
      v.Optional("order_of", order_of, Between(1, 100), "impacts whose order is compared");
      v.Optional("alike", alike, Any(), "variants that agree up to the second impact of the first of them");
      v.Optional("alike_nrmse", alike_nrmse, NonNegative("1"), "how closely");
      v.Optional("unlike", unlike, Any(), "variants that do not, from from_s to the first impact");
      v.Optional("unlike_nrmse", unlike_nrmse, NonNegative("1"), "by how much at least");
      v.Required("origin", origin, Any(), "why these limits");
    }
  };
  static constexpr const char* kName = "contacts";
  static constexpr bool kFollowsPlan = true;
  static constexpr const char* kRelativeLimits[] = {"nrmse", "alike_nrmse"};
  static constexpr bool kComparesSolvers = true;
  static constexpr const char* kSummary = "impacts in a shaft with play: solvers, halved steps, laws";
  explicit ContactsCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// How fast two runs part that differ by a tiny change of one number: the rate is a figure, its size no fault.
class DivergenceCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, path, origin;
    double delta = 1e-6, from_s = 0.0, to_s = 0.0, at_most_per_s = 0.0;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that is compared");
      v.Required("path", path, Any(), "number that is changed, as in --set");
      v.Optional("delta", delta, Between(1e-13, 1e-2, "1"), "its relative change");
      v.Required("from_s", from_s, NonNegative(), "the rate is fitted from here");
      v.Required("to_s", to_s, Positive(), "to here");
      v.Required("at_most_per_s", at_most_per_s, Positive("1/s"), "largest rate, natural logarithm");
      v.Required("origin", origin, Any(), "why this limit");
    }
  };
  static constexpr const char* kName = "divergence";
  static constexpr bool kFollowsPlan = true;
  static constexpr const char* kSummary = "rate at which runs part after a tiny change";
  explicit DivergenceCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

}  // namespace dynoproof
