#include "reports/probe_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "probe/report.h"
#include "reports/html.h"

namespace dynoproof::reports {
namespace {

using probe::Finding;
using probe::State;

/// From what is seen at a hundredth of what is usual to what passes at any strength.
const char* HeatOf(const Finding& one) {
  if (one.state == State::kNoTrace || one.state == State::kRefused) return "heat none";
  if (one.state == State::kUnseen) return "heat h4";
  if (!one.sized) return "heat h0";
  return one.size > 1.0 ? "heat h3" : one.size > 0.3 ? "heat h2" : one.size > 0.03 ? "heat h1" : "heat h0";
}

std::string Short(const Finding& one) {
  if (one.state == State::kRefused) return "–";
  if (one.state == State::kNoTrace) return "no trace";
  if (!one.sized) return one.state == State::kUnseen ? "passes" : "seen";
  return (one.state == State::kUnseen ? "> " : "") + probe::StrengthText(std::abs(one.strength), one.unit);
}

/// Effects over places. Of an effect with two directions the one that passes further stands for both.
std::string Map(const std::vector<Finding>& findings) {
  std::vector<std::string> places, names;
  std::map<std::pair<std::string, std::string>, const Finding*> worst;
  for (const Finding& one : findings) {
    if (!one.sized && one.place.find(':') == std::string::npos) continue;  // numbers have a table of their own
    if (std::ranges::count(places, one.place) == 0) places.push_back(one.place);
    if (std::ranges::count(names, one.name) == 0) names.push_back(one.name);
    const Finding*& known = worst[{one.place, one.name}];
    if (known == nullptr || one.size > known->size) known = &one;
  }
  std::ranges::sort(places);
  std::ranges::sort(names);
  std::vector<Cell> head = {{"place"}};
  for (const std::string& name : names) head.push_back({Escape(name), "turned"});
  std::string rows;
  for (const std::string& place : places) {
    std::vector<Cell> cells = {{Escape(place), "key"}};
    for (const std::string& name : names) {
      const auto found = worst.find({place, name});
      cells.push_back(found == worst.end() ? Cell{""} : Cell{Escape(Short(*found->second)), HeatOf(*found->second)});
    }
    rows += Row(cells);
  }
  return Table(head, rows);
}

std::string AllFindings(const std::vector<Finding>& findings) {
  std::string rows;
  for (const Finding& one : findings) {
    rows +=
        Row(std::vector<Cell>{{Escape(one.name)},
                              {Escape(one.place), "key"},
                              {Escape(probe::PassesText(one)), HeatOf(one)},
                              {one.sized ? Escape(probe::StrengthText(one.usual, one.unit)) : "", "number"},
                              {std::isfinite(one.moves) ? fmt::format("{:.2g} %", 100.0 * one.moves) : "", "number"},
                              {Escape(one.by)}});
  }
  return Table(
      std::vector<Cell>{
          {"change"}, {"place"}, {"what passes"}, {"usual", "number"}, {"moves outputs by", "number"}, {"seen by"}},
      rows);
}

}  // namespace

std::string ProbePage(const std::string& id, const probe::Probed& probed) {
  std::string lead =
      Escape(probe::Sentence(probed)) + ". Asked: " + Escape(fmt::format("{}", fmt::join(probed.asked, ", ")));
  if (!probed.skipped.empty()) lead += "; not asked: " + Escape(fmt::format("{}", fmt::join(probed.skipped, ", ")));
  const std::string body =
      "<section id=\"map\"><h2>What passes, by place</h2>\n<p class=\"note\">Each cell: the strength up to which no "
      "check fails. "
      "<span class=\"heat h0\">seen at a thirtieth of what is usual</span> <span class=\"heat h1\">at a third</span> "
      "<span class=\"heat h2\">just before</span> <span class=\"heat h3\">passes although usual</span> "
      "<span class=\"heat h4\">passes at any strength</span></p>\n" +
      Map(probed.findings) + "</section>\n<section id=\"findings\"><h2>Every change</h2>\n" +
      AllFindings(probed.findings) + "</section>\n";
  const auto holes = std::ranges::count_if(probed.findings, &Finding::IsHole);
  return Page(fmt::format("probe of {}: {}", id,
                          holes == 0 ? std::string("no usual error would pass")
                                     : fmt::format("{} usual errors would pass", holes)),
              lead, BuildLine(), body);
}

}  // namespace dynoproof::reports
