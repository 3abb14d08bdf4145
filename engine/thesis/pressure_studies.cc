#include "thesis/pressure_studies.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "base/random.h"
#include "plugins/physics/gas_exchange.h"
#include "plugins/physics/gas_flow.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "thesis/pressure_loops.h"
#include "thesis/speed_loop.h"
#include "thesis/study_parameters.h"

namespace dynoproof {
namespace {

/// The scenario that the claim names, as written.
Result<Plan> PlanOf(const Value& parameters) {
  Diagnostics diagnostics;
  const std::vector<std::string> files = FindScenarios(parameters.TextOr("scenario"), diagnostics);
  std::optional<Plan> plan = files.size() == 1 ? LoadPlan(files[0], {}, diagnostics) : std::nullopt;
  if (!plan) return BadStudy("needs a \"scenario\"\n" + diagnostics.Format());
  return *plan;
}

/// The regulator of a scenario whose plant is fuel_gas with the linear valve.
Result<mechanics::Regulator> RegulatorOf(const Value& parameters) {
  const Result<Plan> plan = PlanOf(parameters);
  if (!plan.ok()) return plan.failure();
  const Value* plant = plan->root.Find("plant");
  if (plant == nullptr || plant->TextOr("type") != "fuel_gas") return BadStudy("the plant is not fuel_gas");
  const double R_theta = plant->NumberOr("R_J_per_kg_K", 518.0) * plant->NumberOr("theta_K", 300.0);
  return mechanics::Regulator{plant->NumberOr("mass_kg", 0.0),
                              plant->NumberOr("stiffness_N_per_m", 0.0),
                              plant->NumberOr("damping_Ns_per_m", 0.0),
                              plant->NumberOr("membrane_area_m2", 0.0),
                              plant->NumberOr("reservoir.res.pressure_Pa", 0.0) / std::sqrt(2.0 * R_theta) *
                                  plant->NumberOr("valve.v_g.area_slope_m", 0.0),
                              R_theta / plant->NumberOr("volume.V.volume_m3", 1.0)};
}

/// Largest relative distance of (6.20) with the gains (6.21) from (6.22), over six decades.
Result<Figure> FirstOrderLag(const Registry&, const Value& parameters) {
  const double f_n = parameters.NumberOr("bandwidth_Hz", 0.5), v_n = 2.0 * std::numbers::pi * f_n;
  const double capacity = parameters.NumberOr("volume_m3", 0.4) / (287.05 * 320.0);
  const mechanics::TransferPolynomials loop =
      mechanics::VolumeLoop(capacity, mechanics::FirstOrderLagGains(capacity, v_n));
  double worst = 0.0;
  for (double w = 1e-3 * v_n; w < 1e3 * v_n; w *= 1.3) {
    const std::complex<double> s(0.0, w), lag = v_n / (s + v_n);
    worst = std::max(worst,
                     std::abs(mechanics::Evaluate(loop.numerator, s) / mechanics::Evaluate(loop.denominator, s) - lag) /
                         std::abs(lag));
  }
  return Figure{worst, "1"};
}

Result<Figure> FlowFunctionStudy(const Registry&, const Value& parameters) {
  return Figure{mechanics::FlowFunctionDeviation(parameters.NumberOr("kappa", 1.4)), "1"};
}

/// Least stiffness (6.31), or a root of the regulator alone.
Result<Figure> RegulatorFigure(const Registry&, const Value& parameters) {
  const Result<mechanics::Regulator> regulator = RegulatorOf(parameters);
  if (!regulator.ok()) return regulator.failure();
  const std::string figure = parameters.TextOr("figure");
  if (figure == "least_stiffness") return Figure{mechanics::LeastStiffness(*regulator), "N/m"};
  if (figure == "integral_bound") return Figure{mechanics::LargestIntegralGain(*regulator, 0.0), "1/s"};
  if (figure == "loop_decay") {  // k_P = 0, k_I at that share of (6.38)
    const double k_I = parameters.NumberOr("share", 0.0) * mechanics::LargestIntegralGain(*regulator, 0.0);
    return Figure{mechanics::LargestRealPart(mechanics::RegulatorLoop(*regulator, {0.0, k_I, 1.0}).denominator), "1/s"};
  }
  const auto roots = mechanics::PolynomialRoots(mechanics::RegulatorPolynomial(*regulator));
  if (!roots.ok()) return roots.failure();
  if (figure == "fast_pole") return Figure{roots->real().minCoeff(), "1/s"};
  if (figure == "slow_pole") return Figure{roots->real().maxCoeff(), "1/s"};
  if (figure == "slow_pole_frequency") return Figure{roots->imag().maxCoeff(), "1/s"};
  return BadStudy(
      "needs a \"figure\": least_stiffness, integral_bound, loop_decay, fast_pole, slow_pole or slow_pole_frequency");
}

/// Where the eigenvalues cross the axis when one number is swept, over the printed bound.
Result<Figure> RegulatorBound(const Registry&, const Value& parameters) {
  const Result<mechanics::Regulator> found = RegulatorOf(parameters);
  if (!found.ok()) return found.failure();
  const mechanics::Regulator regulator = *found;
  const std::string swept = parameters.TextOr("swept");
  const double k_P = parameters.NumberOr("k_P", 0.0);
  double bound = 0.0, stable = 0.0, unstable = 0.0;
  std::function<double(double)> part;
  if (swept == "k_s") {
    bound = mechanics::LeastStiffness(regulator);
    stable = 3.0 * bound;
    unstable = 0.3 * bound;
    part = [regulator](double k_s) {
      mechanics::Regulator other = regulator;
      other.k_s = k_s;
      return mechanics::LargestRealPart(mechanics::RegulatorPolynomial(other));
    };
  } else if (swept == "k_P" || swept == "k_I") {
    const bool proportional = swept == "k_P";
    bound =
        proportional ? mechanics::LargestProportionalGain(regulator) : mechanics::LargestIntegralGain(regulator, k_P);
    stable = 0.1 * bound;
    unstable = 3.0 * bound;
    part = [regulator, proportional, k_P](double gain) {
      const mechanics::PiGains gains =
          proportional ? mechanics::PiGains{gain, 1e-9, 1.0} : mechanics::PiGains{k_P, gain, 1.0};
      return mechanics::LargestRealPart(mechanics::RegulatorLoop(regulator, gains).denominator);
    };
  } else {
    return BadStudy("needs \"swept\": k_s, k_P or k_I");
  }
  if (!(part(stable) < 0.0 && part(unstable) > 0.0)) return BadStudy("the sweep does not cross the axis");
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (stable + unstable);
    (part(middle) < 0.0 ? stable : unstable) = middle;
  }
  return Figure{0.5 * (stable + unstable) / bound, "1"};
}

/// The steady gas pressure of the plant less that of (6.32), with d_q or as printed.
Result<Figure> RegulatorSteady(const Registry& registry, const Value& parameters) {
  const Result<mechanics::Regulator> regulator = RegulatorOf(parameters);
  const Result<Plan> plan = PlanOf(parameters);
  if (!regulator.ok()) return regulator.failure();
  const Value& table = *plan->root.Find("plant");
  Diagnostics diagnostics;
  BuildContext context{registry, diagnostics, "plant", {"inputs"}};
  const std::unique_ptr<Component> plant = registry.MakeComponent("plant", table, context);
  if (plant == nullptr) return BadStudy(diagnostics.Format());
  const double inputs[] = {parameters.NumberOr("p_mem", 5e5), parameters.NumberOr("q_e", 0.02)};
  double states[3] = {}, rates[3] = {};
  plant->Start(inputs, states, {});
  plant->Derivative({0.0, inputs, states, {}}, rates);
  // Rest to round-off: forces of 1e4 N, flows that change a pressure by 1e5 Pa/s.
  if (std::abs(rates[1]) > 1e-8 || std::abs(rates[2]) > 1e-5) return BadStudy("the plant does not start at rest");
  const double d_q = Flag(parameters, "as_printed") ? 0.0 : table.NumberOr("valve.v_g.flow_at_rest_kg_per_s", 0.0);
  const double formula = inputs[0] - table.NumberOr("preload_N", 0.0) / regulator->A -
                         regulator->k_s / regulator->A * (inputs[1] - d_q) / regulator->k_q;
  return Figure{states[2] - formula, "Pa"};
}

/// K of (6.13) at that speed: (6.14), as it is printed, asks for (1 + K) times the charge pressure. `by_flows`: the ratio
/// of the two pressures at which the first flap lets through what the engine takes, (6.4) and (6.10), by bisection.
Result<Figure> PlannedReference(const Registry&, const Value& parameters) {
  const Result<Plan> plan = PlanOf(parameters);
  if (!plan.ok()) return plan.failure();
  const Value* control = plan->root.FindPath("control.proposed");
  if (control == nullptr) return BadStudy("the scenario has no [control.proposed]");
  const double swept = control->NumberOr("volumetric_efficiency", 1.0) * control->NumberOr("displacement_m3", 0.0) *
                       parameters.NumberOr("speed", 0.0) / (4.0 * std::numbers::pi);
  const double area = mechanics::FlapArea::Cosine(control->NumberOr("flap.1.area_offset_m2", 0.0),
                                                  control->NumberOr("flap.1.area_span_m2", 1.0))
                          .Area(25.0);
  if (Flag(parameters, "by_flows")) {
    constexpr double kRTheta = 287.05 * 320.0, p_ch = 2e5;
    double low = 1.0, high = 2.0;
    for (int i = 0; i < 60; ++i) {
      const double ratio = 0.5 * (low + high), psi = std::sqrt(2.0 / ratio * (1.0 - 1.0 / ratio));
      const double through = area * ratio * p_ch / std::sqrt(kRTheta) * psi, taken = p_ch / kRTheta * swept;
      (through < taken ? low : high) = ratio;
    }
    return Figure{low, "1"};
  }
  return Figure{mechanics::PressureSurplus(swept, area, 287.05 * 320.0), "1"};
}

/// Largest relative distance of (6.1), as printed, from the rate of the pressure that the balances of mass and energy
/// give, over states of a cylinder that differ in everything. `displacement`: with the constant displacement volume in
/// the place of the momentary one, as the text names it.
Result<Figure> CylinderRate(const Registry&, const Value& parameters) {
  const bool displacement = Flag(parameters, "displacement");
  const mechanics::GasPair gases;
  std::uint64_t drawn = 0;
  const auto between = [&drawn](double low, double high) { return low + (high - low) * RandomUniform(61, 0, drawn++); };
  double worst = 0.0;
  for (int n = 0; n < 200; ++n) {
    const mechanics::GasState gas = StateAt(gases, between(0.5e5, 50e5), between(300.0, 1500.0), between(0.0, 1.0));
    const double volume = between(2.4e-3, 29e-3), dV = between(-1.0, 1.0), Q_w = between(-1e5, 1e4);
    const double q_in = between(0.0, 3.0), h_in = between(2e5, 5e5), q_out = between(0.0, 3.0);
    const double h_out = gas.cp * gas.theta;
    const double dm[2] = {q_in - q_out * gas.portion[0], -q_out * gas.portion[1]};
    const mechanics::Charge charge = ChargeOf(gas, volume);
    const double dU = q_in * h_in - q_out * h_out + Q_w - gas.pressure * dV;
    double sum_R = 0.0, sum_cv = 0.0;
    for (int j = 0; j < 2; ++j) {
      sum_R += gases.R[j] * dm[j];
      sum_cv += gases.R[j] / (gases.chi[j] - 1.0) * dm[j];
    }
    const double V_cyl = displacement ? 26.6e-3 : volume, dV_cyl = displacement ? 0.0 : dV;
    const double printed = (gas.chi - 1.0) / V_cyl *
                           (gas.theta / (gas.chi - 1.0) * sum_R - gas.theta * sum_cv -
                            gas.chi / (gas.chi - 1.0) * gas.pressure * dV_cyl + Q_w + q_in * h_in - q_out * h_out);
    const double h = 1e-7;
    const auto pressure = [&](double t) {
      const mechanics::Charge then = {{charge.mass[0] + t * dm[0], charge.mass[1] + t * dm[1]}, charge.energy + t * dU};
      return StateOf(gases, then, volume + t * dV).pressure;
    };
    // Over what the largest of its terms alone would do: they may cancel.
    const double scale =
        (gas.chi - 1.0) / volume * (q_in * h_in + q_out * h_out + std::abs(Q_w) + gas.pressure * std::abs(dV));
    worst = std::max(worst, std::abs((pressure(h) - pressure(-h)) / (2.0 * h) - printed) / scale);
  }
  return Figure{worst, "1"};
}

}  // namespace

std::map<std::string, Study, std::less<>> PressureStudies() {
  return {{"pressure_cylinder_rate", CylinderRate},      {"pressure_first_order_lag", FirstOrderLag},
          {"pressure_flow_function", FlowFunctionStudy}, {"pressure_planned_reference", PlannedReference},
          {"pressure_regulator", RegulatorFigure},       {"pressure_regulator_bound", RegulatorBound},
          {"pressure_regulator_steady", RegulatorSteady}};
}

}  // namespace dynoproof
