#include "plugins/source/levels/levels.h"

#include <algorithm>

namespace dynoproof::sources {

PluginInfo Constant::Info() { return {"source", "constant", "one value", "value", "definition", {}}; }

PluginInfo Step::Info() {
  return {"source", "step", "one change of level", "initial before time, value from then on", "definition", {}};
}

PluginInfo Jump::Info() {
  return {"source", "jump", "levels that change at given times", "values[i] from times[i] on", "definition", {}};
}

PluginInfo Ramp::Info() {
  return {"source",
          "ramp",
          "a straight line between two levels",
          "from + (to - from) clamp((t - start_time)/duration, 0, 1)",
          "definition",
          {}};
}

void Jump::Params::Check(Faults& faults) const {
  if (times_s.empty() || times_s.size() != values.size()) {
    faults.At("values", fmt::format("{} times and {} values", times_s.size(), values.size()),
              "as many values as times, at least one");
  }
  if (std::adjacent_find(times_s.begin(), times_s.end(), std::greater_equal<>()) != times_s.end()) {
    faults.At("times_s", "the times do not rise", "each later than the one before");
  }
}

double Jump::Value(double time_s) const {
  const auto next = std::upper_bound(p_.times_s.begin(), p_.times_s.end(), time_s + kTimeSlack);
  return next == p_.times_s.begin() ? p_.initial : p_.values[next - p_.times_s.begin() - 1];
}

double Ramp::Value(double time_s) const {
  const double share = std::clamp((time_s - p_.start_time_s) / p_.duration_s, 0.0, 1.0);
  return p_.from + (p_.to - p_.from) * share;
}

}  // namespace dynoproof::sources
