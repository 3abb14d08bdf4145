#include "base/unit_symbols.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <numbers>
#include <string>
#include <utility>

namespace dynoproof {
namespace {

using Table = std::map<std::string, Unit, std::less<>>;

constexpr double kPi = std::numbers::pi;
constexpr double kGravity = 9.80665;                  // standard acceleration of free fall, m/s^2
constexpr double kPound = 0.45359237;                 // avoirdupois, kg
constexpr double kPoundForce = kPound * kGravity;     // N
constexpr double kOunceForce = kPoundForce / 16;      // N
constexpr double kInch = 0.0254, kFoot = 12 * kInch;  // m
constexpr double kPsi = kPoundForce / (kInch * kInch);

constexpr std::array<int, 6> kNone = {}, kLength = {0, 1}, kTime = {0, 0, 1}, kRate = {0, 0, -1}, kMass = {1},
                             kForce = {1, 1, -2}, kPressure = {1, -1, -2}, kEnergy = {1, 2, -2}, kPower = {1, 2, -3},
                             kKelvin = {0, 0, 0, 1}, kAmpere = {0, 0, 0, 0, 1}, kAngle = {0, 0, 0, 0, 0, 1},
                             kAngularRate = {0, 0, -1, 0, 0, 1}, kVolt = {1, 2, -3, 0, -1}, kVolume = {0, 3},
                             kSpeed = {0, 1, -1}, kAcceleration = {0, 1, -2};

/// Symbols that take the SI's prefixes.
const Table& Prefixable() {
  static const Table table = {
      {"g", {1e-3, 0, kMass}},
      {"m", {1, 0, kLength}},
      {"s", {1, 0, kTime}},
      {"K", {1, 0, kKelvin}},
      {"A", {1, 0, kAmpere}},
      {"rad", {1, 0, kAngle}},
      {"N", {1, 0, kForce}},
      {"Pa", {1, 0, kPressure}},
      {"J", {1, 0, kEnergy}},
      {"W", {1, 0, kPower}},
      {"V", {1, 0, kVolt}},
      {"Hz", {1, 0, kRate}},
      {"bar", {1e5, 0, kPressure}},
      {"Wb", {1, 0, {1, 2, -2, 0, -1}}},
      {"H", {1, 0, {1, 2, -2, 0, -2}}},
      {"Ohm", {1, 0, {1, 2, -3, 0, -2}}},
      {"l", {1e-3, 0, kVolume}},
      {"L", {1e-3, 0, kVolume}},
      {"sec", {1, 0, kTime}},
      // Products written without a sign between them.
      {"Nm", {1, 0, kEnergy}},
      {"Nms", {1, 0, {1, 2, -1}}},
      {"Ns", {1, 0, {1, 1, -1}}},
      {"Ws", {1, 0, kEnergy}},
      {"Wh", {3600, 0, kEnergy}},
      {"As", {1, 0, {0, 0, 1, 0, 1}}},
      {"Ah", {3600, 0, {0, 0, 1, 0, 1}}},
      {"VA", {1, 0, kPower}},
      {"Pas", {1, 0, {1, -1, -1}}},
  };
  return table;
}

/// Symbols without prefixes.
const Table& Plain() {
  static const Table table = {
      {"1", {}},
      {"-", {}},
      {"%", {0.01, 0, kNone}},
      {"deg", {kPi / 180, 0, kAngle}},
      {"gon", {kPi / 200, 0, kAngle}},
      {"rev", {2 * kPi, 0, kAngle}},
      {"rpm", {2 * kPi / 60, 0, kAngularRate}},
      {"krpm", {2000 * kPi / 60, 0, kAngularRate}},
      {"rps", {2 * kPi, 0, kAngularRate}},
      {"min", {60, 0, kTime}},
      {"h", {3600, 0, kTime}},
      {"hr", {3600, 0, kTime}},
      {"hrs", {3600, 0, kTime}},
      {"degC", {1, 273.15, kKelvin}},
      {"degF", {5.0 / 9, 459.67 * 5 / 9, kKelvin}},
      {"degK", {1, 0, kKelvin}},
      {"in", {kInch, 0, kLength}},
      {"ft", {kFoot, 0, kLength}},
      {"lb", {kPound, 0, kMass}},
      {"lbs", {kPound, 0, kMass}},
      {"lbm", {kPound, 0, kMass}},
      {"oz", {kPound / 16, 0, kMass}},
      {"lbf", {kPoundForce, 0, kForce}},
      {"klbf", {1e3 * kPoundForce, 0, kForce}},
      {"ozf", {kOunceForce, 0, kForce}},
      {"kgf", {kGravity, 0, kForce}},
      {"kp", {kGravity, 0, kForce}},
      {"kpm", {kGravity, 0, kEnergy}},
      {"kgfm", {kGravity, 0, kEnergy}},
      {"daN", {10, 0, kForce}},
      {"daNm", {10, 0, kEnergy}},
      {"Ncm", {1e-2, 0, kEnergy}},
      {"Nmm", {1e-3, 0, kEnergy}},
      {"kNcm", {10, 0, kEnergy}},
      {"kNmm", {1, 0, kEnergy}},
      {"g0", {kGravity, 0, kAcceleration}},
      {"gn", {kGravity, 0, kAcceleration}},
      {"psi", {kPsi, 0, kPressure}},
      {"psia", {kPsi, 0, kPressure}},
      {"ksi", {1e3 * kPsi, 0, kPressure}},
      {"bara", {1e5, 0, kPressure}},
      {"mmHg", {133.322387415, 0, kPressure}},
      {"atm", {101325, 0, kPressure}},
      {"hp", {550 * kFoot * kPoundForce, 0, kPower}},
      {"PS", {75 * kGravity, 0, kPower}},
      {"mph", {5280 * kFoot / 3600, 0, kSpeed}},
      {"kph", {1 / 3.6, 0, kSpeed}},
      {"kmh", {1 / 3.6, 0, kSpeed}},
  };
  return table;
}

/// Names written out, in lower case and singular, and abbreviations. Those marked take prefixes written out ("millivolt").
/// No "hertz": who asks whether a rate counts turns looks for "Hz" (engine/experiment/records.cc). No "pound" and no
/// "horsepower": there are several.
const std::map<std::string, std::pair<std::string, bool>, std::less<>>& Names() {
  static const std::map<std::string, std::pair<std::string, bool>, std::less<>> table = {
      {"second", {"s", true}},        {"meter", {"m", true}},          {"metre", {"m", true}},
      {"gram", {"g", true}},          {"gramme", {"g", true}},         {"newton", {"N", true}},
      {"volt", {"V", true}},          {"ampere", {"A", true}},         {"amp", {"A", true}},
      {"watt", {"W", true}},          {"joule", {"J", true}},          {"pascal", {"Pa", true}},
      {"kelvin", {"K", true}},        {"radian", {"rad", true}},       {"ohm", {"Ohm", true}},
      {"liter", {"l", true}},         {"litre", {"l", true}},          {"newtonmeter", {"Nm", true}},
      {"newtonmetre", {"Nm", true}},  {"sec", {"s", false}},           {"min", {"min", false}},
      {"minute", {"min", false}},     {"hour", {"h", false}},          {"deg", {"deg", false}},
      {"degree", {"deg", false}},     {"rad", {"rad", false}},         {"rev", {"rev", false}},
      {"revolution", {"rev", false}}, {"turn", {"rev", false}},        {"rpm", {"rpm", false}},
      {"percent", {"%", false}},      {"inch", {"in", false}},         {"inches", {"in", false}},
      {"foot", {"ft", false}},        {"feet", {"ft", false}},         {"celsius", {"degC", false}},
      {"degc", {"degC", false}},      {"fahrenheit", {"degF", false}}, {"degf", {"degF", false}},
      {"psi", {"psi", false}},        {"bar", {"bar", false}},         {"amps", {"A", false}},
      {"secs", {"s", false}},         {"mins", {"min", false}},        {"revs", {"rev", false}},
      {"lbf", {"lbf", false}},
  };
  return table;
}

std::optional<Unit> FromName(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  static const std::pair<std::string_view, double> prefixes[] = {{"", 1},         {"kilo", 1e3},   {"mega", 1e6},
                                                                 {"giga", 1e9},   {"hecto", 1e2},  {"centi", 1e-2},
                                                                 {"milli", 1e-3}, {"micro", 1e-6}, {"nano", 1e-9}};
  for (const auto& [prefix, factor] : prefixes) {
    if (!lower.starts_with(prefix)) continue;
    const std::string_view rest = std::string_view(lower).substr(prefix.size());
    auto found = Names().find(rest);
    if (found == Names().end() && rest.size() > 4 && rest.ends_with('s'))
      found = Names().find(rest.substr(0, rest.size() - 1));
    if (found == Names().end() || (!prefix.empty() && !found->second.second)) continue;
    Unit unit = *SymbolOfUnit(found->second.first);
    unit.factor *= factor;
    return unit;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Unit> SymbolOfUnit(std::string_view text) {
  if (const auto it = Plain().find(text); it != Plain().end()) return it->second;
  if (const auto it = Prefixable().find(text); it != Prefixable().end()) return it->second;
  static const std::map<char, double> prefixes = {{'G', 1e9},  {'M', 1e6},  {'k', 1e3},  {'h', 1e2},
                                                  {'c', 1e-2}, {'m', 1e-3}, {'u', 1e-6}, {'n', 1e-9}};
  if (text.size() >= 2) {
    const auto prefix = prefixes.find(text.front());
    const auto base = Prefixable().find(text.substr(1));
    if (prefix != prefixes.end() && base != Prefixable().end()) {
      Unit unit = base->second;
      unit.factor *= prefix->second;
      return unit;
    }
  }
  return FromName(text);
}

}  // namespace dynoproof
