#include "plugins/control/engine_control/engine_control.h"

#include <algorithm>
#include <cmath>

#include "plugins/control/pressure_pi/conditioned_pi.h"  // PeriodOf

namespace dynoproof::controls {
namespace {

constexpr const char* kSource = "thesis Secs. 6.1.3, 6.4.3 (named there; not printed)";

/// `value` within limits; what is no number stays none.
double Within(double value, double least, double largest) {
  return value < least ? least : value > largest ? largest : value;
}

/// A PI that begins at `initial` and holds its integral while the output is at a limit and would be driven further.
struct LimitedPi {
  double k_P, k_I, least, largest;
  double Step(double error, double period_s, double& integral) const {
    const double wanted = k_P * error + integral, given = Within(wanted, least, largest);
    if (!((wanted > given && error > 0.0) || (wanted < given && error < 0.0))) integral += period_s * k_I * error;
    return given;
  }
};

}  // namespace

PluginInfo EngineGovernor::Info() {
  return {"control",
          "engine_governor",
          "PI of the engine's speed by fuel, limited by the air at hand, with overspeed trip",
          "fuel = clamp(k_P e + s, 0, min(largest, air/(L lambda_least)))",
          kSource,
          {}};
}

EngineGovernor::EngineGovernor(const Params& params, double period_s) : p_(params), period_s_(period_s) {
  layout_.inputs = {{"reference", "rad/s", "speed that is wanted", 100.0},
                    {"speed", "rad/s", "speed that is", 100.0},
                    {"air", "kg", "air of the cylinder that was filled last", 0.1}};
  layout_.outputs = {{"fuel", "kg", "fuel for a cylinder and cycle", p_.largest_kg}};
  layout_.states = {{"integral", "kg", "integral part", p_.largest_kg},
                    {"begun", "1", "0 before the first tick", 1.0},
                    {"tripped", "1", "1 after an overspeed", 1.0}};
}

std::unique_ptr<EngineGovernor> EngineGovernor::Create(const Params& params, const Value& table,
                                                       BuildContext& context) {
  return std::unique_ptr<EngineGovernor>(new EngineGovernor(params, PeriodOf(table, context)));
}

void EngineGovernor::Output(const View& view, std::span<double> outputs) const {
  double states[3] = {view.states[0], view.states[1], view.states[2]};
  Tick(view, states, outputs);
}

void EngineGovernor::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  const double error = view.inputs[0] - view.inputs[1];
  const double by_air = view.inputs[2] / (p_.air_need * p_.least_air_ratio);
  const LimitedPi pi{p_.k_P_kgs_per_rad, p_.k_I_kg_per_rad, 0.0, by_air < p_.largest_kg ? by_air : p_.largest_kg};
  double integral = view.states[1] != 0.0 ? view.states[0] : p_.initial_kg - p_.k_P_kgs_per_rad * error;
  const bool tripped = view.states[2] != 0.0 || view.inputs[1] > p_.trip_rad_per_s;
  const double fuel = pi.Step(error, period_s_, integral);
  outputs[0] = tripped ? 0.0 : fuel;
  states[0] = integral;
  states[1] = 1.0;
  states[2] = tripped ? 1.0 : 0.0;
}

PluginInfo NoxControl::Info() {
  return {"control",
          "nox_control",
          "NOx by the air ratio: PI that opens the blow-off valve of the charge air",
          "blow_off = clamp(k_P e + s, 0, 100), e = 1 - NOx/limit",
          kSource,
          {}};
}

NoxControl::NoxControl(const Params& params, double period_s) : p_(params), period_s_(period_s) {
  layout_.inputs = {{"nox", "1", "NOx over its limit", 1.0}};
  layout_.outputs = {{"blow_off", "%", "position of the blow-off valve", 100.0}};
  layout_.states = {{"integral", "%", "integral part", 100.0}, {"begun", "1", "0 before the first tick", 1.0}};
}

std::unique_ptr<NoxControl> NoxControl::Create(const Params& params, const Value& table, BuildContext& context) {
  return std::unique_ptr<NoxControl>(new NoxControl(params, PeriodOf(table, context)));
}

void NoxControl::Output(const View& view, std::span<double> outputs) const {
  double states[2] = {view.states[0], view.states[1]};
  Tick(view, states, outputs);
}

void NoxControl::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  const LimitedPi pi{p_.k_P_percent, p_.k_I_percent_per_s, 0.0, 100.0};
  // NOx changes e-fold within a tenth of the air ratio: the error is kept within twice the limit.
  const double error = Within(1.0 - view.inputs[0], -1.0, 1.0);
  double integral = view.states[1] != 0.0 ? view.states[0] : p_.initial_percent - p_.k_P_percent * error;
  outputs[0] = pi.Step(error, period_s_, integral);
  states[0] = integral;
  states[1] = 1.0;
}

PluginInfo KnockControl::Info() {
  return {"control",
          "knock_control",
          "retards the ignition in steps while the engine knocks, and comes back slowly",
          "retard+ = retard + step while knock > 1, else retard - rate T",
          kSource,
          {}};
}

KnockControl::KnockControl(const Params& params, double period_s) : p_(params), period_s_(period_s) {
  layout_.inputs = {{"knock", "1", "knock intensity over its limit", 1.0}};
  layout_.outputs = {{"retard", "deg", "retard of the ignition", 10.0}};
  layout_.states = {{"retard", "deg", "retard of the ignition", 10.0}};
}

std::unique_ptr<KnockControl> KnockControl::Create(const Params& params, const Value& table, BuildContext& context) {
  return std::unique_ptr<KnockControl>(new KnockControl(params, PeriodOf(table, context)));
}

void KnockControl::Output(const View& view, std::span<double> outputs) const {
  double retard = 0.0;
  Tick(view, {&retard, 1}, outputs);
}

void KnockControl::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  const double knock = view.inputs[0];
  const double change = knock > 1.0 ? p_.step_deg : -p_.recovery_deg_per_s * period_s_;
  outputs[0] = std::isnan(knock) ? knock : Within(view.states[0] + change, 0.0, p_.largest_deg);
  states[0] = outputs[0];
}

PluginInfo VoltageControl::Info() {
  return {"control",
          "voltage_control",
          "voltage of a generator, lowered with the speed below a knee",
          "U = U_n clamp(1 - slope (w_knee - w)/w_n, least, 1)",
          kSource,
          {}};
}

VoltageControl::VoltageControl(const Params& params, double period_s)
    : p_(params), step_(params.lag_s > 0.0 ? -std::expm1(-period_s / params.lag_s) : 1.0) {
  layout_.inputs = {{"speed", "rad/s", "speed of the generator", 100.0}};
  layout_.outputs = {{"voltage", "V", "voltage", p_.rated_V}};
  layout_.states = {{"voltage", "V", "voltage", p_.rated_V}, {"begun", "1", "0 before the first tick", 1.0}};
}

std::unique_ptr<VoltageControl> VoltageControl::Create(const Params& params, const Value& table,
                                                       BuildContext& context) {
  return std::unique_ptr<VoltageControl>(new VoltageControl(params, PeriodOf(table, context)));
}

void VoltageControl::Output(const View& view, std::span<double> outputs) const {
  const double share = 1.0 - p_.slope * (p_.knee_rad_per_s - view.inputs[0]) / p_.rated_rad_per_s;
  const double wanted = p_.rated_V * Within(share, p_.least, 1.0);
  outputs[0] = view.states[1] != 0.0 ? view.states[0] + step_ * (wanted - view.states[0]) : wanted;
}

void VoltageControl::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  Output(view, outputs);
  states[0] = outputs[0];
  states[1] = 1.0;
}

PluginInfo GasReference::Info() {
  return {"control",
          "gas_reference",
          "pressure of the fuel gas, above the charge pressure by a fixed difference",
          "p_g* = p_ch* + difference",
          "thesis Sec. 6.1, Fig. 6.2 (p_g* named there; not printed)",
          {}};
}

GasReference::GasReference(const Params& params) : difference_(params.difference_Pa) {
  layout_.inputs = {{"charge", "Pa", "charge pressure that is wanted", 1e5}};
  layout_.outputs = {{"reference", "Pa", "gas pressure that is wanted", 1e5}};
}

void GasReference::Output(const View& view, std::span<double> outputs) const {
  outputs[0] = view.inputs[0] + difference_;
}

void GasReference::Tick(const View& view, std::span<double>, std::span<double> outputs) const { Output(view, outputs); }

}  // namespace dynoproof::controls
