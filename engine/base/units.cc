#include "base/units.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "base/unit_symbols.h"

namespace dynoproof {
namespace {

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool IsLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// One plain spelling for what people type: signs outside ASCII, "N.m", "N-m", "ft-lb", "m**2", "U/min".
std::string InPlainSigns(std::string_view text) {
  static const std::pair<std::string_view, std::string_view> table[] = {
      {"\u00B7", "*"},   {"\u22C5", "*"},   {"\u2219", "*"},   {"\u00D7", "*"},    {"\u00B5", "u"},
      {"\u03BC", "u"},   {"\u00B0", "deg"}, {"\u00BA", "deg"}, {"\u2103", "degC"}, {"\u2109", "degF"},
      {"\u03A9", "Ohm"}, {"\u2126", "Ohm"}, {"\u2070", "0"},   {"\u00B9", "1"},    {"\u00B2", "2"},
      {"\u00B3", "3"},   {"\u2074", "4"},   {"\u2075", "5"},   {"\u2076", "6"},    {"\u207B", "-"},
      {"\u2212", "-"},   {"\u00A0", " "},   {"**", "^"},       {" per ", "/"},
  };
  std::string plain;
  while (!text.empty()) {
    const auto* const sign = std::find_if(std::begin(table), std::end(table),
                                          [&](const auto& entry) { return text.starts_with(entry.first); });
    plain += sign != std::end(table) ? sign->second : text.substr(0, 1);
    text.remove_prefix(sign != std::end(table) ? sign->first.size() : 1);
  }
  // A point or a dash between two letters joins factors; "min-1" has a power there.
  for (std::size_t i = 1; i + 1 < plain.size(); ++i) {
    const bool before = IsLetter(plain[i - 1]) || IsDigit(plain[i - 1]);
    if ((plain[i] == '.' || plain[i] == '-') && before && IsLetter(plain[i + 1])) plain[i] = '*';
  }
  for (const std::string_view turns : {"U/", "r/", "tr/"}) {
    if (plain.starts_with(turns)) plain.replace(0, turns.size(), "rev/");
  }
  for (const std::string_view spaced : {"deg C", "deg F"}) {
    if (plain == spaced) plain.erase(3, 1);
  }
  return plain;
}

/// Reads factors, products, quotients and brackets from the left. "a/b/c" and "a/b c" have two readings each: they are
/// refused.
class Parser {
 public:
  explicit Parser(std::string_view text) : rest_(text) {}

  std::optional<Unit> Read() {
    const std::optional<Unit> unit = Product();
    return rest_.empty() ? unit : std::nullopt;
  }

 private:
  void SkipBlanks() {
    while (rest_.starts_with(' ')) rest_.remove_prefix(1);
  }

  bool Take(char c) {
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  /// Factors up to the end or a closing bracket.
  std::optional<Unit> Product() {
    Unit result;
    int factors = 0;
    bool divided = false;
    SkipBlanks();
    for (; !rest_.empty() && rest_.front() != ')'; ++factors, SkipBlanks()) {
      if (divided) return std::nullopt;
      const bool by = Take('/');
      if (!by && Take('*') && factors == 0) return std::nullopt;
      divided = by;
      SkipBlanks();
      const std::optional<Unit> unit = Factor();
      // A temperature with an offset stands alone.
      if (!unit || (unit->offset != 0.0 && (factors > 0 || by))) return std::nullopt;
      if (factors > 0 && result.offset != 0.0) return std::nullopt;
      Multiply(result, *unit, by ? -1 : 1);
    }
    if (factors == 0) return std::nullopt;
    return result;
  }

  std::optional<Unit> Factor() {
    if (!Take('(')) return SymbolWithPower();
    const std::optional<Unit> inner = Product();
    if (!inner || !Take(')')) return std::nullopt;
    return Raised(*inner, Power());
  }

  std::optional<Unit> SymbolWithPower() {
    const std::string_view token = rest_.substr(0, rest_.find_first_of(" */()"));
    if (const std::optional<Unit> whole = SymbolOfUnit(token)) {
      rest_.remove_prefix(token.size());
      return whole;
    }
    std::size_t end = 0;
    while (end < token.size() && !IsDigit(token[end]) && token[end] != '-' && token[end] != '^') ++end;
    const std::optional<Unit> unit = SymbolOfUnit(token.substr(0, end));
    if (!unit) return std::nullopt;
    rest_.remove_prefix(end);
    return Raised(*unit, Power());
  }

  /// "^-1", "2", "-1" or nothing, which is 1; no value where something else follows.
  std::optional<int> Power() {
    const bool marked = Take('^');
    if (!marked && (rest_.empty() || (!IsDigit(rest_.front()) && rest_.front() != '-'))) return 1;
    if (rest_.starts_with("+")) rest_.remove_prefix(1);
    int power = 0;
    const auto [stop, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), power);
    if (error != std::errc() || std::abs(power) > 9) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(stop - rest_.data()));
    if (!rest_.empty() && std::string_view(" */()").find(rest_.front()) == std::string_view::npos) return std::nullopt;
    return power;
  }

  static std::optional<Unit> Raised(const Unit& unit, std::optional<int> power) {
    if (!power || (unit.offset != 0.0 && *power != 1)) return std::nullopt;
    if (*power == 1) return unit;
    Unit result;
    Multiply(result, unit, *power);
    return result;
  }

  static void Multiply(Unit& result, const Unit& unit, int power) {
    result.factor *= std::pow(unit.factor, power);
    result.offset += unit.offset;
    for (std::size_t i = 0; i < result.exponents.size(); ++i) result.exponents[i] += power * unit.exponents[i];
  }

  std::string_view rest_;
};

/// "ft-lb" and "lb in" are torques: their lb, a mass elsewhere, is a force. The same for oz.
std::optional<Unit> TorqueOfPounds(std::string_view plain) {
  std::string letters;
  for (const char c : plain) {
    if (IsLetter(c)) letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (!IsLetter(c) && c != '*' && c != ' ') return std::nullopt;
  }
  for (const std::string_view arm : {"ft", "in"}) {
    for (const std::string_view weight : {"lb", "lbs", "lbf", "oz", "ozf"}) {
      if (letters != std::string(arm).append(weight) && letters != std::string(weight).append(arm)) continue;
      Unit torque = *SymbolOfUnit(weight.starts_with("lb") ? "lbf" : "ozf");
      const Unit length = *SymbolOfUnit(arm);
      torque.factor *= length.factor;
      ++torque.exponents[1];
      return torque;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Unit> ParseUnit(std::string_view text) {
  const std::string plain = InPlainSigns(text);
  if (const std::optional<Unit> torque = TorqueOfPounds(plain)) return torque;
  return Parser(plain).Read();
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
      {"_N_per_m3", "N/m^3"},
      {"_Nm_per_rad", "N m/rad"},
      {"_Nms2_per_rad2", "N m s^2/rad^2"},
      {"_Ns2_per_m2", "N s^2/m^2"},
      {"_Nms_per_rad", "N m s/rad"},
      {"_kg_m2", "kg m^2"},
      {"_J_per_kg_K", "J/(kg K)"},
      {"_J_per_kg", "J/kg"},
      {"_kg_per_s", "kg/s"},
      {"_Pas_per_kg", "Pa s/kg"},
      {"_Ns_per_m", "N s/m"},
      {"_rad_per_s", "rad/s"},
      {"_m_per_s", "m/s"},
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
