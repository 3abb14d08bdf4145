#include "reports/atlas_page.h"

#include <fmt/format.h>

#include <map>

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

std::string Number(double value) { return fmt::format("{:.6g}", value); }

std::string ClaimRow(const ClaimResult& result) {
  const Claim& claim = result.claim;
  const bool checkable = claim.expect != "not_checkable";
  const std::string verdict = result.fault.empty() ? ToString(result.standing) : "fault";
  std::string says = verdict == "not_checkable" ? "not checkable" : verdict;
  if (!result.as_expected && result.fault.empty()) says += ", expected otherwise";
  const std::string unit = claim.unit == "1" ? "" : claim.unit;
  const std::string tolerance =
      checkable ? fmt::format("within {:.3g}: {}", claim.tolerance, claim.origin) : std::string();
  return Row(
      std::vector<Cell>{{Escape(claim.id), "key"},
                        {Escape(claim.place)},
                        {Escape(claim.claim), "wide"},
                        {checkable ? Number(claim.published) : "–", "number"},
                        {result.ours ? Number(result.ours->value) : "–", "number"},
                        {result.ours ? fmt::format("{:+.3g}", result.ours->value - claim.published) : "–", "number"},
                        {Escape(unit)},
                        {fmt::format("<span class=\"verdict {}\">{}</span>", verdict, Escape(says))},
                        {Escape(result.fault.empty() ? claim.explanation : result.fault) +
                             (tolerance.empty() ? "" : fmt::format("<div class=\"note\">{}</div>", Escape(tolerance))),
                         "wide"}});
}

std::string FigureHtml(const DrawnFigure& drawn, const std::vector<ClaimResult>& claims, std::size_t share) {
  const AtlasFigure& figure = drawn.figure;
  std::string html = fmt::format("<section id=\"{}\"><h3>Fig. {}: {}</h3>\n", Anchor("fig-" + figure.number),
                                 Escape(figure.number), Escape(figure.title));
  std::string scenarios;
  for (const std::string& id : figure.scenarios) scenarios += (scenarios.empty() ? "" : ", ") + id;
  html += fmt::format("<p class=\"source\">ours: {}{}{}</p>\n", Escape(scenarios),
                      figure.missing.empty() ? "" : "; not to be compared: ", Escape(figure.missing));
  std::string published;
  for (const ClaimResult& result : claims) {
    const Claim& claim = result.claim;
    if (!Names(claim.place, figure.number) || !result.ours) continue;
    published += fmt::format("<li>{}: published {}, ours {}{}, {}</li>\n", Escape(claim.claim), Number(claim.published),
                             Number(result.ours->value), claim.unit == "1" ? "" : " " + Escape(claim.unit),
                             ToString(result.standing));
  }
  if (!published.empty()) html += "<ul>\n" + published + "</ul>\n";
  if (!drawn.fault.empty()) html += fmt::format("<p class=\"fault\">{}</p>\n", Escape(drawn.fault));
  std::vector<Picture> pictures;
  for (const Picture& picture : drawn.pictures) {
    if (!picture.curves.empty()) pictures.push_back(picture);
  }
  if (!pictures.empty()) html += Figures("data-" + Anchor(figure.number), pictures, share);
  return html + "</section>\n";
}

}  // namespace

std::string ChapterOf(const Claim& claim) {
  std::string_view id = claim.id;
  if (id.starts_with("fig-")) id.remove_prefix(4);
  return std::string(id.substr(0, id.find_first_of(".-")));
}

std::string AtlasPage(const std::vector<ClaimResult>& claims, const std::vector<DrawnFigure>& figures) {
  struct Chapter {
    std::string rows, figures;
    int counts[3] = {};
  };
  std::map<std::string, Chapter> chapters;
  int unexpected = 0;
  for (const ClaimResult& result : claims) {
    Chapter& chapter = chapters[ChapterOf(result.claim)];
    chapter.rows += ClaimRow(result);
    ++chapter.counts[static_cast<int>(result.standing)];
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
    contents += Row(std::vector<Cell>{{fmt::format("<a href=\"#{}\">{}</a>", id, Escape(title))},
                                      {fmt::format("{}", chapter.counts[0]), "number reproduced"},
                                      {fmt::format("{}", chapter.counts[1]), "number contradicted"},
                                      {fmt::format("{}", chapter.counts[2]), "number not_checkable"}});
    parts += fmt::format("<details class=\"part\" id=\"{}\" open><summary><h2>{}</h2></summary>\n", id, Escape(title));
    if (!chapter.rows.empty()) {
      parts += Table(std::vector<Cell>{{"claim"},
                                       {"place"},
                                       {"what it says"},
                                       {"published", "number"},
                                       {"ours", "number"},
                                       {"deviation", "number"},
                                       {"unit"},
                                       {"verdict"},
                                       {"explanation and tolerance"}},
                     chapter.rows);
    }
    parts += chapter.figures + "</details>\n";
  }
  const trace::Provenance build = BuildProvenance();
  return Page(
      "dynoproof reproduce: atlas of the thesis",
      fmt::format("dynoproof {}, {}, {}", build.Text("version").value_or(""), build.Text("commit").value_or(""),
                  build.Text("compiler").value_or("")),
      fmt::format("<section id=\"overview\"><h2>{} claims, {} otherwise than the ledger expects, {} figures</h2>\n",
                  claims.size(), unexpected, figures.size()) +
          Table(
              std::vector<Cell>{
                  {"part"}, {"reproduced", "number"}, {"contradicted", "number"}, {"not checkable", "number"}},
              contents) +
          "</section>\n" + parts);
}

}  // namespace dynoproof::reports
