#include "reports/diagnosis_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "diagnosis/report.h"
#include "reports/html.h"

namespace dynoproof::reports {
namespace {

using diagnosis::Diagnosis;

std::string FourDigits(double value) { return fmt::format("{:.4g}", value); }
std::string Unit(const std::string& unit) { return unit == "1" ? "" : Escape(unit); }

std::string Spans(const std::vector<std::pair<double, double>>& spans, const char* unit, const char* none) {
  std::string text;
  for (const auto& [from, to] : spans) text += fmt::format("{}{:.4g} ... {:.4g}", text.empty() ? "" : ", ", from, to);
  return text.empty() ? none : text + " " + unit;
}

/// The cause in a few words: "inertia_change at inertia:I3", else the verdict.
std::string Spoken(const Diagnosis& d) {
  std::string text;
  for (const diagnosis::FoundEffect& effect : d.effects)
    text += fmt::format("{}{} at {}", text.empty() ? "" : " and ", effect.name, effect.at);
  const std::string verdict = ToString(d.verdict);
  if (d.verdict == diagnosis::Conclusion::kEffectFound && !text.empty()) return text;
  return text.empty() ? verdict : fmt::format("{}, {}", verdict, text);
}

std::string Confidence(const diagnosis::FoundEffect& effect) {
  return effect.confidence ? fmt::format("{:.1f} %", 100.0 * *effect.confidence) : "not calibrated";
}

using ByLevel = std::vector<std::pair<std::string, double>>;  // numbers by a level's name

/// The number at a level; nothing where there is none.
std::optional<double> At(const ByLevel& numbers, const std::string& level) {
  const auto found = std::ranges::find(numbers, level, &ByLevel::value_type::first);
  return found != numbers.end() ? std::optional(found->second) : std::nullopt;
}

/// Adds the levels of `by_level` that are not among `levels` yet.
void AddLevels(const ByLevel& by_level, std::vector<std::string>& levels) {
  for (const auto& [level, number] : by_level) {
    if (std::ranges::find(levels, level) == levels.end()) levels.push_back(level);
  }
}

std::string Causes(const Diagnosis& d) {
  if (d.effects.empty()) return "";
  std::string rows, laws;
  for (const diagnosis::FoundEffect& effect : d.effects) {
    laws += fmt::format("<p><code>{}</code> at {}: {}, {}.</p>\n", Escape(effect.name), Escape(effect.at),
                        Escape(effect.description), Escape(effect.law));
    // An effect without a number is a row as well.
    if (effect.parameters.empty())
      rows += Row(std::vector<Cell>{
          {Escape(effect.name), "key"}, {Escape(effect.at)}, {Confidence(effect), "number"}, {""}, {""}, {""}, {""}});
    for (const diagnosis::FoundParameter& parameter : effect.parameters) {
      rows +=
          Row(std::vector<Cell>{{Escape(effect.name), "key"},
                                {Escape(effect.at)},
                                {Confidence(effect), "number"},
                                {Escape(parameter.name)},
                                {parameter.Text(parameter.value), "number"},
                                {parameter.Text(parameter.lower) + " ... " + parameter.Text(parameter.upper), "number"},
                                {Unit(parameter.unit)}});
    }
  }
  const bool none = d.verdict == diagnosis::Conclusion::kUnexplained;
  return fmt::format("<h2>{}</h2>\n", none ? "What comes nearest" : "Cause") +
         Table(std::vector<Cell>{{"effect"},
                                 {"at"},
                                 {"confidence", "number"},
                                 {"parameter"},
                                 {"value", "number"},
                                 {"95 % interval", "number"},
                                 {"unit"}},
               rows) +
         laws;
}

/// The numbers of the causes as each level has them.
std::string OverLevels(const Diagnosis& d) {
  std::vector<std::string> levels;
  for (const diagnosis::FoundEffect& effect : d.effects) {
    for (const diagnosis::FoundParameter& parameter : effect.parameters) AddLevels(parameter.by_level, levels);
  }
  if (levels.size() < 2) return "";
  std::vector<Cell> head = {{"effect"}, {"parameter"}};
  for (const std::string& level : levels) head.push_back({level, "number"});
  head.push_back({"unit"});
  std::string rows;
  for (const diagnosis::FoundEffect& effect : d.effects) {
    for (const diagnosis::FoundParameter& parameter : effect.parameters) {
      std::vector<Cell> row = {{Escape(effect.name), "key"}, {Escape(parameter.name)}};
      for (const std::string& level : levels) {
        const std::optional<double> value = At(parameter.by_level, level);
        row.push_back({value ? FourDigits(*value) : "–", "number"});
      }
      row.push_back({Unit(parameter.unit)});
      rows += Row(row);
    }
  }
  return "<p>Fitted beside a run that the record corrects with a memory of so long, and in the free run: a cause has "
         "the same numbers at each.</p>\n" +
         Table(head, rows);
}

std::string Gains(const Diagnosis& d) {
  std::string rows;
  for (const auto& [what, gains] : {std::pair("training", &d.train), std::pair("hold-out", &d.holdout)}) {
    for (const auto& [signal, gain] : *gains) {
      const auto released = d.released.find(signal);
      rows += Row(std::vector<Cell>{
          {what},
          {Escape(signal), "key"},
          {FourDigits(gain.before), "number"},
          {what[0] == 'h' && released != d.released.end() ? FourDigits(released->second) : "–", "number"},
          {FourDigits(gain.after), "number"},
          {what[0] == 'h' ? fmt::format("{} ... {}", FourDigits(gain.lower), FourDigits(gain.upper)) : "–", "number"}});
    }
  }
  if (rows.empty()) return "";
  return "<h2>Gain</h2>\n" +
         Table(std::vector<Cell>{{"data"},
                                 {"signal"},
                                 {"NRMSE as given", "number"},
                                 {"nominal values let go", "number"},
                                 {"with the cause", "number"},
                                 {"gain, 95 % interval", "number"}},
               rows) +
         fmt::format("<p class=\"source\">{}</p>\n",
                     d.own_holdout ? "The hold-out records were opened once, after the choice."
                                   : "No hold-out record was given: the last 30 % of the data were kept for it.");
}

/// A bar: what a candidate removes at a level. A cause removes it at all of them, what only follows the error at one.
Cell ShareAt(const diagnosis::Considered& one, const std::string& level) {
  const std::optional<double> share = At(one.shares, level);
  if (!share) return {"–"};
  return {fmt::format("<meter value=\"{:.3f}\" min=\"0\" max=\"1\"></meter>&nbsp;{:.0f}&nbsp;%",
                      std::clamp(*share, 0.0, 1.0), std::round(100.0 * *share) + 0.0)};
}

std::string Considerations(const Diagnosis& d) {
  std::vector<std::string> levels;
  for (const diagnosis::Considered& one : d.considered) AddLevels(one.shares, levels);
  std::vector<Cell> head = {{"effect"}, {"at"}};
  for (const std::string& level : levels) head.push_back({level});
  head.push_back({"NRMSE on validation", "number"});
  head.push_back({"why not"});
  std::string rows;
  for (const diagnosis::Considered& one : d.considered) {
    const std::string name = one.on_top_of.empty() ? one.name : one.on_top_of + " + " + one.name;
    std::vector<Cell> row = {{Escape(name), "key"}, {Escape(one.at)}};
    for (const std::string& level : levels) row.push_back(ShareAt(one, level));
    row.push_back({FourDigits(one.validation_nrmse), "number"});
    row.push_back({one.why_not.empty() ? "<b>named</b>" : Escape(one.why_not), "wide"});
    rows += Row(row);
  }
  std::string seen;
  for (const diagnosis::Seen& one : d.would_have_seen) {
    seen += Row(std::vector<Cell>{
        {Escape(one.name), "key"}, {Escape(one.at)}, {FourDigits(one.smallest), "number"}, {Unit(one.unit)}});
  }
  std::string html;
  if (!rows.empty()) {
    html += "<h2>What was considered, and why not</h2>\n";
    if (!levels.empty())
      html +=
          "<p>Bars: the share that each removes of what the nominal model leaves beyond noise of the data that were "
          "fitted, beside a run that the record corrects with a memory of so long, and in the free run.</p>\n";
    html += Table(head, rows);
  }
  if (!seen.empty()) {
    html += "<h2>What would have been seen</h2>\n" +
            Table(std::vector<Cell>{{"effect"}, {"at"}, {"smallest", "number"}, {"unit"}}, seen);
  }
  return html;
}

/// Candidates of a screening are many: the first few tell what it found.
std::string Compared(const std::vector<std::string>& compared) {
  constexpr std::size_t kShown = 6;
  std::string text;
  for (std::size_t i = 0; i < compared.size() && i < kShown; ++i) text += (i > 0 ? ", " : "") + Escape(compared[i]);
  return compared.size() > kShown ? text + fmt::format(" and {} more", compared.size() - kShown) : text;
}

std::string Course(const diagnosis::Journal& journal) {
  std::string rows;
  for (const diagnosis::JournalEntry& entry : journal) {
    std::string numbers;
    for (const auto& [name, number] : entry.numbers)
      numbers += fmt::format("{}{} {:.4g}", numbers.empty() ? "" : ", ", Escape(name), number);
    rows += Row(std::vector<Cell>{{Escape(entry.stage), "key"},
                                  {Compared(entry.compared), "wide"},
                                  {Escape(entry.rule), "wide"},
                                  {numbers, "wide"},
                                  {Escape(entry.outcome), "wide"}});
  }
  if (rows.empty()) return "";
  return "<h2>How the verdict came about</h2>\n" +
         Table(std::vector<Cell>{{"stage"}, {"compared"}, {"rule"}, {"numbers"}, {"outcome"}}, rows);
}

}  // namespace

std::string DiagnosisPage(const std::string& scenario, const std::vector<std::string>& records, const Diagnosis& d,
                          const std::vector<Picture>& pictures) {
  std::string title = "diagnosis of ";
  for (std::size_t i = 0; i < records.size(); ++i) {
    title += (i > 0 ? ", " : "") + std::filesystem::path(records[i]).filename().string();
  }
  title += ": " + Spoken(d);
  const bool settled =
      d.verdict == diagnosis::Conclusion::kEffectFound || d.verdict == diagnosis::Conclusion::kNoEffect;
  const std::string lead = fmt::format("<span class=\"verdict {}\">{}</span> {}.", settled ? "pass" : "inconclusive",
                                       ToString(d.verdict), Escape(diagnosis::Sentence(d)));
  std::string body;
  std::string files;
  for (const std::string& record : records) files += (files.empty() ? "" : ", ") + record;
  body += fmt::format("<p class=\"source\">scenario {}, records {}; {:.0f} simulations</p>\n", Escape(scenario),
                      Escape(files), d.simulations);
  for (const std::string& note : d.notes) body += fmt::format("<p class=\"note\">{}</p>\n", Escape(note));
  if (diagnosis::TellsMoreThanItsSentence(d)) body += fmt::format("<p>{}.</p>\n", Escape(d.reason));
  body += Causes(d) + OverLevels(d);
  for (const auto& set : d.ambiguous_with) {
    std::string names;
    for (const std::string& name : set) names += (names.empty() ? "" : ", ") + name;
    body += fmt::format("<p>These data cannot tell apart: {}.</p>\n", Escape(names));
  }
  if (!d.experiment_text.empty()) body += fmt::format("<p>What would: {}</p>\n", Escape(d.experiment_text));
  if (!d.extended_scenario.empty())
    body += fmt::format("<p>Extended scenario: <code>{}</code></p>\n", Escape(d.extended_scenario));
  body += Gains(d);
  body += fmt::format(
      "<h2>Where it is wrong</h2>\n<p>Most in {}; at {}; at {}{}.</p>\n<p>What is left {} the noise floor "
      "(NRMSE {}).</p>\n",
      Escape(d.where.signal), Spans(d.where.when_s, "s", "no time in particular"),
      Spans(d.where.frequency_hz, "Hz", "no frequency in particular"),
      d.where.condition.empty() ? "" : "; " + Escape(d.where.condition), d.at_noise_floor ? "is at" : "is above",
      FourDigits(d.noise_floor));
  if (!pictures.empty()) body += Figures("data-diagnosis", pictures, 4'000'000);
  body += Considerations(d) + Course(d.journal);
  return Page(title, lead, BuildLine(), body);
}

}  // namespace dynoproof::reports
