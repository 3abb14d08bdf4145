#include "diagnosis/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dynoproof::diagnosis {
namespace {

using nlohmann::json;

json Spans(const std::vector<std::pair<double, double>>& spans) {
  json out = json::array();
  for (const auto& [begin, end] : spans) out.push_back({begin, end});
  return out;
}

std::string Joined(const std::vector<std::pair<double, double>>& spans, const char* unit) {
  std::string text;
  for (std::size_t i = 0; i < spans.size() && i < 6; ++i)
    text += fmt::format("{}{:.4g} ... {:.4g}", i == 0 ? "" : ", ", spans[i].first, spans[i].second);
  if (spans.size() > 6) text += fmt::format(", and {} more", spans.size() - 6);
  return text.empty() ? text : text + " " + unit;
}

/// null where nothing was computed.
template <class T>
json OrNull(const std::optional<T>& value) {
  return value ? json(*value) : json();
}

/// "dry friction, at inertia:carriage with T_c 20.6 N m; and ...".
std::string InWords(const std::vector<FoundEffect>& effects) {
  std::string text;
  for (const FoundEffect& effect : effects) {
    text += fmt::format("{}{}, at {}", text.empty() ? "" : "; and ", effect.description, effect.at);
    for (const FoundParameter& p : effect.parameters) {
      text += fmt::format("{} {} {}{}", &p == &effect.parameters.front() ? " with" : ",", p.name, p.Text(p.value),
                          p.unit == "1" ? "" : " " + p.unit);
    }
  }
  return text;
}

std::string WrongIn(const WhereWrong& where) {
  std::string text = "\n  wrong in " + where.signal;
  if (!where.when_s.empty()) text += ", " + Joined(where.when_s, "s");
  if (!where.frequency_hz.empty()) text += ", " + Joined(where.frequency_hz, "Hz");
  if (!where.condition.empty()) text += "; " + where.condition;
  return text + "\n";
}

}  // namespace

std::string FoundParameter::Text(double number) const {
  const double wide = upper - lower, large = std::max(std::abs(lower), std::abs(upper));
  const double told = wide > 0.0 && std::isfinite(wide) ? std::ceil(std::log10(large / wide)) : 0.0;
  return fmt::format("{:.{}g}", number, static_cast<int>(std::clamp(told + 2.0, 4.0, 15.0)));
}

json ToJson(const std::map<std::string, SignalGain>& gains, bool interval) {
  json out = json::object();
  for (const auto& [name, gain] : gains) {
    out[name] = {{"nrmse_before", gain.before}, {"nrmse_after", gain.after}};
    if (interval) out[name]["gain_ci95"] = {gain.lower, gain.upper};
  }
  return out;
}

json ToJson(const WhereWrong& where) {
  return {{"signal", where.signal},
          {"when_s", Spans(where.when_s)},
          {"frequency_hz", Spans(where.frequency_hz)},
          {"condition", where.condition}};
}

json ToJson(const Diagnosis& d) {
  json out = {{"verdict", ToString(d.verdict)},
              {"reason", d.reason},
              {"effects", json::array()},
              {"ambiguous_with", d.ambiguous_with},
              {"separating_experiment", {{"text", d.experiment_text}, {"scenario", d.experiment_scenario}}},
              {"where_it_is_wrong", ToJson(d.where)},
              {"residual",
               {{"noise_floor", d.noise_floor},
                {"at_noise_floor", d.at_noise_floor},
                {"white", OrNull(d.tests.white())},
                {"ljung_box_p_value", OrNull(d.tests.ljung_box_p_value)},
                {"independent_of_inputs", OrNull(d.tests.independent_of_inputs())},
                {"regression_f_p_value", OrNull(d.tests.regression_p_value)},
                {"line_fisher_g_p_value", OrNull(d.tests.line_p_value)},
                {"floor_by_signal", d.floor_by_signal},
                {"rms_by_signal", d.residual_by_signal}}},
              {"gain", {{"train", ToJson(d.train, false)}, {"holdout", ToJson(d.holdout, true)}}},
              {"explained", json()},
              {"given", d.given},
              {"released", d.released.empty() ? json() : json(d.released)},
              {"with_cause", d.with_cause},
              {"left", json::object()},
              {"lines", json::array()},
              {"horizon_s", OrNull(d.horizon_s)},
              {"unknown_forces", OrNull(d.unknown_forces)},
              {"not_testable", json::array()},
              {"extended_scenario", d.extended_scenario},
              {"would_have_seen", json::array()},
              {"considered", json::array()},
              {"refitted", json::array()},
              {"holdout_records", d.own_holdout},
              {"notes", d.notes},
              {"simulations", static_cast<std::int64_t>(std::ceil(d.simulations))},
              {"search_complete", d.search_complete}};
  for (const FoundEffect& effect : d.effects) {
    json parameters = json::object();
    for (const FoundParameter& p : effect.parameters)
      parameters[p.name] = {{"value", p.value}, {"unit", p.unit}, {"ci95", {p.lower, p.upper}}};
    out["effects"].push_back({{"name", effect.name},
                              {"at", effect.at},
                              {"law", effect.law},
                              {"confidence", OrNull(effect.confidence)},
                              {"parameters", parameters}});
  }
  if (d.explained)
    out["explained"] = {{"share", d.explained->value}, {"ci95", {d.explained->lower, d.explained->upper}}};
  for (const auto& [name, left] : d.left) {
    out["left"][name] = ToJson(left.where);
    out["left"][name]["nrmse"] = left.nrmse;
    out["left"][name].erase("signal");
  }
  for (const LineLeft& line : d.lines)
    out["lines"].push_back({{"signal", line.signal}, {"frequency_hz", line.hz}, {"share", line.share}});
  for (const NotTestable& one : d.not_testable)
    out["not_testable"].push_back({{"name", one.name}, {"at", one.at}, {"reason", one.reason}});
  for (const Seen& seen : d.would_have_seen)
    out["would_have_seen"].push_back(
        {{"name", seen.name}, {"at", seen.at}, {"smallest", seen.smallest}, {"unit", seen.unit}});
  for (const Considered& one : d.considered)
    out["considered"].push_back({{"name", one.name},
                                 {"at", one.at},
                                 {"on_top_of", one.on_top_of},
                                 {"validation_nrmse", one.validation_nrmse},
                                 {"why_not", one.why_not}});
  for (const Refitted& one : d.refitted)
    out["refitted"].push_back({{"key", one.path},
                               {"nominal", one.nominal},
                               {"value", one.value},
                               {"deviation", one.deviation},
                               {"start", one.start}});
  return out;
}

std::string Sentence(const Diagnosis& d) {
  if (d.effects.empty()) return d.reason;
  if (d.verdict == Conclusion::kUnexplained) return "no cause is named. Nearest comes: " + InWords(d.effects);
  if (d.verdict == Conclusion::kNoEffect) return d.reason;
  std::string text = InWords(d.effects);
  if (d.verdict == Conclusion::kAmbiguous) {
    for (const std::vector<FoundEffect>& other : d.instead) text += "; or: " + InWords(other);
    return "one of these, which the data do not tell apart: " + text;
  }
  if (d.explained) {
    text += fmt::format(". {} {:.3g} % of what the model gets wrong on data that took no part; what is left is ",
                        d.effects.size() > 1 ? "They explain" : "It explains", 100.0 * d.explained->value);
  } else {
    text += ". What is left is ";
  }
  if (d.verdict == Conclusion::kEffectFound) return text + "noise";
  text += "more than noise";
  for (const auto& [signal, left] : d.left) {
    if (!left.where.condition.empty()) return text + fmt::format(", in {} {}", signal, left.where.condition);
  }
  return text;
}

bool TellsMoreThanItsSentence(const Diagnosis& d) {
  return d.verdict != Conclusion::kMainCause && d.verdict != Conclusion::kNoEffect && !d.effects.empty();
}

std::string ToTable(const Diagnosis& d) {
  std::string text = fmt::format("{}: {}\n", ToString(d.verdict), Sentence(d));
  if (TellsMoreThanItsSentence(d)) text += fmt::format("  {}\n", d.reason);
  for (const FoundEffect& effect : d.effects) {
    text += fmt::format("\n  {} at {}: {}{}\n", effect.name, effect.at, effect.law,
                        effect.confidence ? fmt::format("  (confidence {:.3f})", *effect.confidence) : "");
    for (const FoundParameter& p : effect.parameters)
      text += fmt::format("    {:<14}{:>14} {:<14} 95 %: {} ... {}\n", p.name, p.Text(p.value), p.unit, p.Text(p.lower),
                          p.Text(p.upper));
  }
  for (const auto& set : d.ambiguous_with)
    text += fmt::format("\n  cannot be told apart: {}\n  to tell them: {}\n  {}\n", fmt::join(set, ", "),
                        d.experiment_text, d.experiment_scenario);
  if (d.verdict != Conclusion::kNoEffect) text += WrongIn(d.where);
  text += fmt::format("\n  {:<12}{:>12}{:>12}{:>12}{:>12}{:>24}\n", "NRMSE", "train", "after", "hold-out", "after",
                      "gain, 95 %");
  for (const auto& [name, train] : d.train) {
    const auto found = d.holdout.find(name);
    const SignalGain holdout = found != d.holdout.end() ? found->second : SignalGain{};
    text += fmt::format("  {:<12}{:>12.4g}{:>12.4g}{:>12.4g}{:>12.4g}{:>12.4g} ... {:.4g}\n", name, train.before,
                        train.after, holdout.before, holdout.after, holdout.lower, holdout.upper);
  }
  text += fmt::format("  noise floor {:.4g}, {}\n", d.noise_floor,
                      d.at_noise_floor ? "reached" : "not reached: structure is left");
  if (d.unknown_forces && *d.unknown_forces > 0.0)
    text +=
        fmt::format("  forces that the model does not know: {:.2g} % of what drives it\n", 100.0 * *d.unknown_forces);
  std::vector<Refitted> moved;
  for (const Refitted& one : d.refitted) {
    if (std::abs(one.deviation) > 1.0 && !one.start) moved.push_back(one);
  }
  if (!moved.empty())
    text += "\n  nominal values that were fitted along and moved by more than their prior standard deviation:\n";
  for (const Refitted& one : moved)
    text += fmt::format("    {} = {:.6g} (nominal {:.6g})\n", one.path, one.value, one.nominal);
  if (!d.considered.empty()) text += "\n  considered\n";
  for (const Considered& one : d.considered)
    text += fmt::format("    {:<21} {:<21} validation {:.4g}  {}{}\n", one.name, one.at, one.validation_nrmse,
                        one.on_top_of.empty() ? "" : "on top of " + one.on_top_of + ": ",
                        one.why_not.empty() ? "the best" : one.why_not);
  if (!d.would_have_seen.empty()) text += "\n  smallest strength that would have been seen\n";
  for (const Seen& seen : d.would_have_seen)
    text += fmt::format("    {:<21} {:<21} {:.3g} {}\n", seen.name, seen.at, seen.smallest, seen.unit);
  if (!d.extended_scenario.empty()) text += fmt::format("\n  extended scenario: {}\n", d.extended_scenario);
  return text;
}

}  // namespace dynoproof::diagnosis
