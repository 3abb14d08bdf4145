#include "plugins/law/backlash/backlash.h"

#include <algorithm>

namespace dynoproof::laws {

void PhasePlaneParams::Check(Faults& faults) const {
  if (damping_Nms_per_rad == 0.0) {
    faults.At("damping_Nms_per_rad", "the phase plane divides by the damping c, and it is 0",
              "damping_Nms_per_rad > 0, or law = \"dead_zone\": without damping the two are the same");
  }
}

void DampedPhasePlaneParams::Check(Faults& faults) const {
  if (damping_Nms_per_rad == 0.0 && contact_free_damping_Nms_per_rad == 0.0) {
    faults.At("damping_Nms_per_rad", "the law divides by c + c_f, and both are 0",
              "one of damping_Nms_per_rad and contact_free_damping_Nms_per_rad > 0, or law = \"dead_zone\"");
  }
}

void PlaneBacklash::Start(double twist, double rate, std::span<double>, std::span<int> modes) const {
  modes[0] = MarginAt(1, twist, rate) >= 0.0 ? 1 : MarginAt(-1, twist, rate) >= 0.0 ? -1 : 0;
}

double PlaneBacklash::Torque(const LawView& view) const {
  const int mode = view.modes[0];
  return mode == 0 ? Free(view.twist, view.rate) : Contact(mode, view.twist, view.rate);
}

void PlaneBacklash::Guards(const LawView& view, std::span<double> values) const {
  const int mode = view.modes[0];
  values[0] =
      kMargin + (mode != 0 ? MarginAt(mode, view.twist, view.rate)
                           : -std::max(MarginAt(1, view.twist, view.rate), MarginAt(-1, view.twist, view.rate)));
}

void PlaneBacklash::OnEvent(const LawView& view, int, std::span<double>, std::span<int> modes) const {
  const double plus = MarginAt(1, view.twist, view.rate), minus = MarginAt(-1, view.twist, view.rate);
  if (modes[0] == 0) {
    modes[0] = plus >= minus ? 1 : -1;
  } else {  // without play the other side follows at once
    const double other = modes[0] > 0 ? minus : plus;
    modes[0] = other > 0.0 ? -modes[0] : 0;
  }
}

double PhasePlaneLaw::Decay(double twist, double rate) const {
  if (rate == 0.0) return 0.0;
  const double side = rate > 0.0 ? 1.0 : -1.0;
  // Before contact was lost there is no time since: there the other side touches anyway.
  const double time_s = std::max(0.0, (twist + side * n_.alpha) / rate + n_.c / n_.k);
  return std::exp(-p_ * time_s);
}

double PhasePlaneLaw::Margin(double twist, double rate) const {
  if (rate <= 0.0) return twist - n_.alpha + n_.c / n_.k * rate;  // touches as long as it presses
  return twist - n_.alpha + (-n_.c_f + (n_.c + n_.c_f) * Decay(twist, rate)) / n_.k * rate;
}

double PhasePlaneLaw::Free(double twist, double rate) const {
  return n_.c_f == 0.0 ? 0.0 : n_.c_f * rate * (1.0 - Decay(twist, rate));
}

FullStateLaw::FullStateLaw(const BacklashNumbers& numbers) : Backlash(numbers) {
  layout_.states = {{"gap_angle", "rad", "angle phi_b at the gap", n_.alpha > 0.0 ? n_.alpha : 1e-3}};
}

void FullStateLaw::Start(double twist, double rate, std::span<double> states, std::span<int> modes) const {
  modes[0] = twist > n_.alpha && Contact(1, twist, rate) >= 0.0     ? 1
             : twist < -n_.alpha && Contact(-1, twist, rate) <= 0.0 ? -1
                                                                    : 0;
  states[0] = std::clamp(twist, -n_.alpha, n_.alpha);  // free, the shaft is not wound up
}

double FullStateLaw::Torque(const LawView& view) const {
  const int mode = view.modes[0];
  return mode == 0 ? n_.c_f * FreeSpeed(view) : Contact(mode, view.twist, view.rate);
}

void FullStateLaw::Derivative(const LawView& view, std::span<double> rates) const {
  rates[0] = view.modes[0] == 0 ? FreeSpeed(view) : 0.0;
}

void FullStateLaw::Guards(const LawView& view, std::span<double> values) const {
  const int mode = view.modes[0];
  values[0] =
      kMargin + (mode == 0 ? n_.alpha - std::abs(view.states[0]) : mode * Contact(mode, view.twist, view.rate) / n_.k);
}

void FullStateLaw::OnEvent(const LawView& view, int, std::span<double> states, std::span<int> modes) const {
  if (modes[0] == 0) {
    modes[0] = view.states[0] > 0.0 ? 1 : -1;
    states[0] = modes[0] * n_.alpha;
  } else {
    const bool other = n_.alpha == 0.0;  // without play the other side follows at once
    modes[0] = other ? -modes[0] : 0;
  }
}

PluginInfo DeadZone::Info() {
  return {"law",
          "dead_zone",
          "shaft with play that touches where |d| > alpha; it can pull",
          "T = k (d -+ alpha) + c w beyond +-alpha, 0 between",
          "thesis (3.1)",
          {}};
}

PluginInfo RevisedDeadZone::Info() {
  return {"law",
          "revised_dead_zone",
          "shaft with play that touches where it presses",
          "T = k (d -+ alpha) + c w where that presses against +-alpha, else 0",
          "thesis (3.2)",
          {}};
}

PluginInfo PhasePlane::Info() {
  return {"law",
          "phase_plane",
          "shaft with play that estimates the angle at the gap from twist and rate",
          "T = k (d -+ alpha) + c w in A+, A-, else 0; A+: d + (c/k) w exp(-(k/c)(d + alpha)/w - 1) >= alpha (w > 0), "
          "k (d - alpha) + c w >= 0 (w <= 0)",
          "thesis (3.3), (3.4), with the first line of A- corrected",
          {}};
}

PluginInfo DampedDeadZone::Info() {
  return {"law",
          "damped_dead_zone",
          "dead zone with contact-free damping; it can pull",
          "T = k (d -+ alpha) + c w beyond +-alpha, c_f w between",
          "thesis (3.5)",
          {}};
}

PluginInfo DampedRevisedDeadZone::Info() {
  return {"law",
          "damped_revised_dead_zone",
          "revised dead zone with contact-free damping, continuous",
          "T = c_f w + max(0, k (d - alpha) + (c - c_f) w) + min(0, k (d + alpha) + (c - c_f) w)",
          "thesis Sec. 3.3.1 leaves the activation open; this one: README of the law",
          {}};
}

PluginInfo DampedPhasePlane::Info() {
  return {"law",
          "damped_phase_plane",
          "phase plane with contact-free damping",
          "T = k (d -+ alpha) + c w in A+, A-, else c_f w (1 - exp(-p t)); t = (d +- alpha)/w + c/k, p = k/(c + c_f)",
          "thesis (3.13)-(3.15), corrected: README of the law",
          {}};
}

PluginInfo FullStateBacklash::Info() {
  return {
      "law",
      "full_state_backlash",
      "shaft with play and contact-free damping, the angle at the gap being a state",
      "k (d - phi_b) + c (w - w_b) = c_f w_b while free; T = k (d -+ alpha) + c w while phi_b = +-alpha and T presses",
      "thesis (3.6), (3.7) without assumption 4",
      {}};
}

}  // namespace dynoproof::laws
