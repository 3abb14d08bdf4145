#include "plugins/control/back_pressure_control/back_pressure_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plugins/named_sections.h"

namespace dynoproof::controls {
namespace {

enum State { kIntegral, kLargeArea, kBegun };

}  // namespace

void BackPressureControl::Params::Check(Faults& faults) const {
  constexpr const char* kNames[] = {"3", "4"};
  CheckNames(faults, "flap", flap, kNames);
}

PluginInfo BackPressureControl::Info() {
  return {"control",
          "back_pressure_control",
          "pressure of an exhaust pipe by a large and a small flap",
          "A = -w/(p/sqrt(R theta) Psi), A_3+ = A_3 + T/tau (A - A_4,middle - A_3), A_4 = A - A_3",
          "thesis Sec. 6.1.2 (named there; not printed), after (6.14)-(6.21)",
          {}};
}

BackPressureControl::BackPressureControl(const Params& params, double period_s)
    : p_(params),
      large_(Named(params.flap, "3").Area()),
      small_(Named(params.flap, "4").Area()),
      pi_{mechanics::FirstOrderLagGains(params.volume_m3 / (params.chi * params.R_J_per_kg_K * params.theta_K),
                                        2.0 * std::numbers::pi * params.bandwidth_Hz),
          AntiWindup::kConditioned, period_s},
      step_(-std::expm1(-period_s / params.middle_s)) {
  layout_.inputs = {{"reference", "Pa", "pressure that is wanted", 1e5}, {"pressure", "Pa", "pressure that is", 1e5}};
  layout_.outputs = {{"u_3", "%", "position of the large flap", 50.0}, {"u_4", "%", "of the small flap", 50.0}};
  layout_.states = {{"integral", "kg/s", "integral part", 1.0},
                    {"large_area", "m^2", "area of the large flap", 1e-3},
                    {"begun", "1", "0 before the first tick", 1.0}};
}

std::unique_ptr<BackPressureControl> BackPressureControl::Create(const Params& params, const Value& table,
                                                                 BuildContext& context) {
  return std::unique_ptr<BackPressureControl>(new BackPressureControl(params, PeriodOf(table, context)));
}

void BackPressureControl::Output(const View& view, std::span<double> outputs) const {
  double states[3] = {view.states[0], view.states[1], view.states[2]};
  Tick(view, states, outputs);
}

void BackPressureControl::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  const double reference = view.inputs[0], pressure = view.inputs[1];
  const mechanics::Gas gas{p_.R_J_per_kg_K, p_.theta_K};
  // Below a hundredth above ambient pressure no position gives a flow that says anything: the flaps then stand as there.
  const double per_area =
      mechanics::OrificeFlow(gas, 1.0, std::max(pressure, 1.01 * p_.ambient_pressure_Pa), p_.ambient_pressure_Pa);
  const bool begun = view.states[kBegun] != 0.0;
  const double start = large_.Area(p_.initial_u_3_percent) + small_.Area(p_.initial_u_4_percent);
  const double integral = begun ? view.states[kIntegral] : pi_.Fitting(reference, pressure, -start * per_area);
  const double before = begun ? view.states[kLargeArea] : large_.Area(p_.initial_u_3_percent);

  const double wanted = pi_.Wanted(reference, pressure, integral);
  const double least = large_.Area(0.0) + small_.Area(0.0), most = large_.Area(100.0) + small_.Area(100.0);
  const double area = std::clamp(-wanted / per_area, least, most);
  const double large =
      std::clamp(before + step_ * (area - small_.Area(50.0) - before), large_.Area(0.0), large_.Area(100.0));
  const double small = std::clamp(area - large, small_.Area(0.0), small_.Area(100.0));
  outputs[0] = large_.Position(large);
  outputs[1] = small_.Position(small);
  states[kIntegral] = pi_.NextIntegral(reference, pressure, integral, wanted, -(large + small) * per_area);
  states[kLargeArea] = large;
  states[kBegun] = 1.0;
}

}  // namespace dynoproof::controls
