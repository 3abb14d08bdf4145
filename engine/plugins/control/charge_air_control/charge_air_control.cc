#include "plugins/control/charge_air_control/charge_air_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dynoproof::controls {
namespace {

double CapacityOf(double volume, double R_theta) { return volume / R_theta; }

ConditionedPi PiOf(double volume, double R_theta, double bandwidth_Hz, const std::string& anti_windup,
                   double period_s) {
  return {mechanics::FirstOrderLagGains(CapacityOf(volume, R_theta), 2.0 * std::numbers::pi * bandwidth_Hz),
          AntiWindupOf(anti_windup), period_s};
}

const FlapParams& Flap(const ChargeAirControl::Params& params, const char* name) {
  return std::find_if(params.flap.begin(), params.flap.end(), [name](const auto& flap) { return flap.first == name; })
      ->second;
}

}  // namespace

void FlapRanges::Check(Faults& faults) const {
  if (!(u_1_largest_percent > u_1_least_percent)) {
    faults.At("u_1_largest_percent", "flap 1 has no range", "larger than u_1_least_percent");
  }
  if (!(u_2_largest_percent > u_2_least_percent)) {
    faults.At("u_2_largest_percent", "flap 2 has no range", "larger than u_2_least_percent");
  }
}

PluginInfo ChargeAirControl::Info() {
  return {"control",
          "charge_air_control",
          "charge and supply pressure by two flaps: planned reference, decoupling, conditioned PI controllers",
          "p_s* = min((1 + K) p_ch, limits), q_1 = w_1, q_2 = -w_2 - q_1, u_i = inverse area of q_i",
          "thesis (6.12)-(6.21)",
          {}};
}

void ChargeAirControl::Params::Check(Faults& faults) const {
  const bool both = flap.size() == 2 && (flap[0].first == "1") + (flap[1].first == "1") == 1 &&
                    (flap[0].first == "2") + (flap[1].first == "2") == 1;
  if (!both) faults.At("flap", "the controller inverts flaps \"1\" and \"2\"", "write both tables, as in the plant");
  FlapRanges::Check(faults);
}

ChargeAirControl::ChargeAirControl(const Params& params, double period_s)
    : p_(params),
      R_theta_(params.R_J_per_kg_K * params.theta_K),
      area_{Flap(params, "1").Area(), Flap(params, "2").Area()},
      pi_{PiOf(params.volume_1_m3, R_theta_, params.bandwidth_1_Hz, params.anti_windup, period_s),
          PiOf(params.volume_2_m3, R_theta_, params.bandwidth_2_Hz, params.anti_windup, period_s)} {
  layout_.inputs = {{"reference", "Pa", "charge pressure that is wanted", 1e5},
                    {"p_ch", "Pa", "charge pressure", 1e5},
                    {"p_s", "Pa", "supply pressure", 1e5},
                    {"speed", "rad/s", "speed of the engine", 100.0}};
  layout_.outputs = {{"u_1", "%", "position of flap 1", 50.0},
                     {"u_2", "%", "position of flap 2", 50.0},
                     {"p_s_ref", "Pa", "planned supply pressure", 1e5},
                     {"w_1", "kg/s", "wanted flow into V_1", 1.0},
                     {"w_2", "kg/s", "wanted flow into V_2", 1.0}};
  layout_.states = {{"integral_1", "kg/s", "of the charge pressure", 1.0},
                    {"integral_2", "kg/s", "of the supply pressure", 1.0},
                    {"begun", "1", "0 before the first tick", 1.0}};
}

std::unique_ptr<ChargeAirControl> ChargeAirControl::Create(const Params& params, const Value& table,
                                                           BuildContext& context) {
  return std::unique_ptr<ChargeAirControl>(new ChargeAirControl(params, PeriodOf(table, context)));
}

void ChargeAirControl::Step(const View& view, std::span<double> outputs, double& integral_1, double& integral_2) const {
  const double reference = view.inputs[0], p_ch = view.inputs[1], p_s = view.inputs[2];
  // Flow per area (6.4): unchoked through flap 1, choked through flap 2, as the decoupling (6.15) assumes. Without a
  // pressure drop no position gives a flow: flap 1 then opens as the sign of the wish says.
  const double per_area_1 = std::sqrt(2.0 * std::max(0.0, p_ch * (p_s - p_ch)) / R_theta_);
  const double per_area_2 = std::max(0.0, p_s) / std::sqrt(2.0 * R_theta_);

  const double swept = p_.volumetric_efficiency * p_.displacement_m3 * view.inputs[3] /
                       (2.0 * std::numbers::pi * p_.revolutions_per_cycle);
  const double middle = 0.5 * (p_.u_1_least_percent + p_.u_1_largest_percent);
  const double K = mechanics::PressureSurplus(swept, area_[0].Area(middle), R_theta_);
  // (6.14); it keeps p_s <= 2 p_ch only with K < 1, which `largest_ratio` sees to.
  const double p_s_ref = std::min(std::min(1.0 + K, p_.largest_ratio) * p_ch, p_.largest_p_s_Pa);

  const bool begun = view.states[2] != 0.0;
  const double start_1 = area_[0].Area(p_.initial_u_1_percent) * per_area_1;
  const double start_2 = area_[1].Area(p_.initial_u_2_percent) * per_area_2;
  const double x_1 = begun ? view.states[0] : pi_[0].Fitting(reference, p_ch, start_1);
  const double w_1 = pi_[0].Wanted(reference, p_ch, x_1);
  const double q_1 = std::clamp(w_1, area_[0].Area(p_.u_1_least_percent) * per_area_1,
                                area_[0].Area(p_.u_1_largest_percent) * per_area_1);  // (6.19)
  const double x_2 = begun ? view.states[1] : pi_[1].Fitting(p_s_ref, p_s, -start_1 - start_2);
  const double w_2 = pi_[1].Wanted(p_s_ref, p_s, x_2);
  const double q_2 = std::clamp(-w_2 - q_1, area_[1].Area(p_.u_2_least_percent) * per_area_2,
                                area_[1].Area(p_.u_2_largest_percent) * per_area_2);  // (6.16) with the flow that comes
  outputs[0] = per_area_1 > 0.0 ? area_[0].Position(q_1 / per_area_1)
               : w_1 > 0.0      ? p_.u_1_largest_percent
                                : p_.u_1_least_percent;
  outputs[1] = per_area_2 > 0.0 ? area_[1].Position(q_2 / per_area_2) : p_.u_2_least_percent;
  outputs[2] = p_s_ref;
  outputs[3] = w_1;
  outputs[4] = w_2;
  integral_1 = pi_[0].NextIntegral(reference, p_ch, x_1, w_1, q_1);
  integral_2 = pi_[1].NextIntegral(p_s_ref, p_s, x_2, w_2, -q_1 - q_2);
}

void ChargeAirControl::Output(const View& view, std::span<double> outputs) const {
  double integral_1, integral_2;
  Step(view, outputs, integral_1, integral_2);
}

void ChargeAirControl::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  double integral_1, integral_2;
  Step(view, outputs, integral_1, integral_2);
  states[0] = integral_1;
  states[1] = integral_2;
  states[2] = 1.0;
}

PluginInfo ChargeAirLegacy::Info() {
  return {"control",
          "charge_air_legacy",
          "plain PI of the charge pressure; the other flap moves slowly while the first is at a limit",
          "u_1 = clamp(k_P e + x_I); du_2/dt = -rate with u_1 at its upper, +rate at its lower limit, else 0",
          "thesis Sec. 6.4 (in words; gains are not printed)",
          {}};
}

ChargeAirLegacy::ChargeAirLegacy(const Params& params, double period_s) : p_(params), period_s_(period_s) {
  layout_.inputs = {{"reference", "Pa", "charge pressure that is wanted", 1e5}, {"p_ch", "Pa", "charge pressure", 1e5}};
  layout_.outputs = {{"u_1", "%", "position of flap 1", 50.0}, {"u_2", "%", "position of flap 2", 50.0}};
  layout_.states = {{"integral", "%", "integral part", 50.0},
                    {"u_2", "%", "position of flap 2", 50.0},
                    {"begun", "1", "0 before the first tick", 1.0}};
}

std::unique_ptr<ChargeAirLegacy> ChargeAirLegacy::Create(const Params& params, const Value& table,
                                                         BuildContext& context) {
  return std::unique_ptr<ChargeAirLegacy>(new ChargeAirLegacy(params, PeriodOf(table, context)));
}

void ChargeAirLegacy::Output(const View& view, std::span<double> outputs) const {
  std::vector<double> states(view.states.begin(), view.states.end());
  Tick(view, states, outputs);
}

void ChargeAirLegacy::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  const double error_bar = 1e-5 * (view.inputs[0] - view.inputs[1]);
  const double proportional = p_.k_P_percent_per_bar * error_bar;
  const bool begun = view.states[2] != 0.0;
  const double integral = begun ? view.states[0] : p_.initial_u_1_percent - proportional;
  const double u_2 = begun ? view.states[1] : p_.initial_u_2_percent;
  const double wanted = proportional + integral;
  const double u_1 = std::clamp(wanted, p_.u_1_least_percent, p_.u_1_largest_percent);
  const int limit = wanted > p_.u_1_largest_percent ? 1 : wanted < p_.u_1_least_percent ? -1 : 0;
  outputs[0] = u_1;
  outputs[1] = u_2;
  // The integral stands still where it would drive flap 1 further into its limit.
  const bool held = limit * error_bar > 0.0;
  states[0] = integral + (held ? 0.0 : p_.k_I_percent_per_bar_s * error_bar * period_s_);
  states[1] =
      std::clamp(u_2 - limit * p_.u_2_rate_percent_per_s * period_s_, p_.u_2_least_percent, p_.u_2_largest_percent);
  states[2] = 1.0;
}

}  // namespace dynoproof::controls
