#include "plugins/physics/cylinder_geometry.h"

#include "plugins/named_sections.h"

namespace dynoproof {

void ValveParams::Check(Faults& faults) const {
  if (!(closes_deg > opens_deg && closes_deg < opens_deg + 720.0)) {
    faults.At("closes_deg", "the valves do not close within a cycle", "opens_deg < closes_deg < opens_deg + 720");
  }
}

mechanics::ValveTrain ValveParams::Train() const {
  return {mechanics::WithinCycle(opens_deg * kPerDegree), (closes_deg - opens_deg) * kPerDegree,
          count * discharge * std::numbers::pi * diameter_m * lift_m};
}

bool CheckValves(Faults& faults, const std::vector<std::pair<std::string, ValveParams>>& valves) {
  constexpr const char* kNames[] = {"intake", "exhaust"};
  if (!CheckNames(faults, "valves", valves, kNames)) return false;
  const mechanics::ValveTrain in = Named(valves, "intake").Train(), out = Named(valves, "exhaust").Train();
  const double closed = in.closes(), duration = mechanics::WithinCycle(out.opens - closed);
  const auto within = [&](double angle) { return mechanics::WithinCycle(angle - closed) < duration; };
  if (closed < out.opens && !within(in.opens) && !within(out.closes())) return true;
  faults.At("valves", "there is no part of the cycle with all valves closed around 360 degrees",
            "intake closes before 360 and exhaust opens behind it, in degrees from the dead centre with gas exchange");
  return false;
}

}  // namespace dynoproof
