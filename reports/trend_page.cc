#include "reports/trend_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "reports/html.h"

namespace dynoproof::reports {
namespace {

using history::Finding;
using history::History;
using history::Series;
using history::Watch;

/// What a series' name begins with, and what that is called.
const std::pair<const char*, const char*> kGroups[] = {{"budget/", "Budgets of the 10 kHz core"},
                                                       {"bench/", "Cost of a period"},
                                                       {"time/", "Benchmarks"},
                                                       {"score/", "Scores"},
                                                       {"counter/", "Counters of solvers"},
                                                       {"figure/", "Figures"}};

std::string SixDigits(double value) { return fmt::format("{:.6g}", value); }

std::string Change(const Finding& finding) {
  if (finding.kind == Finding::Kind::kMissing)
    return std::isfinite(finding.before) ? "last was " + SixDigits(finding.before) : "no reading, nor ever one";
  const std::string share =
      finding.before == 0.0 ? "" : fmt::format(" ({:+.1f} %)", 100.0 * (finding.after / finding.before - 1.0));
  return fmt::format("{} → {}{}", SixDigits(finding.before), SixDigits(finding.after), share);
}

std::string FindingsTable(const History& history, const Watch& watch) {
  std::string rows;
  for (const Finding& finding : watch.findings) {
    const Series& series = history.series[finding.series];
    const bool bad = finding.kind == Finding::Kind::kWorse || finding.kind == Finding::Kind::kMissing;
    const char* css = !finding.recent ? "inconclusive" : bad ? "fail" : "pass";
    rows += Row(std::vector<Cell>{
        {fmt::format("<span class=\"verdict {}\">{}{}</span>", css, ToString(finding.kind),
                     finding.recent ? "" : ", long ago")},
        {fmt::format("<a href=\"#{}\">{}</a>", Anchor("series-" + series.name), Escape(series.name)), "key"},
        {Escape(Change(finding)), "number"},
        {Escape(series.unit == "1" ? "" : series.unit)},
        {Escape(history.nights[finding.night].time)},
        {Escape(history.nights[finding.night].commit)},
        {series.scatters && finding.kind != Finding::Kind::kMissing ? fmt::format("{:.2g}", finding.p) : "exact",
         "number"}});
  }
  if (rows.empty()) return "<p>No level changed.</p>\n";
  return Table(std::vector<Cell>{{"what"}, {"series"}, {"level"}, {"unit"}, {"since"}, {"commit"}, {"p"}}, rows);
}

Picture Course(const History& history, const Watch& watch, std::size_t index) {
  const Series& series = history.series[index];
  Picture picture{.key = series.name, .title = series.name, .x = {"night", "1"}, .y = {"value", series.unit}};
  Curve line, points;
  line.label = "value";
  points.label = "nights";
  points.style = Curve::Style::kPoints;
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    line.x.push_back(static_cast<double>(series.nights[i]));
    line.y.push_back(series.values[i].value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  points.x = line.x;
  points.y = line.y;
  picture.curves = {line, points};
  for (const Finding& finding : watch.findings) {
    if (finding.series != index) continue;
    picture.marks.push_back({static_cast<double>(finding.night),
                             fmt::format("{}: {}", history.nights[finding.night].commit, ToString(finding.kind))});
  }
  return picture;
}

}  // namespace

std::string TrendPage(const History& history, const Watch& watch) {
  const auto bad = std::count_if(watch.findings.begin(), watch.findings.end(), [](const Finding& one) {
    return one.recent && (one.kind == Finding::Kind::kWorse || one.kind == Finding::Kind::kMissing);
  });
  const std::string lead = fmt::format(
      "{} nights, {} series: {} became worse or went missing of late; {} could be compared, {} are too short yet.",
      history.nights.size(), history.series.size(), bad, watch.compared, watch.too_short);
  std::string body = "<h2>Changes</h2>\n" + FindingsTable(history, watch);
  for (const auto& [prefix, title] : kGroups) {
    std::map<std::string, std::vector<std::size_t>> parts;  // by scenario
    for (std::size_t s = 0; s < history.series.size(); ++s) {
      const std::string& name = history.series[s].name;
      if (!name.starts_with(prefix)) continue;
      const std::string rest = name.substr(std::string(prefix).size());
      parts[rest.substr(0, rest.rfind('/') == std::string::npos ? 0 : rest.rfind('/'))].push_back(s);
    }
    if (parts.empty()) continue;
    body += fmt::format("<h2>{}</h2>\n", title);
    for (const auto& [part, members] : parts) {
      const std::string id = Anchor(std::string(prefix) + part);
      body += fmt::format("<details class=\"part\" id=\"{}\"{}><summary>{}</summary>\n", id,
                          parts.size() == 1 ? " open" : "", Escape(part.empty() ? "all" : part));
      std::vector<Picture> pictures;
      for (const std::size_t s : members) {
        body += fmt::format("<span id=\"{}\"></span>", Anchor("series-" + history.series[s].name));
        pictures.push_back(Course(history, watch, s));
      }
      body += Figures("data-" + id, pictures, 1'000'000) + "</details>\n";
    }
  }
  const std::string machine = history.nights.empty() ? "" : history.nights.back().machine;
  return Page(
      bad == 0 ? "nightly record: nothing became worse" : fmt::format("nightly record: {} series became worse", bad),
      lead, "machine class: " + machine, body);
}

}  // namespace dynoproof::reports
