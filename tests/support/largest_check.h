// A check whose limit can be solved for by hand: the largest magnitude of an output.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "experiment/checks.h"
#include "model/registry.h"

namespace dynoproof::testing {

class LargestCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal;
    double most = 1.0;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output");
      v.Required("most", most, Positive("1"), "limit");
    }
  };
  static constexpr const char* kName = "largest";
  static constexpr const char* kSummary = "the largest magnitude of an output";
  explicit LargestCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }
  std::vector<score::Check> Run(CheckContext& context) const override {
    double most = 0.0;
    const auto signal = context.Find(p_.signal);
    for (const double value : signal->series.values) most = std::max(most, std::abs(value));
    return {score::AtMost("largest " + p_.signal, kName, most, p_.most, "1", "chosen")};
  }

 private:
  Params p_;
};

inline Value Largest(const char* signal, double most) {
  return Value{{"kind", "largest"}, {"signal", signal}, {"most", most}};
}

/// All built-in plugins, the harness' checks and that one.
inline const Registry& PluginsAndLargest() {
  static const Registry* const registry = [] {
    auto* made = new Registry;  // lives as long as the process
    RegisterBuiltIns(*made);
    RegisterChecks(*made);
    made->AddCheck<LargestCheck>();
    return made;
  }();
  return *registry;
}

}  // namespace dynoproof::testing
