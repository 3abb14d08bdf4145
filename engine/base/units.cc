#include "base/units.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace dynoproof {
namespace {

using Exponents = std::array<int, 6>;

/// Symbols that take SI prefixes (first) and symbols that do not (second).
const std::map<std::string, Unit, std::less<>>& Prefixable() {
  static const std::map<std::string, Unit, std::less<>> table = {
      {"g", {1e-3, 0, {1, 0, 0, 0, 0, 0}}},    {"m", {1, 0, {0, 1, 0, 0, 0, 0}}},
      {"s", {1, 0, {0, 0, 1, 0, 0, 0}}},       {"K", {1, 0, {0, 0, 0, 1, 0, 0}}},
      {"A", {1, 0, {0, 0, 0, 0, 1, 0}}},       {"rad", {1, 0, {0, 0, 0, 0, 0, 1}}},
      {"N", {1, 0, {1, 1, -2, 0, 0, 0}}},      {"Pa", {1, 0, {1, -1, -2, 0, 0, 0}}},
      {"J", {1, 0, {1, 2, -2, 0, 0, 0}}},      {"W", {1, 0, {1, 2, -3, 0, 0, 0}}},
      {"V", {1, 0, {1, 2, -3, 0, -1, 0}}},     {"Hz", {1, 0, {0, 0, -1, 0, 0, 0}}},
      {"bar", {1e5, 0, {1, -1, -2, 0, 0, 0}}}, {"Wb", {1, 0, {1, 2, -2, 0, -1, 0}}},
      {"H", {1, 0, {1, 2, -2, 0, -2, 0}}},     {"Ohm", {1, 0, {1, 2, -3, 0, -2, 0}}},
  };
  return table;
}

const std::map<std::string, Unit, std::less<>>& Plain() {
  constexpr double kDegree = std::numbers::pi / 180.0;
  static const std::map<std::string, Unit, std::less<>> table = {
      {"1", {}},
      {"-", {}},
      {"%", {0.01, 0, {}}},
      {"deg", {kDegree, 0, {0, 0, 0, 0, 0, 1}}},
      {"rev", {2 * std::numbers::pi, 0, {0, 0, 0, 0, 0, 1}}},
      {"rpm", {2 * std::numbers::pi / 60, 0, {0, 0, -1, 0, 0, 1}}},
      {"min", {60, 0, {0, 0, 1, 0, 0, 0}}},
      {"h", {3600, 0, {0, 0, 1, 0, 0, 0}}},
      {"degC", {1, 273.15, {0, 0, 0, 1, 0, 0}}},
      {"in", {0.0254, 0, {0, 1, 0, 0, 0, 0}}},
      {"lbf", {4.4482216152605, 0, {1, 1, -2, 0, 0, 0}}},
      {"l", {1e-3, 0, {0, 3, 0, 0, 0, 0}}},
      {"atm", {101325, 0, {1, -1, -2, 0, 0, 0}}},
  };
  return table;
}

std::optional<Unit> Symbol(std::string_view text) {
  if (text == "Nm") return Unit{1, 0, {1, 2, -2, 0, 0, 0}};
  if (text == "kNm") return Unit{1e3, 0, {1, 2, -2, 0, 0, 0}};
  if (text == "MNm") return Unit{1e6, 0, {1, 2, -2, 0, 0, 0}};
  if (const auto it = Plain().find(text); it != Plain().end()) return it->second;
  if (const auto it = Prefixable().find(text); it != Prefixable().end()) return it->second;
  static const std::map<char, double> prefixes = {{'G', 1e9},  {'M', 1e6},  {'k', 1e3},  {'h', 1e2},
                                                  {'c', 1e-2}, {'m', 1e-3}, {'u', 1e-6}, {'n', 1e-9}};
  if (text.size() < 2) return std::nullopt;
  const auto prefix = prefixes.find(text.front());
  const auto base = Prefixable().find(text.substr(1));
  if (prefix == prefixes.end() || base == Prefixable().end()) return std::nullopt;
  Unit unit = base->second;
  unit.factor *= prefix->second;
  return unit;
}

/// Splits "kg m^2" or "s2" into symbol and exponent; the exponent is 1 when none is written.
std::pair<std::string_view, int> SymbolAndPower(std::string_view text) {
  if (text == "1") return {text, 1};
  std::size_t end = text.size();
  while (end > 0 && (std::isdigit(static_cast<unsigned char>(text[end - 1])) != 0 || text[end - 1] == '-')) --end;
  int power = 1;
  const bool has_power = end < text.size() && end > 0;
  if (has_power) std::from_chars(text.data() + end, text.data() + text.size(), power);
  std::string_view symbol = has_power ? text.substr(0, end) : text;
  if (has_power && symbol.size() > 1 && symbol.back() == '^') symbol.remove_suffix(1);
  return {symbol, power};
}

}  // namespace

std::optional<Unit> ParseUnit(std::string_view text) {
  Unit result;
  int sign = 1;
  bool any = false;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const char c = text[begin];
    if (c == ' ' || c == '*' || c == '(' || c == ')') {
      ++begin;
      continue;
    }
    if (c == '/') {
      if (sign < 0 && any && text.find('(') == std::string_view::npos) return std::nullopt;  // a/b/c is ambiguous
      sign = -1;
      ++begin;
      continue;
    }
    const std::size_t end = std::min(text.find_first_of(" */()", begin), text.size());
    const auto [symbol, power] = SymbolAndPower(text.substr(begin, end - begin));
    const std::optional<Unit> unit = Symbol(symbol);
    if (!unit) return std::nullopt;
    if (unit->offset != 0.0 && (any || end < text.size() || power != 1)) return std::nullopt;  // degC stands alone
    result.factor *= std::pow(unit->factor, sign * power);
    result.offset += unit->offset;
    for (std::size_t i = 0; i < result.exponents.size(); ++i) result.exponents[i] += sign * power * unit->exponents[i];
    any = true;
    begin = end;
  }
  if (!any) return std::nullopt;
  return result;
}

bool SameQuantity(const Unit& a, const Unit& b) {
  for (std::size_t i = 0; i + 1 < a.exponents.size(); ++i) {  // the last one is rad
    if (a.exponents[i] != b.exponents[i]) return false;
  }
  return true;
}

std::string UnitOfSuffix(std::string_view name) {
  static const std::pair<std::string_view, std::string_view> table[] = {
      {"_Nm_per_rad3", "N m/rad^3"},
      {"_Nm_per_rad", "N m/rad"},
      {"_Nms2_per_rad2", "N m s^2/rad^2"},
      {"_Nms_per_rad", "N m s/rad"},
      {"_kg_m2", "kg m^2"},
      {"_J_per_kg_K", "J/(kg K)"},
      {"_J_per_kg", "J/kg"},
      {"_kg_per_s", "kg/s"},
      {"_Pas_per_kg", "Pa s/kg"},
      {"_Ns_per_m", "N s/m"},
      {"_rad_per_s", "rad/s"},
      {"_Nm_per_s", "N m/s"},
      {"_Hz_per_s", "Hz/s"},
      {"_Pa_per_rad", "Pa/rad"},
      {"_m2_per_s", "m^2/s"},
      {"_kg_per_m3", "kg/m^3"},
      {"_per_s", "1/s"},
      {"_Nm", "N m"},
      {"_Hz", "Hz"},
      {"_rad", "rad"},
      {"_s", "s"},
      {"_percent", "%"},
      {"_Pa", "Pa"},
      {"_N_per_m", "N/m"},
      {"_N", "N"},
      {"_kg", "kg"},
      {"_m3", "m^3"},
      {"_m2", "m^2"},
      {"_m", "m"},
      {"_K", "K"},
      {"_V", "V"},
  };
  for (const auto& [suffix, unit] : table) {
    if (name.size() > suffix.size() && name.ends_with(suffix)) return std::string(unit);
  }
  return "1";
}

}  // namespace dynoproof
