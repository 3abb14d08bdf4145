#include "probe/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "base/within.h"

namespace dynoproof::probe {
namespace {

constexpr std::size_t kWeakest = 8;  // of what is seen, so many have a line

constexpr double kAlike = 1.2;  // two directions whose strengths are that close share a line

/// The findings of a list as lines; two directions of one effect share theirs where they pass equally far.
class Lines {
 public:
  void Add(const Finding& one, const std::string& by) {
    const bool pair = last_ != nullptr && last_->name == one.name && last_->place == one.place &&
                      last_->sign != one.sign && last_->state == one.state && last_->at_once == one.at_once &&
                      Within(std::max(last_->size, one.size), kAlike * std::min(last_->size, one.size));
    if (pair) {
      std::string& passes = rows_.back()[2];
      if (const auto at = passes.find_first_of("+-"); at != std::string::npos) passes.replace(at, 1, "±");
      last_ = nullptr;
      return;
    }
    rows_.push_back({one.name, one.place, PassesText(one), one.sized ? StrengthText(one.usual, one.unit) : "", by});
    last_ = &one;
  }
  bool empty() const { return rows_.empty(); }
  std::size_t size() const { return rows_.size(); }
  std::string Text() const {
    const std::vector<std::string> head = {"change", "place", "what passes", "usual", "seen by"};
    std::vector<std::size_t> widths;
    for (std::size_t i = 0; i < head.size(); ++i) {
      widths.push_back(head[i].size());
      for (const auto& row : rows_) widths[i] = std::max(widths[i], row[i].size());
    }
    std::string text;
    const auto add = [&](const std::vector<std::string>& row) {
      std::string line = " ";
      for (std::size_t i = 0; i < row.size(); ++i) line += fmt::format(" {:<{}} ", row[i], widths[i]);
      text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    };
    add(head);
    for (const auto& row : rows_) add(row);
    return text;
  }

 private:
  std::vector<std::vector<std::string>> rows_;
  const Finding* last_ = nullptr;
};

/// "series_elasticity at inertia:I1, rotor:R1 (2)"
std::string ByName(const std::vector<const Finding*>& findings) {
  std::vector<std::pair<std::string, std::vector<std::string>>> names;
  for (const Finding* one : findings) {
    auto found = std::ranges::find(names, one->name, [](const auto& entry) { return entry.first; });
    if (found == names.end()) found = names.insert(names.end(), {one->name, {}});
    if (std::ranges::count(found->second, one->place) == 0) found->second.push_back(one->place);
  }
  std::string text;
  for (const auto& [name, places] : names)
    text += fmt::format("{}{} at {}", text.empty() ? "" : "; ", name, fmt::join(places, ", "));
  return text;
}

}  // namespace

std::string StrengthText(double strength, const std::string& unit) {
  if (unit == "1") return fmt::format("{:.3g} %", 100.0 * strength);
  return fmt::format("{:.3g} {}", strength, unit);
}

std::string PassesText(const Finding& finding) {
  if (finding.state == State::kRefused) return "cannot be built";
  if (finding.state == State::kNoTrace) return "leaves no trace";
  if (!finding.sized) return finding.state == State::kUnseen ? "passes" : "is seen";
  if (finding.at_once && finding.sized)
    return fmt::format("none, {} is seen", StrengthText(std::abs(finding.strength), finding.unit));
  if (finding.falling) return "passes down to " + StrengthText(finding.strength, finding.unit);
  const std::string text =
      fmt::format("{}{}", finding.sign > 0 ? "+" : "", StrengthText(finding.strength, finding.unit));
  return finding.state == State::kUnseen ? "passes at any, up to " + text : "passes up to " + text;
}

std::string Sentence(const Probed& probed) {
  std::vector<const Finding*> holes;
  std::size_t tried = 0;
  for (const Finding& one : probed.findings) {
    if (one.state == State::kSeen || one.state == State::kUnseen) ++tried;
    if (one.IsHole()) holes.push_back(&one);
  }
  if (tried == 0) return "no change was tried that leaves a trace";
  if (holes.empty()) return fmt::format("all {} usual errors of the model would be seen", tried);
  std::string text = fmt::format("{} of {} usual errors of the model would pass: ", holes.size(), tried);
  // One of two directions speaks for both.
  std::vector<std::string> said;
  const Finding* last = nullptr;
  for (const Finding* hole : holes) {
    if (last == nullptr || last->name != hole->name || last->place != hole->place)
      said.push_back(fmt::format("{} at {}{}", hole->name, hole->place,
                                 hole->sized ? " " + PassesText(*hole).substr(7) : std::string()));
    last = hole;
  }
  constexpr std::size_t kSaid = 3;
  const std::size_t more = said.size() - std::min(kSaid, said.size());
  said.resize(said.size() - more);
  return text + fmt::format("{}{}", fmt::join(said, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

std::string ToTable(const Probed& probed) {
  std::vector<const Finding*> no_trace, refused;
  Lines holes, seen;
  for (const Finding& one : probed.findings) {
    if (one.IsHole()) {
      holes.Add(one, one.state == State::kSeen ? "then " + one.by : "");
    } else if (one.state == State::kNoTrace || one.state == State::kRefused) {
      (one.state == State::kNoTrace ? no_trace : refused).push_back(&one);
    } else if (one.sized && seen.size() < kWeakest) {
      seen.Add(one, one.by);
    }
  }
  std::string text = Sentence(probed) + "\n  asked: " + fmt::format("{}", fmt::join(probed.asked, ", ")) + "\n";
  if (!probed.skipped.empty()) text += fmt::format("  not asked: {}\n", fmt::join(probed.skipped, ", "));
  if (!holes.empty()) text += "\nwould pass although it is usual\n" + holes.Text();
  if (!seen.empty()) text += "\nseen before it is usual, the weakest of it\n" + seen.Text();
  if (!no_trace.empty()) text += "\nleaves no trace in any output at its usual strength: " + ByName(no_trace) + "\n";
  if (!refused.empty()) text += "\ncannot be built, so a reader sees it: " + ByName(refused) + "\n";
  return text + fmt::format("\n{} runs\n", probed.runs);
}

nlohmann::json ToJson(const Finding& one) {
  const auto number = [](double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); };
  const bool strong = one.sized && one.state == State::kSeen;
  nlohmann::json out = {{"effect", one.name},
                        {"at", one.place},
                        {"direction", !one.sized || one.falling ? ""
                                      : one.sign > 0            ? "+"
                                                                : "-"},
                        {"state", ToString(one.state)},
                        {"hole", one.IsHole()},
                        {"smallest", strong ? number(std::abs(one.strength)) : nlohmann::json()},
                        {"unit", one.unit},
                        {"seen_by", one.by},
                        {"usual", one.sized ? number(one.usual) : nlohmann::json()},
                        {"size", number(one.size)},
                        {"tried", one.sized ? number(std::abs(one.strength)) : nlohmann::json()},
                        {"is_limit", one.falling},
                        {"at_once", one.at_once},
                        {"moves", number(one.moves)},
                        {"runs", one.runs},
                        {"parameters", nlohmann::json::object()}};
  for (const auto& [name, value] : one.parameters) out["parameters"][name] = number(value);
  if (one.IsHole()) {
    for (const auto& [output, distance] : one.reach) out["reach"][output] = number(distance);
  }
  return out;
}

std::optional<Finding> FromJson(const nlohmann::json& document) {
  constexpr State kStates[] = {State::kSeen, State::kUnseen, State::kNoTrace, State::kRefused};
  try {
    Finding one;
    one.name = document.at("effect");
    one.place = document.at("at");
    one.unit = document.at("unit");
    one.sign = document.at("direction") == "-" ? -1 : 1;
    one.sized = !document.at("usual").is_null();
    one.falling = document.at("is_limit");
    one.at_once = document.at("at_once");
    const std::string state = document.at("state");
    const auto found = std::ranges::find_if(kStates, [&](State known) { return ToString(known) == state; });
    if (found == std::end(kStates)) return std::nullopt;
    one.state = *found;
    if (one.sized) {
      one.usual = document.at("usual");
      one.strength = one.sign * document.at("tried").get<double>();
    }
    one.size = document.at("size");
    one.by = document.at("seen_by");
    one.moves =
        document.at("moves").is_null() ? std::numeric_limits<double>::infinity() : document.at("moves").get<double>();
    one.runs = document.at("runs");
    for (const auto& [name, value] : document.at("parameters").items())
      one.parameters.emplace_back(name, value.get<double>());
    const nlohmann::json reach = document.value("reach", nlohmann::json::object());
    for (const auto& [output, distance] : reach.items()) {
      if (distance.is_number()) one.reach[output] = distance.get<double>();
    }
    return one;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

std::optional<Demand> ParseDemand(const std::string& text) {
  const std::size_t equals = text.find('=');
  Demand demand{text.substr(0, equals)};
  if (demand.name.empty()) return std::nullopt;
  if (equals == std::string::npos) return demand;
  std::string number = text.substr(equals + 1);
  const bool percent = number.ends_with('%');
  if (percent) number.pop_back();
  while (number.ends_with(' ')) number.pop_back();
  const auto [end, fault] = std::from_chars(number.data(), number.data() + number.size(), demand.strength);
  if (fault != std::errc() || end != number.data() + number.size() || !(demand.strength > 0.0) ||
      !std::isfinite(demand.strength))
    return std::nullopt;
  if (percent) demand.strength /= 100.0;
  return demand;
}

std::vector<const Finding*> Unmet(const Demand& demand, const std::vector<Finding>& findings) {
  std::vector<const Finding*> unmet;
  for (const Finding& one : findings) {
    if (one.name != demand.name || one.state == State::kRefused || one.state == State::kNoTrace) continue;
    const double asked = demand.strength > 0.0 ? demand.strength : one.usual;
    const bool strong_enough = one.falling ? Reaches(one.strength, asked) : Within(std::abs(one.strength), asked);
    const bool met = one.state == State::kSeen && (!one.sized || strong_enough);
    if (!met) unmet.push_back(&one);
  }
  return unmet;
}

}  // namespace dynoproof::probe
