#include "reports/run_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>

namespace dynoproof::reports {
namespace {

using score::Check;
using score::Verdict;

std::string Paint(const char* code, const std::string& text, bool colour) {
  return colour ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
}

const char* Colour(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "32";
    case Verdict::kInconclusive:
      return "33";
    default:
      return "1;31";
  }
}

/// How much of its limit a check used; infinite for one that never came to a number.
double Share(const Check& check) {
  if (!std::isfinite(check.value) || !std::isfinite(check.limit)) return INFINITY;
  if (check.at_least) return check.value > 0.0 ? check.limit / check.value : INFINITY;
  return check.limit > 0.0 ? check.value / check.limit : (check.value > check.limit ? INFINITY : 0.0);
}

int Failed(const ScenarioResult& result) {
  return static_cast<int>(std::count_if(result.checks.begin(), result.checks.end(),
                                        [](const Check& check) { return check.verdict != Verdict::kPass; }));
}

std::string Limit(const Check& check) {
  if (!check.shown.empty()) return check.shown;
  const std::string unit = check.unit == "1" ? "" : " " + check.unit;
  if (std::isnan(check.value) && std::isnan(check.limit)) return "no number";
  const std::string value = std::isnan(check.value) ? "no number" : fmt::format("{:.3g}{}", check.value, unit);
  return fmt::format("{} ({} {:.3g}{})", value, check.at_least ? "at least" : "limit", check.limit, unit);
}

/// A piece of Markdown inside a line or a table cell: no line breaks, no pipes, no HTML; a long one is cut short.
std::string Markdown(const std::string& text, std::size_t most = 2000) {
  std::string out;
  for (const char c : text) {
    if (out.size() >= most) return out + " ...";
    switch (c) {
      case '\n':
      case '\r':
        out += ' ';
        break;
      case '|':
        out += "\\|";
        break;
      case '<':
        out += "&lt;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace

int WorseExit(int a, int b) {
  const auto rank = [](int code) {
    constexpr int kOrder[] = {2, 3, 1, 5, 4, 0};
    const auto* found = std::find(std::begin(kOrder), std::end(kOrder), code);
    return found == std::end(kOrder) ? 1 : found - std::begin(kOrder);  // an unknown code is a broken run
  };
  return rank(a) < rank(b) ? a : b;
}

int ExitCode(const std::vector<ScenarioResult>& results) {
  if (results.empty()) return 1;
  int code = 0;
  for (const ScenarioResult& result : results) {
    code = WorseExit(code, result.broken.empty() ? score::ExitCode(result.verdict) : result.exit_code);
  }
  return code;
}

std::vector<const ScenarioResult*> WorstFirst(const std::vector<ScenarioResult>& results) {
  std::vector<const ScenarioResult*> sorted;
  for (const ScenarioResult& result : results) sorted.push_back(&result);
  const auto badness = [](const ScenarioResult* result) {
    switch (result->verdict) {
      case Verdict::kBroken:
        return 0;
      case Verdict::kFail:
        return 1;
      case Verdict::kInconclusive:
        return 2;
      default:
        return 3;
    }
  };
  std::stable_sort(sorted.begin(), sorted.end(), [&](const auto* a, const auto* b) {
    if (badness(a) != badness(b)) return badness(a) < badness(b);
    const Check *const of_a = WorstCheck(*a), *const of_b = WorstCheck(*b);
    return of_a != nullptr && of_b != nullptr && Share(*of_a) > Share(*of_b);
  });
  return sorted;
}

nlohmann::json Number(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); }

nlohmann::json ToJson(const std::vector<ScenarioResult>& results) {
  nlohmann::json document = {{"exit", ExitCode(results)}, {"scenarios", nlohmann::json::array()}};
  for (const ScenarioResult& result : results) {
    nlohmann::json scenario = {{"id", result.id},
                               {"title", result.title},
                               {"verdict", score::ToString(result.verdict)},
                               {"trace", result.trace_file},
                               {"checks", nlohmann::json::array()},
                               {"figures", nlohmann::json::object()}};
    if (!result.broken.empty()) scenario["broken"] = result.broken;
    if (!result.notes.empty()) scenario["notes"] = result.notes;
    for (const Check& check : result.checks) {
      scenario["checks"].push_back({{"name", check.name},
                                    {"kind", check.kind},
                                    {"verdict", score::ToString(check.verdict)},
                                    {"value", Number(check.value)},
                                    {"limit", Number(check.limit)},
                                    {"limit_is", check.at_least ? "at_least" : "at_most"},
                                    {"unit", check.unit},
                                    {"origin", check.origin},
                                    {"explanation", check.explanation}});
      // The key is absent where value, limit and unit say all that the card shows.
      if (!check.shown.empty()) scenario["checks"].back()["shown"] = check.shown;
      if (!check.cause.empty()) scenario["checks"].back()["cause"] = check.cause;
    }
    for (const auto& [name, figure] : result.figures) {
      scenario["figures"][name] = {{"value", Number(figure.value)}, {"unit", figure.unit}};
    }
    if (!result.counters.empty()) scenario["counters"] = result.counters;
    document["scenarios"].push_back(std::move(scenario));
  }
  return document;
}

std::string ToJUnit(const std::vector<ScenarioResult>& results) {
  pugi::xml_document document;
  pugi::xml_node suites = document.append_child("testsuites");
  for (const ScenarioResult& result : results) {
    pugi::xml_node suite = suites.append_child("testsuite");
    const bool broken = result.verdict == Verdict::kBroken && result.checks.empty();
    const std::size_t cases = result.checks.size() + (broken || result.checks.empty() ? 1 : 0);
    suite.append_attribute("name") = result.id.c_str();
    suite.append_attribute("tests") = cases;
    int failures = 0, errors = 0, skipped = 0;
    const auto add = [&](const std::string& name, Verdict verdict, const std::string& message) {
      pugi::xml_node test = suite.append_child("testcase");
      test.append_attribute("classname") = result.id.c_str();
      test.append_attribute("name") = name.c_str();
      if (verdict == Verdict::kPass) return;
      const bool error = verdict == Verdict::kBroken, skip = verdict == Verdict::kInconclusive;
      ++(error ? errors : skip ? skipped : failures);
      pugi::xml_node why = test.append_child(error ? "error" : skip ? "skipped" : "failure");
      why.append_attribute("message") = message.c_str();
    };
    for (const Check& check : result.checks) add(check.name, check.verdict, Limit(check) + ": " + check.explanation);
    if (result.checks.empty()) {
      std::string why = result.broken;
      for (const std::string& note : result.notes) why += (why.empty() ? "" : "; ") + note;
      add("run", result.verdict, why);
    }
    suite.append_attribute("failures") = failures;
    suite.append_attribute("errors") = errors;
    suite.append_attribute("skipped") = skipped;
  }
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

std::string ToMarkdown(const std::vector<ScenarioResult>& results, std::size_t most_bytes) {
  int failed = 0, checks = 0;
  for (const ScenarioResult& result : results) {
    failed += result.verdict != Verdict::kPass;
    checks += static_cast<int>(result.checks.size());
  }
  std::string text = fmt::format(
      "# dynoproof run\n\n{} scenarios, {} checks, {} scenarios not passed\n\n"
      "| scenario | verdict | checks | failed | worst check | value (limit) |\n|---|---|---|---|---|---|\n",
      results.size(), checks, failed);
  std::string details;
  std::size_t left_out = 0;
  for (const ScenarioResult* result : WorstFirst(results)) {
    const Check* worst = WorstCheck(*result);
    const std::string row = fmt::format("| {} | {} | {} | {} | {} | {} |\n", Markdown(result->id),
                                        score::ToString(result->verdict), result->checks.size(), Failed(*result),
                                        worst == nullptr ? Markdown(result->broken) : Markdown(worst->name),
                                        worst == nullptr ? "" : Markdown(Limit(*worst)));
    std::string detail;
    if (!result->broken.empty())
      detail += fmt::format("- **{}**: the run broke: {}\n", Markdown(result->id), Markdown(result->broken));
    for (const Check& check : result->checks) {
      if (check.verdict == Verdict::kPass) continue;
      detail += fmt::format("- **{}**: {}: {}. {} Limit: {}\n", Markdown(result->id), Markdown(check.name),
                            score::ToString(check.verdict), Markdown(check.explanation), Markdown(check.origin));
    }
    // One scenario with very many failures must not push out the others, nor itself.
    if (constexpr std::size_t kMost = 50'000; detail.size() > kMost) {
      detail.resize(detail.rfind('\n', kMost) + 1);
      detail += fmt::format("- **{}**: more is left out for size; the JSON has it\n", Markdown(result->id));
    }
    if (text.size() + details.size() + row.size() + detail.size() > most_bytes) {
      ++left_out;
      continue;
    }
    text += row;
    details += detail;
  }
  if (left_out > 0) text += fmt::format("\n{} more scenarios are left out for size; the JSON has them.\n", left_out);
  if (!details.empty()) text += "\n## Not passed\n\n" + details;
  return text;
}

const Check* WorstCheck(const ScenarioResult& result) {
  const Check* worst = nullptr;
  for (const Check& check : result.checks) {
    if (worst == nullptr ||
        (score::Worse(check.verdict, worst->verdict) == check.verdict && check.verdict != worst->verdict) ||
        (check.verdict == worst->verdict && Share(check) > Share(*worst))) {
      worst = &check;
    }
  }
  return worst;
}

std::string ToTable(const std::vector<ScenarioResult>& results, bool colour) {
  std::size_t width = 8;
  for (const ScenarioResult& result : results) width = std::max(width, result.id.size());
  std::string text = fmt::format("{:<{}}  {:<12}  {:>6}  {:>6}  {}\n", "scenario", width, "verdict", "checks", "failed",
                                 "worst check");
  text += std::string(width + 60, '-') + "\n";
  for (const ScenarioResult& result : results) {
    const Check* worst = WorstCheck(result);
    std::string last = !result.broken.empty() ? result.broken : "";
    if (worst != nullptr) last = fmt::format("{}: {}", worst->name, Limit(*worst));
    if (worst == nullptr && last.empty() && !result.notes.empty()) last = result.notes.back();
    text += fmt::format("{:<{}}  {}  {:>6}  {:>6}  {}\n", result.id, width,
                        Paint(Colour(result.verdict), fmt::format("{:<12}", score::ToString(result.verdict)), colour),
                        result.checks.size(), Failed(result), last);
  }
  return text;
}

namespace {

/// Whether a check is of a curve that was made of another signal, whose own check says more.
bool IsOfHull(const Check& check) { return check.name.ends_with("_hull_upper") || check.name.ends_with("_hull_lower"); }

/// The checks that did not pass, those of one verdict and kind of comparison together, the worst of each first: one cause
/// mostly spoils many signals. What compared courses comes before what counts samples and steps.
std::vector<std::vector<const Check*>> NotPassed(const ScenarioResult& result) {
  std::vector<std::vector<const Check*>> groups;
  for (const Check& check : result.checks) {
    if (check.verdict == Verdict::kPass) continue;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return group[0]->kind == check.kind && group[0]->stated == check.stated && group[0]->verdict == check.verdict;
    });
    if (same == groups.end()) {
      groups.push_back({&check});
    } else {
      same->push_back(&check);
    }
  }
  for (auto& group : groups)
    std::stable_sort(group.begin(), group.end(), [](const Check* a, const Check* b) {
      if (IsOfHull(*a) != IsOfHull(*b)) return IsOfHull(*b);
      const bool number_a = std::isfinite(a->value),
                 number_b = std::isfinite(b->value);  // says more than that there is none
      return number_a != number_b ? number_a : Share(*a) > Share(*b);
    });
  std::stable_partition(groups.begin(), groups.end(), [](const auto& group) { return group[0]->evidence != nullptr; });
  return groups;
}

/// The clauses of a sentence, a line each, below one another.
std::string InLines(const std::string& label, const std::string& sentence) {
  constexpr std::string_view kBetween = "; ";
  std::string text;
  for (std::size_t from = 0; from < sentence.size();) {
    const std::size_t end = std::min(sentence.find(kBetween, from), sentence.size());
    text += (text.empty() ? label : std::string(label.size(), ' ')) + sentence.substr(from, end - from) + "\n";
    from = end + kBetween.size();
  }
  return text;
}

std::string Card(const ScenarioResult& result, const std::vector<const Check*>& together, bool colour) {
  const Check& worst = *together.front();
  const char* const verdict = worst.verdict == Verdict::kInconclusive ? "UNDECIDED" : "FAILED";
  std::string text = fmt::format("\n{} {}: {}\n  value  {}\n", Paint(Colour(worst.verdict), verdict, colour), result.id,
                                 worst.name, Limit(worst));
  text += InLines("  where  ", worst.explanation);
  if (!result.changes.empty()) text += fmt::format("  likely changed {}\n", fmt::join(result.changes, "; "));
  for (std::size_t i = 1; i < together.size(); ++i)
    text += fmt::format("  {}   {}: {}{}\n", i == 1 ? "also" : "    ", together[i]->name, Limit(*together[i]),
                        together[i]->cause.empty() ? "" : "; " + together[i]->cause);
  return text + fmt::format("  limit  {}\n", worst.origin);
}

}  // namespace

std::string ToCards(const std::vector<ScenarioResult>& results, const std::map<std::string, std::string>& again,
                    bool colour) {
  std::string text;
  for (const ScenarioResult& result : results) {
    const std::string& command = again.at(result.id);
    if (result.verdict == Verdict::kPass) continue;
    if (!result.broken.empty()) {
      text += fmt::format("\n{} {}\n  what   the run broke: {}\n", Paint("1;31", "BROKEN", colour), result.id,
                          result.broken);
    } else if (result.checks.empty()) {
      text += fmt::format("\n{} {}: no check was made\n", Paint("1;31", "FAILED", colour), result.id);
    }
    for (const std::vector<const Check*>& together : NotPassed(result)) text += Card(result, together, colour);
    text += fmt::format("\n  again  {}\n", command);  // once for all cards of a scenario, as its notes
    for (const std::string& note : result.notes) text += fmt::format("  note   {}\n", note);
  }
  return text;
}

}  // namespace dynoproof::reports
