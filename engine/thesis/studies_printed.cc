#include "thesis/studies_printed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>

#include "base/random.h"
#include "linear/zeros.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "thesis/parametrisation.h"
#include "thesis/study_parameters.h"

namespace dynoproof {
namespace {

Result<Plan> PlanNamed(const Value& parameters, const char* key) {
  Diagnostics diagnostics;
  const std::vector<std::string> files = FindScenarios(parameters.TextOr(key), diagnostics);
  std::optional<Plan> plan = files.size() == 1 ? LoadPlan(files[0], {}, diagnostics) : std::nullopt;
  if (!plan) return BadStudy(fmt::format("needs a \"{}\"\n{}", key, diagnostics.Format()));
  return *plan;
}

/// Sum of the numbers that `keys` names by dotted paths.
Result<double> Sum(const Plan& plan, const Value& parameters, const char* keys) {
  const Value* paths = parameters.Find(keys);
  if (paths == nullptr || !paths->is_array()) return BadStudy(fmt::format("needs \"{}\"", keys));
  double sum = 0.0;
  for (const Value& path : paths->array()) {
    const Value* number = path.is_string() ? plan.root.FindPath(path.string()) : nullptr;
    if (number == nullptr || !number->is_number())
      return BadStudy(fmt::format("an item of \"{}\" names no number", keys));
    sum += number->number();
  }
  return sum;
}

/// What tables say: the sum of `keys` of `scenario` (or `value`), less that of `less` (another scenario), over that of
/// `over_keys`, `times` a factor, as a deviation from `percent_off` in per cent. `unit` is the figure's.
Result<Figure> TableValue(const Registry&, const Value& parameters) {
  double value = parameters.NumberOr("value", 0.0);
  if (parameters.Find("scenario") != nullptr) {
    const Result<Plan> plan = PlanNamed(parameters, "scenario");
    if (!plan.ok()) return plan.failure();
    const Result<double> sum = Sum(*plan, parameters, "keys");
    if (!sum.ok()) return sum.failure();
    value = *sum;
    if (parameters.Find("over_keys") != nullptr) {
      const Result<double> over = Sum(*plan, parameters, "over_keys");
      if (!over.ok()) return over.failure();
      value /= *over;
    }
  }
  if (parameters.Find("less") != nullptr) {
    const Result<Plan> plan = PlanNamed(parameters, "less");
    if (!plan.ok()) return plan.failure();
    const Result<double> sum = Sum(*plan, parameters, "keys");
    if (!sum.ok()) return sum.failure();
    value -= *sum;
  }
  value *= parameters.NumberOr("times", 1.0);
  if (parameters.Find("percent_off") != nullptr)
    value = 100.0 * (value / parameters.NumberOr("percent_off", 1.0) - 1.0);
  return Figure{value, parameters.TextOr("unit", "1")};
}

/// Moment of inertia of a full disc.
Result<Figure> DiscInertia(const Registry&, const Value& parameters) {
  const double radius = 0.5 * parameters.NumberOr("diameter_m", 0.0), length = parameters.NumberOr("length_m", 0.0);
  const double mass = parameters.NumberOr("density_kg_per_m3", 0.0) * std::numbers::pi * radius * radius * length;
  return Figure{0.5 * mass * radius * radius, "kg m^2"};
}

/// How many springs and inertias determine the resonances of a scenario's drive line.
Result<Figure> ParameterCount(const Registry&, const Value& parameters) {
  const Result<Plan> plan = PlanNamed(parameters, "scenario");
  if (!plan.ok()) return plan.failure();
  std::size_t count = 0;
  for (const auto& [table, each] : {std::pair{"plant.inertia", 1}, {"plant.shaft", 1}, {"plant.rotor", 2}}) {
    const Value* found = plan->root.FindPath(table);
    if (found != nullptr) count += static_cast<std::size_t>(each) * KeysOf(*found).size();
  }
  return Figure{static_cast<double>(count), "1"};
}

/// The lowest transfer zero of a three-mass oscillator whose airgap torque is split between I1 and I2, over all weights
/// that are not negative, over sqrt(k1/I1).
Result<Figure> LowestSplitZero(const Registry&, const Value&) {
  mechanics::Network network;
  network.nodes = {{"I1", 3.0}, {"I2", 1.5}, {"I3", 0.4}};
  network.edges = {{"k1", 0, 1, 2e6, 0.0}, {"k2", 1, 2, 1e6, 0.0}};
  double lowest = INFINITY;
  for (int i = 0; i < 50; ++i) {
    const double share = 0.02 * i;  // of the torque on I1
    const Eigen::Vector3d input(share, 1.0 - share, 0.0);
    const auto zeros = mechanics::TransferZeros(network, input, {mechanics::OutputKind::kEdgeTorque, 1});
    if (!zeros.ok()) return zeros.failure();
    for (const mechanics::Zero& zero : zeros->zeros) {
      if (zero.oscillatory) lowest = std::min(lowest, std::abs(zero.s) / std::sqrt(2e6 / 3.0));
    }
  }
  return Figure{lowest, "1"};
}

/// k_1 of the first tuple (2.65) with a huge I_2, over the nu_1^2 I_1 that (2.67) gives; nu_1 < nu_2 unless `reversed`.
Result<Figure> WideMiddle(const Registry&, const Value& parameters) {
  const bool reversed = Flag(parameters, "reversed");
  const double I1 = 2.0, nu_1 = reversed ? 900.0 : 300.0, nu_2 = reversed ? 300.0 : 900.0;
  const mechanics::ThreeMassSolution solution = mechanics::ThreeMassStiffnesses(I1, 1e9, 0.7, nu_1, nu_2);
  if (!solution.first) return BadStudy("no solution");
  return Figure{solution.first->k1 / (nu_1 * nu_1 * I1), "1"};
}

/// The motion at the gap after contact was lost, at a constant omega_d (assumption 4 of Sec. 3.3.2): (3.6) integrated
/// in small steps from the moment at which the torque vanishes, for two time constants.
struct AtGap {
  double phi_d, omega_d, phi_b, omega_b;
};
constexpr double kStiffness = 15e3, kDamping = 0.5, kHalfGap = 0.09599310885968812;  // Table C.2

AtGap LeaveContact(double side, double omega_d, double c_f) {
  // `side` is the sign of the contact that is lost; there T = k (phi_d - side alpha) + c omega_d = 0.
  const double tau = (kDamping + c_f) / kStiffness, start = side * kHalfGap - kDamping / kStiffness * omega_d;
  const int steps = 20000;
  const double h = 2.0 * tau / steps;
  AtGap at = {start, omega_d, side * kHalfGap, 0.0};
  const auto rate = [&](double t, double phi_b) {
    return (kStiffness * (start + omega_d * t - phi_b) + kDamping * omega_d) / (kDamping + c_f);
  };
  for (int i = 0; i < steps; ++i) {
    const double t = i * h, k1 = rate(t, at.phi_b), k2 = rate(t + 0.5 * h, at.phi_b + 0.5 * h * k1);
    const double k3 = rate(t + 0.5 * h, at.phi_b + 0.5 * h * k2), k4 = rate(t + h, at.phi_b + h * k3);
    at.phi_b += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  at.phi_d = start + omega_d * steps * h;
  at.omega_b = rate(steps * h, at.phi_b);
  return at;
}

/// Angle at the gap in A- of (3.4), contact lost at the right, less the integrated one, over alpha; with (phi_d +
/// alpha) in the exponent when `as_printed`.
Result<Figure> GapAngle(const Registry&, const Value& parameters) {
  const AtGap at = LeaveContact(1.0, -100.0, 0.0);
  const double sign = Flag(parameters, "as_printed") ? 1.0 : -1.0;
  const double exponent = -kStiffness / kDamping * (at.phi_d + sign * kHalfGap) / at.omega_d - 1.0;
  const double formula = at.phi_d + kDamping / kStiffness * at.omega_d * std::exp(exponent);
  return Figure{std::abs(formula - at.phi_b) / kHalfGap, "1"};
}

/// Speed at the gap by (3.14), contact lost at the left, less the integrated one, over omega_d.
Result<Figure> GapSpeed(const Registry&, const Value& parameters) {
  const double c_f = parameters.NumberOr("c_f", 0.1);
  const AtGap at = LeaveContact(-1.0, 100.0, c_f);
  const double fading =
      std::exp(-kStiffness / (kDamping + c_f) * ((at.phi_d + kHalfGap) / at.omega_d + kDamping / kStiffness));
  const double formula = at.omega_d - (Flag(parameters, "as_printed") ? at.phi_b : at.omega_d) * fading;
  return Figure{std::abs(formula - at.omega_b) / at.omega_d, "1"};
}

/// Torque at rest in the middle of the gap by (3.13), (3.15).
Result<Figure> TorqueInTheMiddle(const Registry&, const Value& parameters) {
  const double phi_d = 0.0, omega_d = 0.0, shift = Flag(parameters, "as_printed") ? -kHalfGap : kHalfGap;
  const bool left = kStiffness * (phi_d + shift) + kDamping * omega_d <= 0.0;  // second line of A-
  return Figure{left ? kStiffness * (phi_d + kHalfGap) + kDamping * omega_d : 0.0, "N m"};
}

/// 1 when a shaft is connected with an inertia while the shaft with play is taken out, else 0.
Result<Figure> Reaches(const Registry&, const Value& parameters) {
  const Result<Plan> plan = PlanNamed(parameters, "scenario");
  if (!plan.ok()) return plan.failure();
  const Value* shafts = plan->root.FindPath("plant.shaft");
  if (shafts == nullptr) return BadStudy("the scenario has no shafts");
  std::set<std::string> reached = {parameters.TextOr("from")};
  for (std::size_t before = 0; before != reached.size();) {
    before = reached.size();
    for (const Value::Entry& shaft : shafts->table()) {
      const Value* between = shaft.value.Find("between");
      if (shaft.key == "backlash" || between == nullptr) continue;
      const std::string a = between->array()[0].string(), b = between->array()[1].string();
      if (reached.contains(a) || reached.contains(b)) reached.insert({a, b});
    }
  }
  const Value* between = shafts->FindPath(parameters.TextOr("shaft") + ".between");
  if (between == nullptr) return BadStudy("no such shaft");
  return Figure{reached.contains(between->array()[0].string()) ? 1.0 : 0.0, "1"};
}

/// Of the estimator of Sec. 5.6: N samples of T_d = 100 us, N_g bins, N_s differences in (5.36). `quantity`: resolution
/// [Hz], last_bin [Hz], interval [s] (between the first and the last result), results (how many results (5.36) takes).
Result<Figure> SpectrumGrid(const Registry&, const Value& parameters) {
  const double N = 128.0, N_g = 24.0, T_d = 1e-4;
  const int N_s = 10;
  const std::string quantity = parameters.TextOr("quantity");
  if (quantity == "resolution") return Figure{1.0 / (N * T_d), "Hz"};
  if (quantity == "last_bin") return Figure{N_g / (N * T_d), "Hz"};
  std::set<int> results;
  for (int i = 0; i < N_s; ++i) results.insert({i, i + 1});
  if (quantity == "interval") return Figure{(*results.rbegin() - *results.begin()) * N * T_d, "s"};
  if (quantity == "results") return Figure{static_cast<double>(results.size()), "1"};
  return BadStudy("quantity is resolution, last_bin, interval or results");
}

/// What (5.37) takes from a stored amplitude in `hours`, multiplied step by step at 10 kHz, in the precision of T.
template <class T>
double Faded(double hours) {
  const T alpha = static_cast<T>(1.0 - 1e-9);
  T amplitude = 1;
  const auto steps = static_cast<std::int64_t>(hours * 3600.0 * 1e4);
  for (std::int64_t i = 0; i < steps; ++i) amplitude *= alpha;
  return 1.0 - static_cast<double>(amplitude);
}
Result<Figure> AmplitudeFade(const Registry&, const Value& parameters) {
  const double hours = parameters.NumberOr("hours", 1.0);
  return Figure{parameters.TextOr("precision") == "single" ? Faded<float>(hours) : Faded<double>(hours), "1"};
}

/// How many of 1000 drawn radii rise by (E.1) with a drawn gamma >= 0.
Result<Figure> RadiusRises(const Registry&, const Value&) {
  int rising = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const double r_min = 0.9, r = r_min + 0.1 * RandomUniform(91, 0, i), gamma = 0.01 * RandomUniform(91, 1, i);
    rising += std::min(1.0, std::max(r - gamma, r_min)) > r ? 1 : 0;
  }
  return Figure{static_cast<double>(rising), "1"};
}

}  // namespace

std::map<std::string, Study, std::less<>> PrintedStudies() {
  return {{"amplitude_fade", AmplitudeFade},
          {"disc_inertia", DiscInertia},
          {"gap_angle", GapAngle},
          {"gap_speed", GapSpeed},
          {"gap_torque_in_the_middle", TorqueInTheMiddle},
          {"lowest_split_zero", LowestSplitZero},
          {"parameter_count", ParameterCount},
          {"radius_rises", RadiusRises},
          {"reaches_without_play", Reaches},
          {"spectrum_grid", SpectrumGrid},
          {"table_value", TableValue},
          {"wide_middle_limit", WideMiddle}};
}

}  // namespace dynoproof
