#include "reports/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "reports/packed.h"
#include "reports/web_assets.h"

namespace dynoproof::reports {
namespace {

const char* ToString(Curve::Style style) {
  switch (style) {
    case Curve::Style::kDashed:
      return "dashed";
    case Curve::Style::kHold:
      return "hold";
    case Curve::Style::kPoints:
      return "points";
    case Curve::Style::kSamples:
      return "samples";
    case Curve::Style::kCrosses:
      return "crosses";
    case Curve::Style::kCircles:
      return "circles";
    default:
      return "line";
  }
}

nlohmann::json ToJson(const Axis& axis) {
  nlohmann::json json = {{"label", axis.label}, {"unit", axis.unit}, {"log", axis.logarithmic}};
  if (axis.from) json["from"] = *axis.from;
  if (axis.to) json["to"] = *axis.to;
  return json;
}

/// A curve of a function of x is thinned; one that turns back would lose its way.
nlohmann::json ToJson(const Curve& curve, std::size_t most) {
  nlohmann::json json = {{"label", curve.label}, {"style", ToString(curve.style)}, {"shown", curve.shown}};
  const bool marks = curve.style == Curve::Style::kPoints || curve.style == Curve::Style::kSamples;
  const bool rises = std::is_sorted(curve.x.begin(), curve.x.end());
  const auto [x, y] = Thin(curve.x, curve.y, rises && !marks ? most : curve.x.size());
  json["x"] = Pack(x);
  json["y"] = Pack(y);
  return json;
}

nlohmann::json ToJson(const Picture& picture, std::size_t most) {
  nlohmann::json json = {{"key", picture.key},
                         {"x", ToJson(picture.x)},
                         {"y", ToJson(picture.y)},
                         {"course", picture.course},
                         {"curves", nlohmann::json::array()},
                         {"areas", nlohmann::json::array()},
                         {"marks", nlohmann::json::array()}};
  for (const Curve& curve : picture.curves) json["curves"].push_back(ToJson(curve, most));
  for (const Area& area : picture.areas) {
    json["areas"].push_back({{"label", area.label}, {"x", Pack(area.x)}, {"y", Pack(area.y)}});
  }
  for (const Mark& mark : picture.marks) {
    json["marks"].push_back({{"at", mark.at}, {"label", mark.label}, {"horizontal", mark.horizontal}});
  }
  return json;
}

}  // namespace

std::string Escape(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string ScriptData(const nlohmann::json& document) {
  // Only strings can hold these characters, and inside strings JSON has another way to write them.
  const std::string text = JsonText(document);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<' || c == '>' || c == '&') {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out;
}

std::string Anchor(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    out += plain ? std::string(1, c) : fmt::format(".{:02x}", static_cast<unsigned char>(c));
  }
  return out;
}

std::string Row(std::span<const Cell> cells) {
  std::string row = "<tr>";
  for (const Cell& cell : cells) {
    row += cell.css.empty() ? "<td>" : fmt::format("<td class=\"{}\">", cell.css);
    row += cell.html + "</td>";
  }
  return row + "</tr>\n";
}

std::string Table(std::span<const Cell> header, const std::string& rows) {
  std::string head;
  for (const Cell& cell : header)
    head += fmt::format("<th scope=\"col\" class=\"{}\">{}</th>", cell.css, Escape(cell.html));
  return fmt::format(
      "<div class=\"table\" tabindex=\"0\"><table><thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n", head,
      rows);
}

std::string Figures(const std::string& id, const std::vector<Picture>& pictures, std::size_t most_samples) {
  std::size_t curves = 0;
  for (const Picture& picture : pictures) curves += picture.curves.size();
  const std::size_t most = std::max<std::size_t>(2000, most_samples / std::max<std::size_t>(1, curves));
  nlohmann::json data = nlohmann::json::array();
  std::string html = "<div class=\"pictures\">\n";
  for (const Picture& picture : pictures) {
    const std::string note =
        picture.note.empty() ? "" : fmt::format("<span class=\"note\">{}</span>", Escape(picture.note));
    html += fmt::format(
        "<figure><figcaption>{}{}</figcaption><div class=\"plot\" data-set=\"{}\" data-picture=\"{}\" tabindex=\"0\" "
        "role=\"img\" aria-label=\"{}\"></div></figure>\n",
        Escape(picture.title), note, id, data.size(), Escape(picture.title));
    data.push_back(ToJson(picture, most));
  }
  return html + fmt::format("</div>\n<script type=\"application/json\" class=\"data\" id=\"{}\">{}</script>\n", id,
                            ScriptData(data));
}

bool HasPlotLibrary() { return !assets::kUPlotJs.empty(); }

std::string BuildLine() {
  const trace::Provenance build = BuildProvenance();
  return fmt::format("dynoproof {}, {}, {}", build.Text("version").value_or(""), build.Text("commit").value_or(""),
                     build.Text("compiler").value_or(""));
}

std::string Page(const std::string& title, const std::string& lead, const std::string& provenance,
                 const std::string& body) {
  const std::map<std::string, std::string, std::less<>> parts = {
      {"title", Escape(title)},
      {"lead", lead},
      {"provenance", Escape(provenance)},
      {"body", body},
      {"style", std::string(assets::kUPlotCss) + std::string(assets::kPageCss)},
      {"licence", HasPlotLibrary() ? "uPlot: " + std::string(assets::kUPlotLicence) : "drawn without a library"},
      {"uplot", std::string(assets::kUPlotJs)},
      {"script", std::string(assets::kDrawingJs) + std::string(assets::kPageJs)}};
  // One pass: what is put in is not searched for further places.
  std::string page;
  std::string_view rest = assets::kPageHtml;
  for (std::size_t at; (at = rest.find("{{")) != std::string_view::npos;) {
    const std::size_t end = rest.find("}}", at);
    page += rest.substr(0, at);
    page += parts.find(rest.substr(at + 2, end - at - 2))->second;
    rest.remove_prefix(end + 2);
  }
  return page += rest;
}

}  // namespace dynoproof::reports
