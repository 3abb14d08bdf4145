#include "thesis/studies_formulas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>

#include "scenario/find.h"
#include "scenario/load.h"

namespace dynoproof {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// Power over angular speed of a machine's data sheet [kN m].
Result<Figure> RatedTorque(const Registry&, const Value& parameters) {
  const double speed = parameters.NumberOr("speed_rpm", 0.0) * pi / 30.0;
  return Figure{parameters.NumberOr("power_kW", 0.0) / speed, "kN m"};
}

/// The acceleration of the first slice of a rotor by (2.102), as printed with phi_1 - phi_2 or the other way round, over
/// that by the gradient of the strain energy.
Result<Figure> FreeEnd(const Registry&, const Value& parameters) {
  const Value* printed = parameters.Find("as_printed");
  const bool wrong = printed != nullptr && printed->is_bool() && printed->boolean();
  constexpr int N = 5;
  constexpr double kI = 25.0, kK = 16.5e6;
  const std::array<double, N> phi = {0.3e-3, -0.1e-3, 0.4e-3, 0.2e-3, 0.0};
  const auto energy = [](const std::array<double, N>& at) {
    double sum = 0.0;
    for (int i = 0; i + 1 < N; ++i) sum += 0.5 * kK * (N - 1) * (at[i] - at[i + 1]) * (at[i] - at[i + 1]);
    return sum;
  };
  constexpr double h = 1e-6;
  std::array<double, N> right = phi, left = phi;
  right[0] += h;
  left[0] -= h;
  const double by_energy = -(energy(right) - energy(left)) / (2.0 * h) / (kI / N);
  // (L / Delta x)^2 stands for N (N - 1), as (2.95) has it.
  const double by_formula = N * (N - 1) * kK / kI * (wrong ? phi[0] - phi[1] : phi[1] - phi[0]);
  return Figure{by_formula / by_energy, "1"};
}

/// abs(X) of a complex tone of amplitude 1 between two bins by (5.16), `delta` bins away.
double PlainEntry(double delta, int N) {
  return delta == 0.0 ? N : std::abs(std::sin(pi * delta)) / std::abs(std::sin(pi / N * delta));
}

/// (5.22) for a tone at `delta`.
double PlainOffset(double delta, int N) {
  const double middle = PlainEntry(delta, N);
  const double difference = PlainEntry(delta - 1.0, N) - PlainEntry(delta + 1.0, N);
  const double sign = difference > 0.0 ? 1.0 : difference < 0.0 ? -1.0 : 0.0;
  return std::sqrt(difference / (2.0 * sign * middle + difference)) * sign;
}

/// The largest error of (5.22) over offsets below half a bin, in bins; with `undefined` the number of offsets, in steps
/// of 1/64 of a bin, at which it gives no number.
Result<Figure> PlainInterpolation(const Registry&, const Value& parameters) {
  const Value* count = parameters.Find("undefined");
  const int N = static_cast<int>(parameters.NumberOr("N", 128.0));
  double worst = 0.0;
  int undefined = 0;
  for (int i = -32; i <= 32; ++i) {
    const double delta = i / 64.0, found = PlainOffset(delta, N);
    if (std::isfinite(found)) {
      worst = std::max(worst, std::abs(found - delta));
    } else {
      ++undefined;
    }
  }
  return Figure{count != nullptr ? undefined : worst, "1"};
}

/// abs(X) / N of a complex tone of amplitude 1 behind the Blackman window (5.23), `delta` bins from the bin, by its sum.
double WindowedEntry(double delta, int N) {
  Complex sum = 0.0;
  for (int n = 0; n < N; ++n) {
    const double x = 2.0 * pi * n / N;
    sum += (0.42 - 0.5 * std::cos(x) + 0.08 * std::cos(2.0 * x)) * std::polar(1.0, delta * x);
  }
  return std::abs(sum) / N;
}
Result<Figure> WindowHeight(const Registry&, const Value& parameters) {
  return Figure{WindowedEntry(parameters.NumberOr("offset", 0.0), 128), "1"};
}

/// 0.42 N eta over the largest entry of a real tone behind the window: what its spectrum has to be scaled by.
Result<Figure> RealTone(const Registry&, const Value&) {
  constexpr int N = 128, k = 20;
  Complex sum = 0.0;
  for (int n = 0; n < N; ++n) {
    const double x = 2.0 * pi * n / N;
    sum += (0.42 - 0.5 * std::cos(x) + 0.08 * std::cos(2.0 * x)) * std::cos(k * x + 0.4) * std::polar(1.0, -k * x);
  }
  return Figure{0.42 * N / std::abs(sum), "1"};
}

/// The smallest slope of b, (5.25), over offsets below half a bin.
Result<Figure> WindowSlope(const Registry&, const Value&) {
  const auto b = [](double d) {
    return (WindowedEntry(d - 1.0, 128) - WindowedEntry(d + 1.0, 128)) / WindowedEntry(d, 128);
  };
  constexpr double h = 1e-4;
  double least = std::numeric_limits<double>::infinity();
  for (int i = -500; i <= 500; ++i) least = std::min(least, (b(1e-3 * i + h) - b(1e-3 * i - h)) / (2.0 * h));
  return Figure{least, "1"};
}

/// The share of samples at which u y is negative, the product under the root of (5.7): filter (5.8) at 600 Hz on a tone
/// of 620.3 Hz, once it is steady: its samples repeat after 100 000 only.
Result<Figure> NegativeRoot(const Registry&, const Value&) {
  constexpr double r = 0.995, T_d = 1e-4, nu = 2.0 * pi * 620.3 * T_d;
  const double c = std::cos(2.0 * pi * 600.0 * T_d);
  double u[3] = {}, y[3] = {};
  constexpr int kSettled = 10'000, kCounted = 100'000;  // e^-50 of the start is left
  int negative = 0;
  for (int n = 0; n < kSettled + kCounted; ++n) {
    u[2] = u[1], u[1] = u[0], u[0] = std::sin(nu * n);
    y[2] = y[1], y[1] = y[0];
    y[0] = u[0] - 2.0 * c * u[1] + u[2] + 2.0 * r * c * y[1] - r * r * y[2];
    if (n >= kSettled && u[0] * y[0] < 0.0) ++negative;
  }
  return Figure{static_cast<double>(negative) / kCounted, "1"};
}

/// How many of the ends of 0 <= nu_0 <= pi give the gain K of (D.1) no value, r = 0.995.
Result<Figure> NotchGainUndefined(const Registry&, const Value&) {
  int undefined = 0;
  for (const double nu_0 : {0.0, pi}) {
    const double r = 0.995, K = (1.0 + r * r - 2.0 * r * std::cos(nu_0)) / (2.0 - 2.0 * std::cos(nu_0));
    undefined += std::isfinite(K) ? 0 : 1;
  }
  return Figure{static_cast<double>(undefined), "1"};
}

/// The angle at the gap over alpha at which A+ of (3.4) first counts as contact, on the way from the left side at a
/// constant 100 rad/s, when both lines of its brace have to hold, or either. Table C.2.
Result<Figure> FirstContact(const Registry&, const Value& parameters) {
  const bool either = parameters.TextOr("lines") == "either";
  constexpr double k = 15e3, c = 0.5, alpha = 0.09599310885968812, rate = 100.0;
  const double start = -alpha - c / k * rate;  // where the torque of the left contact vanishes
  for (double t = 0.0; t < 1.0; t += 1e-8) {
    const double phi_d = start + rate * t;
    // (3.6) without contact-free damping: phi_b follows phi_d with the time constant c/k.
    const double phi_b = phi_d + c / k * rate * std::exp(-k / c * t);
    const bool first = phi_b >= alpha, second = k * (phi_d - alpha) + c * rate >= 0.0;
    if (either ? first || second : first && second) return Figure{phi_b / alpha, "1"};
  }
  return Figure{0.0, "1"};
}

/// How many samples the sums of (5.14) take, k = 0 ... M.
Result<Figure> BandPassTerms(const Registry&, const Value& parameters) {
  int terms = 0;
  for (int k = 0; k <= static_cast<int>(parameters.NumberOr("M", 0.0)); ++k) ++terms;
  return Figure{static_cast<double>(terms), "1"};
}

/// p / (R theta) of air at 1 bar and 20 degrees.
Result<Figure> AirDensity(const Registry&, const Value& parameters) {
  return Figure{1e5 / (parameters.NumberOr("R", 0.0) * 293.15), "kg/m^3"};
}

/// How many numbers of a drive line lie outside the bounds of Tables A.2 and A.6; `I1` has bounds of its own.
Result<Figure> OutsideBounds(const Registry&, const Value& parameters) {
  Diagnostics diagnostics;
  const std::vector<std::string> files = FindScenarios(parameters.TextOr("scenario"), diagnostics);
  const std::optional<Plan> plan = files.size() == 1 ? LoadPlan(files[0], {}, diagnostics) : std::nullopt;
  const Value* plant = plan ? plan->root.Find("plant") : nullptr;
  if (plant == nullptr) return Failure{.message = diagnostics.Format(), .signal = "study", .exit_code = 2};
  int outside = 0, seen = 0;
  const auto look = [&](const Value& table, const std::string& name) {
    const bool first = name == "I1";
    const double least = first ? parameters.NumberOr("least", 0.01) : 0.01,
                 most = first ? parameters.NumberOr("most", 10.0) : 10.0;
    for (const auto& [key, low, high] : {std::tuple{"inertia_kg_m2", least, most},
                                         {"stiffness_Nm_per_rad", 0.1e6, 100e6},
                                         {"damping_Nms_per_rad", 0.0, 1000.0}}) {
      const Value* number = table.is_table()                           ? table.Find(key)
                            : std::string_view(key) == "inertia_kg_m2" ? &table
                                                                       : nullptr;
      if (number == nullptr || !number->is_number()) continue;
      ++seen;
      outside += number->number() < low || number->number() > high ? 1 : 0;
    }
  };
  for (const char* part : {"inertia", "rotor", "shaft"}) {
    const Value* table = plant->Find(part);
    if (table == nullptr || !table->is_table()) continue;
    for (const Value::Entry& entry : table->table()) look(entry.value, entry.key);
  }
  // The tables have nine numbers with a soft rotor, thirteen and more with a chain.
  if (seen < 9) return Failure{.message = "the plant has too few numbers", .signal = "study", .exit_code = 2};
  return Figure{static_cast<double>(outside), "1"};
}

}  // namespace

std::map<std::string, Study, std::less<>> FormulaStudies() {
  return {{"air_density", AirDensity},       {"band_pass_terms", BandPassTerms},
          {"first_contact", FirstContact},   {"free_end", FreeEnd},
          {"negative_root", NegativeRoot},   {"notch_gain_undefined", NotchGainUndefined},
          {"outside_bounds", OutsideBounds}, {"plain_interpolation", PlainInterpolation},
          {"rated_torque", RatedTorque},     {"real_tone", RealTone},
          {"window_height", WindowHeight},   {"window_slope", WindowSlope}};
}

}  // namespace dynoproof
