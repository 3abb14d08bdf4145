#include "reports/run_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "experiment/pictures.h"
#include "experiment/settings.h"
#include "reports/html.h"
#include "reports/run_report.h"
#include "reports/score_card.h"

namespace dynoproof::reports {
namespace {

using score::Check;
using score::Verdict;

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
                                  worst != nullptr ? ValueCell(*worst) : Cell{""},
                                  {worst != nullptr ? LimitText(*worst) : "", "number"}});
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

/// What is shown of the overview and of the parts below: by a text, and by verdict.
std::string Filter(const std::map<std::string, int>& counts) {
  std::string options = "<option value=\"\">all</option>";
  for (const auto& [verdict, count] : counts)
    options += fmt::format("<option value=\"{0}\">{0} ({1})</option>", verdict, count);
  return fmt::format(
      "<p id=\"filter\"><label>find <input type=\"search\"></label> <label>verdict <select>{}</select></label></p>\n",
      options);
}

std::size_t NotPassed(const std::vector<const ScenarioResult*>& results) {
  return static_cast<std::size_t>(std::count_if(
      results.begin(), results.end(), [](const ScenarioResult* one) { return one->verdict != Verdict::kPass; }));
}

std::string TitleOf(const std::vector<const ScenarioResult*>& sorted) {
  if (sorted.size() == 1) {
    const Check* const worst = WorstCheck(*sorted.front());
    const std::string text = fmt::format("{}: {}", sorted.front()->id, score::ToString(sorted.front()->verdict));
    return worst == nullptr || worst->cause.empty() ? text : text + ", " + worst->cause;
  }
  const std::size_t bad = NotPassed(sorted);
  if (bad == 0) return fmt::format("{} scenarios: all pass", sorted.size());
  return fmt::format("{} of {} scenarios do not pass", bad, sorted.size());
}

/// The verdict with its reason; of many scenarios that of the worst.
std::string LeadOf(const std::vector<const ScenarioResult*>& sorted) {
  if (sorted.empty()) return "No scenario was run.";
  const ScenarioResult& worst = *sorted.front();
  std::string text = Badge(worst.verdict) + " ";
  if (sorted.size() > 1) text += fmt::format("<a href=\"#{}\">{}</a>: ", Anchor(worst.id), Escape(worst.id));
  const Check* const check = WorstCheck(worst);
  if (!worst.broken.empty() || check == nullptr) {
    return text + (worst.broken.empty() ? "no check was made" : "the run broke: " + Escape(worst.broken)) + ".";
  }
  const std::string value = check->shown.empty()
                                ? fmt::format("{} ({})", ValueText(check->value, check->unit), LimitText(*check))
                                : Escape(check->shown);
  if (check->verdict == Verdict::kPass) {
    const std::string all =
        worst.checks.size() == 1 ? "The one check holds" : fmt::format("All {} checks hold", worst.checks.size());
    return text + fmt::format("{}. The closest to its limit is {}: {}.", all, Escape(check->name), value);
  }
  const auto failed = std::count_if(worst.checks.begin(), worst.checks.end(),
                                    [](const Check& one) { return one.verdict != Verdict::kPass; });
  std::string why = check->cause.empty() ? check->explanation : "Likely cause: " + check->cause;
  if (!worst.changes.empty()) why += fmt::format(". Changed {}", fmt::join(worst.changes, "; "));
  return text + fmt::format("{}: {}. {}. {} of {} checks {}.", Escape(check->name), value, Escape(why), failed,
                            worst.checks.size(), failed == 1 ? "does not pass" : "do not pass");
}

std::string FiguresOf(const ScenarioResult& result) {
  std::string rows;
  for (const auto& [name, figure] : result.figures) {
    rows += Row(std::vector<Cell>{{Escape(name), "key"}, {ValueText(figure.value, figure.unit), "number"}});
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

std::optional<RunPage::Part> RunPage::PartOf(const std::string& id) const {
  const auto found = parts_.find(id);
  return found == parts_.end() ? std::nullopt : std::optional(found->second);
}

void RunPage::Put(const std::string& id, Part part) {
  const std::lock_guard<std::mutex> lock(mutex_);
  bytes_ += part.pictures.size();
  parts_[id] = std::move(part);
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
  std::string body;
  if (results.size() != 1) {
    body = fmt::format("<section id=\"overview\"><h2>{} scenarios, {} checks{}</h2>\n", results.size(), checks, sums) +
           Filter(counts) + Overview(sorted) + "</section>\n";
  }
  std::size_t open = 0;  // a few parts are shown at once, the worst first
  for (const ScenarioResult* result : sorted) {
    const auto found = parts_.find(result->id);
    const bool bad = result->verdict != Verdict::kPass;
    body += fmt::format(
        "<details class=\"part\" data-verdict=\"{}\" id=\"{}\"{}><summary><h2>{}</h2> {} {}</summary>\n",
        score::ToString(result->verdict), Anchor(result->id), (bad || results.size() <= 3) && open++ < 5 ? " open" : "",
        Escape(result->id), Badge(result->verdict), Escape(result->title));
    if (found != parts_.end() && !found->second.source.empty())
      body += fmt::format("<p class=\"source\">{}</p>\n", Escape(found->second.source));
    if (!result->broken.empty())
      body += fmt::format("<p class=\"broken\">The run broke: {}</p>\n", Escape(result->broken));
    for (const std::string& note : result->notes) body += fmt::format("<p class=\"note\">{}</p>\n", Escape(note));
    if (bad) body += "<h3>Score card</h3>\n" + ScoreCard(result->checks);
    if (found != parts_.end()) body += "<h3>Pictures</h3>\n" + found->second.pictures;
    if (!bad) body += "<h3>Score card</h3>\n" + ScoreCard(result->checks);
    if (!result->figures.empty()) body += More("Figures", FiguresOf(*result));
    if (found != parts_.end()) {
      body += More("Settings: given, and what was taken where nothing was given", found->second.settings);
      body += More("Solver and provenance", found->second.counters);
    }
    body += "</details>\n";
  }
  return Page(TitleOf(sorted), LeadOf(sorted), BuildLine(), body);
}

}  // namespace dynoproof::reports
