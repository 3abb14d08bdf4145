#include "thesis/commands/atlas_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "experiment/run_scenario.h"
#include "reports/html.h"

namespace dynoproof::reports {
namespace {

/// Rooms in the file: 8 million samples cost some 22 MB.
constexpr std::size_t kSamples = 8'000'000;

std::string TitleOf(const std::string& chapter) {
  static const std::map<std::string, std::string> titles = {{"2", "Drive lines"},
                                                            {"3", "Backlash"},
                                                            {"4", "Hydrodynamic couplings"},
                                                            {"5", "Resonance suppression"},
                                                            {"6", "Pressures and hardware in the loop"},
                                                            {"A", "parameters of the drive lines"},
                                                            {"B", "soft rotor with a spring-mass system"},
                                                            {"C", "parameters of the test bed with backlash"},
                                                            {"D", "notch filters"},
                                                            {"E", "probing of oscillations"}};
  const auto found = titles.find(chapter);
  const bool appendix = !chapter.empty() && chapter[0] >= 'A';
  return (appendix ? "Appendix " : "Chapter ") + chapter + (found == titles.end() ? "" : ": " + found->second);
}

std::string Number(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "–"; }

/// What to know of a claim: the explanation, or why there is no figure; the origin of the tolerance; what is assumed.
/// Under the claim and not beside it, so that the figures stay in sight on a narrow page.
std::string Notes(const ClaimResult& result) {
  const Claim& claim = result.claim;
  const std::string& explanation = result.fault.empty() ? claim.explanation : result.fault;
  std::string notes;
  if (!explanation.empty()) notes += fmt::format("<div>{}</div>", Escape(explanation));
  if (!claim.origin.empty()) notes += fmt::format("<div class=\"note\">allowed: {}</div>", Escape(claim.origin));
  if (!claim.assumed.empty()) notes += fmt::format("<div class=\"note\">assumed: {}</div>", Escape(claim.assumed));
  return notes;
}

std::string ClaimRow(const ClaimResult& result) {
  const Claim& claim = result.claim;
  const double ours = result.ours ? result.ours->value : Claim::kNone, deviation = ours - claim.Reference();
  const std::string standing = result.fault.empty() ? ToString(result.standing) : "fault";
  std::string says = result.fault.empty() ? InWords(result.standing) : "fault";
  if (!result.as_expected && result.fault.empty()) says += ", expected otherwise";
  const std::string allowed = AllowedText(claim);
  // Name, place and standing below one another, limit and deviation too: the sentence needs the width.
  const std::string name = fmt::format("{}<div class=\"note\">{}</div><div class=\"verdict {}\">{}</div>",
                                       Escape(claim.id), Escape(claim.place), standing, Escape(says));
  const std::string unit = claim.unit == "1" || !result.ours ? "" : " " + Escape(claim.unit);
  std::string limit = allowed.empty() ? "–" : Escape(allowed);
  if (std::isfinite(deviation)) limit += fmt::format("<div class=\"note\">{:+.3g}</div>", deviation);
  return Row(std::vector<Cell>{{name, "key"},
                               {fmt::format("<strong>{}</strong>{}", Escape(claim.claim), Notes(result)), "text"},
                               {Number(claim.thesis), "number"},
                               {Number(claim.independent), "number"},
                               {Number(ours) + unit, "number"},
                               {limit, "number"}});
}

/// What the thesis says of it and what comes out here, in one line.
std::string InBrief(const ClaimResult& result) {
  const Claim& claim = result.claim;
  std::string against;
  if (claim.HasThesis()) against += fmt::format("the thesis says {}, ", Number(claim.thesis));
  if (claim.HasIndependent()) against += fmt::format("another method {}, ", Number(claim.independent));
  return fmt::format("<li>{}: {}ours {}{}, {}</li>\n", Escape(claim.claim), against, Number(result.ours->value),
                     claim.unit == "1" ? "" : " " + Escape(claim.unit), InWords(result.standing));
}

std::vector<Cell> StandingHeads() {
  std::vector<Cell> heads = {{"part"}};
  for (int i = 0; i < kStandings; ++i) heads.push_back({InWords(static_cast<Standing>(i)), "number"});
  return heads;
}

std::string FigureHtml(const DrawnFigure& drawn, const std::vector<ClaimResult>& claims, std::size_t share) {
  const AtlasFigure& figure = drawn.figure;
  std::string html = fmt::format("<section id=\"{}\"><h3>Fig. {}: {}</h3>\n", Anchor("fig-" + figure.number),
                                 Escape(figure.number), Escape(figure.title));
  if (!figure.shows.empty()) html += fmt::format("<p>{}</p>\n", Escape(figure.shows));
  const std::string ours = figure.scenarios.empty() ? "computed for this figure alone"
                                                    : fmt::format("{}", fmt::join(figure.scenarios, ", "));
  html += fmt::format("<p class=\"source\">ours: {}{}{}</p>\n", Escape(ours),
                      figure.missing.empty() ? "" : "; not to be compared: ", Escape(figure.missing));
  std::string claimed;
  for (const ClaimResult& result : claims) {
    if (Names(result.claim.place, figure.number) && result.ours) claimed += InBrief(result);
  }
  if (!claimed.empty()) html += "<ul>\n" + claimed + "</ul>\n";
  if (!drawn.fault.empty()) html += fmt::format("<p class=\"fault\">{}</p>\n", Escape(drawn.fault));
  std::vector<Picture> pictures;
  for (const Picture& picture : drawn.pictures) {
    if (!picture.curves.empty()) pictures.push_back(picture);
  }
  if (!pictures.empty()) html += Figures("data-" + Anchor(figure.number), pictures, share);
  return html + "</section>\n";
}

/// "2.4, 2.11, 2.18" as links to the figures of this page.
std::string FigureLinks(const std::vector<std::string>& numbers) {
  std::string links;
  for (const std::string& number : numbers) {
    links += fmt::format("{}<a href=\"#{}\">Fig. {}</a>", links.empty() ? "" : ", ", Anchor("fig-" + number),
                         Escape(number));
  }
  return links;
}

/// "not given"
std::string StateText(std::string state) {
  std::ranges::replace(state, '_', ' ');
  return state;
}

std::string CoverageRowHtml(CoverageRow row) {
  const std::string links = FigureLinks(row.figures), place = row.place;
  row.figures.clear();  // they stand as links
  const std::string others = row.CoveredBy();
  const std::string key = fmt::format("{}{}<div class=\"verdict {}\">{}</div>", Escape(row.name),
                                      place.empty() ? "" : fmt::format("<div class=\"note\">{}</div>", Escape(place)),
                                      row.state, StateText(row.state));
  return Row(std::vector<Cell>{
      {key, "key"},
      {fmt::format("<strong>{}</strong>{}", Escape(row.title),
                   row.reason.empty() ? "" : fmt::format("<div>{}</div>", Escape(row.reason))),
       "text"},
      {fmt::format("{}{}{}", links, links.empty() || others.empty() ? "" : "; ", Escape(others)), "wide"}});
}

/// How much of the thesis is here: counts by kind, and every row in a part of its own that is closed at first.
std::string CoverageHtml(const std::vector<CoverageRow>& rows) {
  if (rows.empty()) return "";
  const std::vector<std::string> states = CoverageRow::States();
  std::vector<Cell> heads = {{"part"}};
  for (const std::string& state : states) heads.push_back({StateText(state), "number"});
  std::string counts, parts;
  for (const std::string& kind : CoverageRow::Kinds()) {
    const std::vector<int> count = CountStates(rows, kind);
    if (std::accumulate(count.begin(), count.end(), 0) == 0) continue;  // the page of one claim has a few rows only
    const std::string id = Anchor("coverage-" + kind);
    std::vector<Cell> line = {{fmt::format("<a href=\"#{}\">{}s</a>", id, kind)}};
    for (std::size_t i = 0; i < states.size(); ++i)
      line.push_back({fmt::format("{}", count[i]), "number " + states[i]});
    counts += Row(line);
    std::string lines;
    for (const CoverageRow& row : rows) lines += row.kind == kind ? CoverageRowHtml(row) : "";
    parts += fmt::format(
        "<details class=\"part\" id=\"{}\"><summary><h2>Row by row: {}s</h2></summary>\n{}</details>\n", id, kind,
        Table(std::vector<Cell>{{"name, place, state"}, {"what it is, and why it is not whole"}, {"covered by"}},
              lines));
  }
  return "<section id=\"coverage\"><h2>What of the thesis is here</h2>\n"
         "<p class=\"note\">whole: computed from what the thesis prints; assumed: the same with data that it does not "
         "print; partial: something is not computed, cannot be compared or comes out otherwise; not given: the thesis "
         "gives nothing of it to compute from, as a photograph; missing: nothing of it is here, though there could be. "
         "A "
         "diagram is a figure without axes: its structure is built, not drawn.</p>\n" +
         Table(heads, counts) + parts + "</section>\n";
}

}  // namespace

std::string ChapterOf(const Claim& claim) {
  std::string_view id = claim.id;
  if (id.starts_with("fig-")) id.remove_prefix(4);
  return std::string(id.substr(0, id.find_first_of(".-")));
}

std::string AtlasPage(const std::vector<ClaimResult>& claims, const std::vector<DrawnFigure>& figures,
                      const std::vector<CoverageRow>& coverage) {
  struct Chapter {
    std::string rows, figures;
    std::array<int, kStandings> counts = {};
  };
  std::map<std::string, Chapter> chapters;
  int unexpected = 0;
  for (const ClaimResult& result : claims) {
    Chapter& chapter = chapters[ChapterOf(result.claim)];
    chapter.rows += ClaimRow(result);
    if (result.fault.empty()) ++chapter.counts[static_cast<std::size_t>(result.standing)];
    unexpected += result.as_expected ? 0 : 1;
  }
  const std::size_t share = kSamples / std::max<std::size_t>(1, figures.size());
  for (const DrawnFigure& drawn : figures) {
    const std::string& number = drawn.figure.number;
    chapters[number.substr(0, number.find('.'))].figures += FigureHtml(drawn, claims, share);
  }
  std::string contents, parts;
  for (const auto& [name, chapter] : chapters) {
    const std::string title = TitleOf(name), id = Anchor("chapter-" + name);
    std::vector<Cell> row = {{fmt::format("<a href=\"#{}\">{}</a>", id, Escape(title))}};
    for (int i = 0; i < kStandings; ++i) {
      row.push_back({fmt::format("{}", chapter.counts[static_cast<std::size_t>(i)]),
                     fmt::format("number {}", ToString(static_cast<Standing>(i)))});
    }
    contents += Row(row);
    parts += fmt::format("<details class=\"part\" id=\"{}\" open><summary><h2>{}</h2></summary>\n", id, Escape(title));
    if (!chapter.rows.empty()) {
      parts += Table(std::vector<Cell>{{"claim, place, standing"},
                                       {"what it says, and what to know of it"},
                                       {"thesis says", "number"},
                                       {"independent", "number"},
                                       {"ours", "number"},
                                       {"allowed, deviation", "number"}},
                     chapter.rows);
    }
    parts += chapter.figures + "</details>\n";
  }
  const std::string lead = fmt::format("{} claims, {} otherwise than the ledger expects, {} figures.", claims.size(),
                                       unexpected, figures.size());
  return Page(unexpected == 0 ? "atlas of the thesis: all claims as expected"
                              : fmt::format("atlas of the thesis: {} claims otherwise than expected", unexpected),
              lead, reports::BuildLine(),
              "<section id=\"overview\"><h2>Claims by chapter</h2>\n" + Table(StandingHeads(), contents) +
                  "</section>\n" + CoverageHtml(coverage) + parts);
}

}  // namespace dynoproof::reports
