#include "reports/run_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiment/pictures.h"
#include "experiment/settings.h"
#include "reports/html.h"
#include "reports/run_report.h"

namespace dynoproof::reports {
namespace {

using score::Check;
using score::Verdict;

std::string Number(double value, const std::string& unit) {
  if (!std::isfinite(value)) return "–";
  return Escape(fmt::format("{:.4g}{}", value, unit == "1" || unit.empty() ? "" : " " + unit));
}

std::string LimitOf(const Check& check) {
  return (check.at_least ? "at least " : "") + Number(check.limit, check.unit);
}

/// The value of a check: a number in one line, or the sentence that a person reads, which may take several.
Cell ValueOf(const Check& check) {
  if (check.shown.empty()) return {Number(check.value, check.unit), "number"};
  return {Escape(check.shown), "wide"};
}

std::string Badge(Verdict verdict) {
  return fmt::format("<span class=\"verdict {0}\">{0}</span>", score::ToString(verdict));
}

std::string Overview(const std::vector<const ScenarioResult*>& results) {
  std::string rows;
  for (const ScenarioResult* result : results) {
    const Check* worst = WorstCheck(*result);
    const auto failed = std::count_if(result->checks.begin(), result->checks.end(),
                                      [](const Check& check) { return check.verdict != Verdict::kPass; });
    const std::string link = fmt::format("<a href=\"#{}\">{}</a>", Anchor(result->id), Escape(result->id));
    const std::string last = worst != nullptr ? Escape(worst->name) : Escape(result->broken);
    rows += Row(std::vector<Cell>{{link},
                                  {Badge(result->verdict)},
                                  {fmt::format("{}", result->checks.size()), "number"},
                                  {fmt::format("{}", failed), "number"},
                                  {last, "wide"},
                                  worst != nullptr ? ValueOf(*worst) : Cell{""},
                                  {worst != nullptr ? LimitOf(*worst) : "", "number"}});
  }
  return Table(std::vector<Cell>{{"scenario"},
                                 {"verdict"},
                                 {"checks", "number"},
                                 {"failed", "number"},
                                 {"worst check"},
                                 {"value", "number"},
                                 {"limit", "number"}},
               rows);
}

std::string ScoreCard(const ScenarioResult& result) {
  if (result.checks.empty()) return "<p>No check was made.</p>\n";
  std::vector<const Check*> checks;
  for (const Check& check : result.checks) checks.push_back(&check);
  std::stable_sort(checks.begin(), checks.end(), [](const Check* a, const Check* b) {
    return a->verdict != b->verdict && score::Worse(a->verdict, b->verdict) == a->verdict;
  });
  std::string rows, last;  // one reason often serves many checks in a row
  for (const Check* check : checks) {
    const std::string origin = check->origin == last ? "as above" : check->origin;
    last = check->origin;
    rows += Row(std::vector<Cell>{{Escape(check->name)},
                                  {Escape(check->kind)},
                                  {Badge(check->verdict)},
                                  ValueOf(*check),
                                  {LimitOf(*check), "number"},
                                  {Escape(origin), "wide"},
                                  {Escape(check->explanation), "wide"}});
  }
  return Table(std::vector<Cell>{{"check"},
                                 {"kind"},
                                 {"verdict"},
                                 {"value", "number"},
                                 {"limit", "number"},
                                 {"why this limit"},
                                 {"what was seen"}},
               rows);
}

std::string FiguresOf(const ScenarioResult& result) {
  std::string rows;
  for (const auto& [name, figure] : result.figures) {
    rows += Row(std::vector<Cell>{{Escape(name), "key"}, {Number(figure.value, figure.unit), "number"}});
  }
  return Table(std::vector<Cell>{{"figure"}, {"value", "number"}}, rows);
}

std::string SettingsTable(const std::vector<Setting>& settings) {
  std::string rows;
  for (const Setting& setting : settings) {
    const std::string unit = setting.unit == "1" || setting.unit.empty() ? "" : "[" + setting.unit + "] ";
    rows += Row(std::vector<Cell>{{Escape(setting.path), "key"},
                                  {Escape(setting.value), "key"},
                                  {Escape(setting.from)},
                                  {Escape(unit + setting.description)}});
  }
  return Table(std::vector<Cell>{{"setting"}, {"used"}, {"given in"}, {"meaning of a default"}}, rows);
}

std::string More(const std::string& summary, const std::string& html) {
  return fmt::format("<details class=\"more\"><summary>{}</summary>\n{}</details>\n", summary, html);
}

}  // namespace

RunPage::RunPage(std::size_t scenarios) : scenarios_(std::max<std::size_t>(1, scenarios)) {}

void RunPage::Add(const Prepared& prepared, const Course& course, const ScenarioResult& result) {
  Part part;
  if (const Value* source = prepared.plan.root.Find("source"); source != nullptr && source->is_string()) {
    part.source = source->string();
  }
  const RunPictures run = PicturesOf(prepared, course, result.checks);
  // 20 million samples cost 55 MB. What did not pass is looked at closely and kept in full, until that is too much,
  // too.
  bool in_full = result.verdict != Verdict::kPass;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    in_full = in_full && bytes_ < 60'000'000;
  }
  const std::size_t share = std::min<std::size_t>(in_full ? 4'000'000 : 20'000'000 / scenarios_, 4'000'000);
  part.pictures = Figures("data-" + Anchor(result.id), run.pictures, share);
  if (!run.constant.empty()) {
    std::string list;
    for (const std::string& one : run.constant) list += (list.empty() ? "" : ", ") + one;
    part.pictures += fmt::format("<p class=\"note\">Constant throughout: {}</p>\n", Escape(list));
  }
  part.settings = SettingsTable(SettingsOf(prepared.plan, *prepared.registry));
  std::string rows;
  for (const auto& [name, text] : course.trace.provenance.texts)
    rows += Row(std::vector<Cell>{{Escape(name), "key"}, {Escape(text)}});
  for (const auto& [name, count] : course.trace.provenance.counters) {
    rows += Row(std::vector<Cell>{{Escape(name), "key"}, {fmt::format("{}", count)}});
  }
  part.counters = Table(std::vector<Cell>{{"what"}, {"value"}}, rows);
  const std::lock_guard<std::mutex> lock(mutex_);
  bytes_ += part.pictures.size();
  parts_[result.id] = std::move(part);
}

std::string RunPage::Finish(const std::vector<ScenarioResult>& results) const {
  const std::vector<const ScenarioResult*> sorted = WorstFirst(results);
  std::map<std::string, int> counts;
  std::size_t checks = 0;
  for (const ScenarioResult& result : results) {
    ++counts[std::string(score::ToString(result.verdict))];
    checks += result.checks.size();
  }
  std::string sums;
  for (const auto& [verdict, count] : counts) sums += fmt::format(", {} {}", count, verdict);
  std::string body = fmt::format("<section id=\"overview\"><h2>{} scenario{}, {} checks{}</h2>\n", results.size(),
                                 results.size() == 1 ? "" : "s", checks, sums) +
                     Overview(sorted) + "</section>\n";
  std::size_t open = 0;  // a few parts are shown at once, the worst first
  for (const ScenarioResult* result : sorted) {
    const auto found = parts_.find(result->id);
    const bool bad = result->verdict != Verdict::kPass;
    body += fmt::format("<details class=\"part\" id=\"{}\"{}><summary><h2>{}</h2> {} {}</summary>\n",
                        Anchor(result->id), (bad || results.size() <= 3) && open++ < 5 ? " open" : "",
                        Escape(result->id), Badge(result->verdict), Escape(result->title));
    if (found != parts_.end() && !found->second.source.empty())
      body += fmt::format("<p class=\"source\">{}</p>\n", Escape(found->second.source));
    if (!result->broken.empty())
      body += fmt::format("<p class=\"broken\">The run broke: {}</p>\n", Escape(result->broken));
    for (const std::string& note : result->notes) body += fmt::format("<p class=\"note\">{}</p>\n", Escape(note));
    if (bad) body += "<h3>Score card</h3>\n" + ScoreCard(*result);
    if (found != parts_.end()) body += "<h3>Pictures</h3>\n" + found->second.pictures;
    if (!bad) body += "<h3>Score card</h3>\n" + ScoreCard(*result);
    if (!result->figures.empty()) body += More("Figures", FiguresOf(*result));
    if (found != parts_.end()) {
      body += More("Settings: given, and what was taken where nothing was given", found->second.settings);
      body += More("Solver and provenance", found->second.counters);
    }
    body += "</details>\n";
  }
  const trace::Provenance build = BuildProvenance();
  return Page("dynoproof run",
              fmt::format("dynoproof {}, {}, {}", build.Text("version").value_or(""), build.Text("commit").value_or(""),
                          build.Text("compiler").value_or("")),
              body);
}

}  // namespace dynoproof::reports
