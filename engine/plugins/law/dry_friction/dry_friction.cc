#include "plugins/law/dry_friction/dry_friction.h"

#include <algorithm>

namespace dynoproof::laws {

/// Of the limit: a holding torque that meets it but for round-off is held, whatever else holds beside it.
constexpr double kRoundOff = 1e-12;

PluginInfo Coulomb::Info() {
  return {"law", "coulomb", "dry friction that sticks when it can hold", "T = T_c sgn(w)", "Coulomb", {}};
}

PluginInfo Stribeck::Info() {
  return {"law",
          "stribeck",
          "dry friction that falls with speed",
          "T = (T_c + (T_s - T_c) exp(-(w/w_s)^2)) sgn(w)",
          "Stribeck; Armstrong-Helouvry et al., Automatica 30 (1994), Gaussian form",
          {}};
}

PluginInfo Asymmetric::Info() {
  return {"law",
          "asymmetric",
          "dry and viscous friction that differ with direction",
          "T = T_c_pos + b_pos w (w > 0), -T_c_neg + b_neg w (w < 0)",
          "definition",
          {}};
}

void DryFriction::Start(double, double rate, std::span<double>, std::span<int> modes) const {
  modes[0] = rate > 0.0 ? 1 : rate < 0.0 ? -1 : 0;
}

double DryFriction::Torque(const LawView& view) const {
  if (view.modes[0] != 0) return Slip(view.rate, view.modes[0]);
  // Clamped: at the start the holding torque may exceed the limit before the first event has been dealt with.
  return std::clamp(view.holding_torque, Slip(0.0, -1), Slip(0.0, 1));
}

double DryFriction::Margin(double h) const {
  const double forward = Slip(0.0, 1), back = Slip(0.0, -1);
  return std::min(forward - h, h - back) + kRoundOff * std::max(forward, -back);
}

void DryFriction::Guards(const LawView& view, std::span<double> values) const {
  values[0] = view.modes[0] == 0 ? Margin(view.holding_torque) : view.modes[0] * view.rate;
}

void DryFriction::OnEvent(const LawView& view, int, std::span<double>, std::span<int> modes) const {
  const double h = view.holding_torque;
  // Leaving the stick, h sits on the limit to round-off: there only its sign counts.
  modes[0] = modes[0] != 0 && Margin(h) >= 0.0 ? 0 : h > 0.0 ? 1 : -1;
}

}  // namespace dynoproof::laws
