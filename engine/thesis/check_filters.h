// Check of chapter 5: every placement of a notch filter, and the loop that the filters leave, by eigenvalues.
#pragma once

#include <string>
#include <vector>

#include "experiment/checks.h"

namespace dynoproof {

/// Judges a run's filters by the eigenvalues of its loop with the machine (machine_scenario.h) at that moment: a filter
/// must go to a mode that grew just before or grows with idle filters, so that it may still be heard; and with the filters as
/// they stand in the end nothing may grow. Figures:
/// growing (modes that grow with idle filters), found (of these), placed, false_placements, growth_at_end [1/s],
/// unstable_at_end, and beyond_filters: 1 where no setting of the filters holds the loop, as far as a search finds one.
class FiltersHoldCheck : public CheckPlan {
 public:
  struct Params {
    std::vector<std::string> notches;
    std::string gain, origin;
    double near_Hz = 0.0, growth_per_s = 0.0;
    void Visit(auto& v) {
      v.Required("notches", notches, Any(), "outputs with the frequencies of the filters");
      v.Required("gain", gain, Any(), "input with the feedthrough gain k_V");
      v.Required("near_Hz", near_Hz, Positive(), "a filter within this of a mode is at it");
      v.Optional("growth_per_s", growth_per_s, Any("1/s"), "largest growth rate that is none");
      v.Required("origin", origin, Any(), "why these limits");
    }
  };
  static constexpr const char* kName = "filters_hold";
  static constexpr const char* kSummary = "notch filters against the eigenvalues of the loop with its machine";
  explicit FiltersHoldCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return p_.notches; }
  std::vector<std::string> Inputs() const override { return {p_.gain}; }
  std::vector<score::Check> Run(CheckContext& context) const override;
  void Applies(const Plan& plan, const Rig& rig, Diagnostics& diagnostics) const override;

 private:
  Params p_;
};

}  // namespace dynoproof
