#include "reports/campaign_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reports/html.h"

namespace dynoproof::reports {
namespace {

constexpr std::size_t kSamples = 2'000'000, kWorst = 20;  // some 6 MB of points

std::string FiveDigits(double value) { return std::isfinite(value) ? fmt::format("{:.5g}", value) : "–"; }

std::string Percent(const score::Rate& rate) {
  return fmt::format("{:.1f} % [{:.1f}, {:.1f}]", 100.0 * rate.value(), 100.0 * rate.lower(), 100.0 * rate.upper());
}

/// The lines that a figure may not cross.
std::vector<Mark> LimitsOf(const campaign::FigureInfo& info, bool horizontal) {
  std::vector<Mark> marks;
  if (std::isfinite(info.at_least))
    marks.push_back({info.at_least, fmt::format("at least {:.4g}", info.at_least), horizontal});
  if (std::isfinite(info.at_most))
    marks.push_back({info.at_most, fmt::format("at most {:.4g}", info.at_most), horizontal});
  return marks;
}

/// Figure over axis: a point a run, those that pass apart from the others.
Picture FigureOver(const campaign::Campaign& campaign, const campaign::Rows& rows, std::size_t figure,
                   std::size_t axis) {
  const campaign::FigureInfo& info = campaign.subject->figures()[figure];
  const std::string& key = campaign.axes.spec(axis).key;
  Picture picture;
  picture.key = info.name + " over " + key;
  picture.title = info.name + " over " + key;
  const std::vector<std::string> labels = campaign.axes.Labels(axis);
  for (std::size_t i = 0; i < labels.size(); ++i)
    picture.note += fmt::format("{}{}: {}", i == 0 ? "" : ", ", i, labels[i]);
  picture.x = {key, ""};
  picture.y = {info.name, info.unit == "1" ? "" : info.unit};
  picture.marks = LimitsOf(info, true);
  Curve pass{"pass", {}, {}, Curve::Style::kPoints}, other{"not passed", {}, {}, Curve::Style::kCrosses};
  std::vector<std::pair<double, const campaign::Row*>> points;
  for (const campaign::Row& row : rows.rows) {
    if (std::isfinite(row.figures[figure])) points.emplace_back(campaign.axes.Number(axis, row.run), &row);
  }
  std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [x, row] : points) {
    Curve& curve = row->verdict == score::Verdict::kPass ? pass : other;
    curve.x.push_back(x);
    curve.y.push_back(row->figures[figure]);
  }
  for (Curve* curve : {&pass, &other}) {
    if (!curve->x.empty()) picture.curves.push_back(std::move(*curve));
  }
  return picture;
}

/// Over a value the share of runs that have at most that.
Picture ShareOf(const campaign::FigureInfo& info, const campaign::Rows& rows, std::size_t figure) {
  Picture picture{.key = "share " + info.name,
                  .title = info.name + ": share of runs up to a value",
                  .x = {info.name, info.unit == "1" ? "" : info.unit},
                  .y = {"share of runs", "1"}};
  Curve share{"share", {}, {}, Curve::Style::kHold};
  for (const campaign::Row& row : rows.rows) {
    if (std::isfinite(row.figures[figure])) share.x.push_back(row.figures[figure]);
  }
  std::sort(share.x.begin(), share.x.end());
  for (std::size_t i = 0; i < share.x.size(); ++i)
    share.y.push_back(static_cast<double>(i + 1) / static_cast<double>(share.x.size()));
  picture.y.from = 0.0;
  picture.y.to = 1.0;
  picture.marks = LimitsOf(info, false);
  if (share.x.size() > 1) picture.curves.push_back(std::move(share));
  return picture;
}

std::string FigureTable(const campaign::Summary& summary) {
  std::string rows;
  for (const campaign::FigureSummary& one : summary.figures) {
    std::vector<Cell> cells = {{Escape(one.name)}, {Escape(one.unit)}, {fmt::format("{}", one.runs), "number"}};
    if (one.runs > 0) {
      for (const double value : {one.least, one.q05, one.median, one.q95, one.largest, one.mean})
        cells.push_back({FiveDigits(value), "number"});
      cells.push_back({fmt::format("[{}, {}]", FiveDigits(one.median_lower), FiveDigits(one.median_upper))});
    }
    rows += Row(cells);
  }
  return Table(std::vector<Cell>{{"figure"},
                                 {"unit"},
                                 {"runs", "number"},
                                 {"least", "number"},
                                 {"5 %", "number"},
                                 {"median", "number"},
                                 {"95 %", "number"},
                                 {"largest", "number"},
                                 {"mean", "number"},
                                 {"median within (95 %)"}},
               rows);
}

std::string RateTable(const campaign::Summary& summary) {
  std::string rows;
  for (const campaign::RateSummary& one : summary.rates) {
    rows += Row(std::vector<Cell>{{Escape(one.name)},
                                  {Escape(one.group.empty() ? "all" : one.group)},
                                  {fmt::format("{} of {}", one.rate.hits, one.rate.of), "number"},
                                  {Percent(one.rate), "number"}});
  }
  if (rows.empty()) return "";
  return Table(std::vector<Cell>{{"rate"}, {"of"}, {"counted", "number"}, {"share, 95 % interval", "number"}}, rows);
}

std::int64_t NotPassed(const campaign::Rows& rows) {
  return std::ranges::count_if(rows.rows, [](const auto& row) { return row.verdict != score::Verdict::kPass; });
}

/// The runs that did not pass; where all did, the one that a limit was closest to stopping.
std::string WorstRuns(const campaign::Rows& rows, const std::string& again) {
  const std::vector<std::int64_t> worst = campaign::WorstRuns(rows.rows, kWorst);
  if (worst.empty()) {
    const campaign::Row* closest = campaign::ClosestToItsLimit(rows.rows);
    if (closest == nullptr) return "<h2>All runs passed</h2>\n";
    return fmt::format(
        "<h2>All runs passed</h2>\n<p>Closest to its limit: run {0}, {1} ({2:.4g} % of it). Again: <code>{3} --run "
        "{0}</code></p>\n",
        closest->run, Escape(closest->nearest), 100.0 * closest->used, Escape(again));
  }
  std::string text;
  for (const std::int64_t run : worst) {
    const campaign::Row& row = rows.rows[static_cast<std::size_t>(run)];
    text += Row(std::vector<Cell>{{fmt::format("{}", run), "number"},
                                  {fmt::format("<span class=\"verdict {0}\">{0}</span>", score::ToString(row.verdict))},
                                  {Escape(row.why), "wide"},
                                  {Escape(fmt::format("{} --run {}", again, run)), "key"}});
  }
  return fmt::format("<h2>Runs that did not pass, worst first</h2>\n<p class=\"note\">{} of {}</p>\n", worst.size(),
                     NotPassed(rows)) +
         Table(std::vector<Cell>{{"run", "number"}, {"verdict"}, {"why"}, {"again"}}, text);
}

}  // namespace

std::string CampaignPage(const campaign::Campaign& campaign, const campaign::Rows& rows,
                         const campaign::Summary& summary, const std::string& again) {
  std::string body = "<section id=\"overview\"><h2>Figures</h2>\n" + FigureTable(summary) + RateTable(summary) +
                     "</section>\n<section id=\"worst\">" + WorstRuns(rows, again) + "</section>\n";
  std::vector<Picture> pictures;
  for (std::size_t figure = 0; figure < campaign.subject->figures().size(); ++figure) {
    Picture share = ShareOf(campaign.subject->figures()[figure], rows, figure);
    if (!share.curves.empty()) pictures.push_back(std::move(share));
    for (std::size_t axis = 0; axis < campaign.axes.size(); ++axis) {
      Picture picture = FigureOver(campaign, rows, figure, axis);
      if (!picture.curves.empty()) pictures.push_back(std::move(picture));
    }
  }
  body += "<section id=\"figures\"><h2>Shares, and figures over axes</h2>\n" +
          Figures("data-figures", pictures, kSamples) + "</section>\n";
  const std::int64_t bad = NotPassed(rows);
  const std::string lead =
      fmt::format("{}: {} runs, failing {}.", Escape(campaign.title), summary.runs, Percent(summary.failing));
  return Page(fmt::format("campaign {}: {}", campaign.id,
                          bad == 0 ? fmt::format("all {} runs pass", summary.runs)
                                   : fmt::format("{} of {} runs do not pass", bad, summary.runs)),
              lead, BuildLine() + "; rows made on " + rows.cpu, body);
}

}  // namespace dynoproof::reports
