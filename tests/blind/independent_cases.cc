#include "tests/blind/independent_cases.h"

#include <cmath>

#include "score/series.h"
#include "tests/blind/independent_line.h"
#include "tests/blind/independent_pressures.h"

namespace dynoproof::blind {
namespace {

/// Around 1 for a fault worth finding; a third of the cases are weak.
double StrengthOf(Case& hidden, Dice& dice, bool with_effect) {
  const double u = dice.Uniform(0.7, 1.4), share = dice.Index(3) == 0 && with_effect ? 0.3 : 1.0;
  hidden.strength = share;
  return share * u;
}

unsigned SeedFrom(Dice& dice) { return static_cast<unsigned>(dice.Index(1000000)); }

double Off(double value, double spread, Dice& dice) { return value * (1.0 + spread * dice.Uniform(-1.0, 1.0)); }

std::vector<double> Times(std::size_t samples, double period_s) {
  std::vector<double> times;
  for (std::size_t i = 0; i < samples; ++i) times.push_back(period_s * static_cast<double>(i));
  return times;
}

std::vector<double> Plus(double constant, std::vector<double> values) {
  for (double& v : values) v += constant;
  return values;
}

void Hide(Case& hidden, const char* effect, const std::string& at, double parameter) {
  hidden.causes = {{effect, at, {parameter}}};
}

Columns LineCase(Case& hidden, Dice& dice, double duration_s, bool with_effect, bool unknown) {
  IndependentLine line;
  for (double& value : line.inertia) value = Off(value, 0.003, dice);
  for (double& value : line.stiffness) value = Off(value, 0.003, dice);
  for (double& value : line.damping) value = Off(value, 0.03, dice);
  const std::size_t where = dice.Index(5), shaft = dice.Index(4), what = dice.Index(7);
  const double u = StrengthOf(hidden, dice, with_effect);
  if (unknown) {
    if (what % 2 == 0) {
      // A spring with hysteresis: stiffness that depends on the direction of twisting.
      line.shaft[2] = [u](double d, double w) { return 0.25 * u * 3.36e6 * d * std::tanh(w / 0.05); };
      hidden.unknown = "spring with hysteresis";
    } else {
      line.load[4] = [u](double w) { return 20.0 * u * std::sin(40.0 * w); };
      hidden.unknown = "load that waves with the speed";
    }
  } else if (with_effect) {
    const std::string inertia = "inertia:I" + std::to_string(where + 1), k = "shaft:k" + std::to_string(shaft + 1);
    if (what == 0) {
      hidden.causes = {{"viscous_friction", inertia, {10.0 * u}}};
      line.load[where] = [b = 10.0 * u](double w) { return -b * w; };
    } else if (what == 1) {
      hidden.causes = {{"quadratic_drag", inertia, {1.5 * u}}};
      line.load[where] = [b = 1.5 * u](double w) { return -b * w * std::abs(w); };
    } else if (what == 2) {
      line.inertia[where] *= 1.0 + 0.3 * u;
      Hide(hidden, "inertia_change", inertia, line.inertia[where] / IndependentLine().inertia[where] - 1.0);
    } else if (what == 3) {
      line.stiffness[shaft] *= 1.0 - 0.2 * u;
      Hide(hidden, "stiffness_change", k, line.stiffness[shaft] / IndependentLine().stiffness[shaft] - 1.0);
    } else if (what == 4) {
      hidden.causes = {{"actuator_gain", "input:T_airgap", {1.0 + 0.08 * u}}};
      line.actuator = [g = 1.0 + 0.08 * u](double x) { return g * x; };
    } else if (what == 5) {
      hidden.causes = {{"actuator_dead_zone", "input:T_airgap", {150.0 * u}}};
      line.actuator = [h = 75.0 * u](double x) { return x > h ? x - h : x < -h ? x + h : 0.0; };
    } else {
      hidden.causes = {{"actuator_harmonic", "input:T_airgap", {0.1 * u, 0.05 * u}}};
      line.actuator = [a = 0.1 * u, b = 0.05 * u](double x) { return x + a * x * x / 1000.0 + b * x * x * x / 1e6; };
    }
  } else if (hidden.kind == "decoy") {
    line.start_speed = dice.Uniform(-3.0, 3.0);
  }
  const auto samples = static_cast<std::size_t>(duration_s * 1e4) + 1;
  Columns columns{Times(samples, 1e-4), {}, {}};
  columns.inputs["T_airgap"] = IndependentTorque(samples, static_cast<unsigned>(dice.Uniform(1, 1e6)));
  IndependentLine::Output output = line.Run(columns.inputs["T_airgap"]);
  columns.outputs = {{"T_shaft", std::move(output.T_shaft)}, {"omega_1", std::move(output.omega_1)}};
  return columns;
}

/// What a channel's chain does to it, at the substeps of a simulation: dead time or lag where the effect is there.
std::vector<double> ThroughChain(const Case& hidden, const std::string& input, const std::vector<double>& values,
                                 double period_s, int substeps) {
  double delay_s = 0.0;
  for (const Cause& cause : hidden.causes) {
    if (cause.at != "input:" + input) continue;
    if (cause.effect == "actuator_lag") return Lagged(values, cause.parameters[0], period_s, substeps);
    if (cause.effect == "actuator_delay") delay_s = cause.parameters[0];
  }
  return Delayed(values, delay_s, period_s, substeps);
}

/// The same for a sensor; the values are samples.
std::vector<double> ThroughSensor(const Case& hidden, const std::string& output, std::vector<double> values,
                                  double period_s) {
  for (const Cause& cause : hidden.causes) {
    if (cause.at != "output:" + output) continue;
    const double p = cause.parameters[0];
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (cause.effect == "sensor_offset") values[i] += p;
      if (cause.effect == "sensor_gain") values[i] *= p;
      if (cause.effect == "sensor_drift") values[i] += p * period_s * static_cast<double>(i);
    }
  }
  return values;
}

Columns GasCase(Case& hidden, Dice& dice, bool with_effect) {
  constexpr double kPeriod_s = 1e-3;
  constexpr std::size_t kSamples = 20001;
  IndependentGas gas;
  for (double* value : {&gas.mass, &gas.stiffness, &gas.preload, &gas.volume}) *value = Off(*value, 0.003, dice);
  gas.damping = Off(gas.damping, 0.03, dice);
  Columns columns{Times(kSamples, kPeriod_s), {}, {}};
  std::vector<double> p_mem = IndependentSines(kSamples, kPeriod_s, SeedFrom(dice), 400.0, 0.13, 70.0, 90);
  const std::vector<double> slow = IndependentSines(kSamples, kPeriod_s, 7, 2e4, 0.05, 0.3, 3);
  for (std::size_t i = 0; i < kSamples; ++i) p_mem[i] += 5e5 + slow[i];
  columns.inputs["p_mem"] = std::move(p_mem);
  columns.inputs["q_e"] = Plus(0.03, IndependentSines(kSamples, kPeriod_s, SeedFrom(dice), 0.002, 0.12, 18.0, 50));
  const std::size_t what = dice.Index(7);
  const double sign = dice.Sign(), u = StrengthOf(hidden, dice, with_effect);
  if (with_effect) {
    const double swing = score::StandardDeviation(columns.inputs["p_mem"]);
    if (what == 0) Hide(hidden, "leakage", "volume:V", gas.leak = 2e-6 * u);
    if (what == 1) Hide(hidden, "flow_area_error", "valve:v_g", gas.area_factor = 1.0 + 0.08 * u * sign);
    if (what == 2) Hide(hidden, "actuator_lag", "input:p_mem", 5e-3 * u);
    if (what == 3) Hide(hidden, "actuator_delay", dice.Sign() > 0.0 ? "input:p_mem" : "input:q_e", 5e-3 * u);
    if (what == 4) Hide(hidden, "supply_droop", "reservoir:res", gas.droop = 1e6 * u);
    if (what == 5) Hide(hidden, "sensor_gain", "output:p_g", 1.0 + 0.08 * u * sign);
    if (what == 6) Hide(hidden, "sensor_drift", "output:p_g", 0.6 * swing / columns.time.back() * u * sign);
  }
  const auto through = [&](const char* input) {
    return ThroughChain(hidden, input, columns.inputs[input], kPeriod_s, IndependentGas::kSubsteps);
  };
  columns.outputs["p_g"] =
      ThroughSensor(hidden, "p_g", gas.Run(through("p_mem"), through("q_e"), kPeriod_s), kPeriod_s);
  return columns;
}

Columns AirCase(Case& hidden, Dice& dice, bool with_effect) {
  constexpr double kPeriod_s = 0.02;
  constexpr std::size_t kSamples = 10001;
  IndependentAir air;
  for (double& value : air.volume) value = Off(value, 0.003, dice);
  Columns columns{Times(kSamples, kPeriod_s), {}, {}};
  const auto sines = [&](double mean, double rms, double high_Hz) {
    return Plus(mean, IndependentSines(kSamples, kPeriod_s, SeedFrom(dice), rms, 0.012, high_Hz, 45));
  };
  columns.inputs = {{"u_1", sines(27.0, 3.0, 2.0)},
                    {"u_2", sines(29.0, 2.0, 1.1)},
                    {"q_e", sines(0.75, 0.05, 0.9)},
                    {"q_c", sines(1.3, 0.03, 0.5)}};
  const std::size_t what = dice.Index(7), which = dice.Index(2);
  const double sign = dice.Sign(), u = StrengthOf(hidden, dice, with_effect);
  const std::string number = which == 0 ? "1" : "2", output = which == 0 ? "p_ch" : "p_s";
  // How far the healthy plant's pressures swing: some 2e4 and 4e4 Pa.
  const double swing = which == 0 ? 2e4 : 4e4;
  if (with_effect) {
    if (what == 0) Hide(hidden, "leakage", "volume:V_" + number, air.leak[which] = 4e-5 * u);
    if (what == 1) Hide(hidden, "flow_area_error", "flap:" + number, air.area_factor[which] = 1.0 + 0.08 * u * sign);
    if (what == 2) Hide(hidden, "actuator_lag", "input:u_" + number, 0.3 * u);
    if (what == 3) Hide(hidden, "actuator_delay", "input:u_" + number, 0.2 * u);
    if (what == 4) Hide(hidden, "sensor_offset", "output:" + output, 0.3 * swing * u * sign);
    if (what == 5) Hide(hidden, "sensor_gain", "output:" + output, 1.0 + 0.08 * u * sign);
    if (what == 6) Hide(hidden, "sensor_drift", "output:" + output, 0.6 * swing / columns.time.back() * u * sign);
  }
  const auto through = [&](const char* input) {
    return ThroughChain(hidden, input, columns.inputs[input], kPeriod_s, IndependentAir::kSubsteps);
  };
  auto pressures = air.Run({through("u_1"), through("u_2"), through("q_e"), through("q_c")}, kPeriod_s);
  columns.outputs["p_ch"] = ThroughSensor(hidden, "p_ch", std::move(pressures[0]), kPeriod_s);
  columns.outputs["p_s"] = ThroughSensor(hidden, "p_s", std::move(pressures[1]), kPeriod_s);
  return columns;
}

}  // namespace

bool HasIndependent(const std::string& scenario) {
  return scenario == "diagnose/heavy_duty_lumped" || scenario == "diagnose/fuel_gas" ||
         scenario == "diagnose/charge_air";
}

Columns FromIndependent(Case& hidden, Dice& dice, double duration_s, bool with_effect, bool unknown) {
  if (hidden.scenario == "diagnose/fuel_gas") return GasCase(hidden, dice, with_effect);
  if (hidden.scenario == "diagnose/charge_air") return AirCase(hidden, dice, with_effect);
  return LineCase(hidden, dice, duration_s, with_effect, unknown);
}

}  // namespace dynoproof::blind
