#include "thesis/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "base/text.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "thesis/studies.h"

namespace dynoproof {
namespace {

/// All that a row may name, by the key that names it.
using Known = std::map<std::string, std::vector<std::string>>;

Known WhatThereIs(const Registry& registry, const std::vector<AtlasFigure>& figures, const std::vector<Claim>& claims) {
  Known known;
  for (const AtlasFigure& figure : figures) known["figure"].push_back(figure.number);
  for (const Claim& claim : claims) known["claim"].push_back(claim.id);
  for (const auto& [name, study] : Studies()) known["study"].push_back(name);
  for (const PluginInfo* plugin : registry.Plugins()) known["plugin"].push_back(plugin->kind + "." + plugin->name);
  for (const Effect* effect : registry.Effects()) known["plugin"].push_back("effect." + effect->info().name);
  for (const CheckKind* check : registry.Checks()) known["plugin"].push_back("check." + check->name);
  return known;
}

bool Contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

/// Whether the row is one of the numbered figures of the thesis, with axes or without.
bool IsFigure(const CoverageRow& row) { return row.kind == "figure" || row.kind == "diagram"; }

/// The number of a figure, diagram or table, "5.19"; nothing for other rows.
std::string NumberOf(const CoverageRow& row) {
  const std::size_t space = row.name.find(' ');
  return (IsFigure(row) || row.kind == "table") && space != std::string::npos ? row.name.substr(space + 1) : "";
}

/// Whether the claim's place names the figure or table of the row.
bool IsAbout(const Claim& claim, const CoverageRow& row) {
  const std::string number = NumberOf(row);
  return !number.empty() && Contains(NumbersIn(claim.place, IsFigure(row) ? "Fig" : "Table"), number);
}

/// The figures of the thesis that one of the atlas draws: one, or several in one picture ("5.8 and 5.19").
std::vector<std::string> Drawn(const AtlasFigure& figure) { return NumbersIn("Figs. " + figure.number, "Fig"); }

/// What the row of a figure or table need not say: the figure of the atlas with its scenarios, and the claims about it.
void Complete(CoverageRow& row, const std::vector<AtlasFigure>& figures, const std::vector<Claim>& claims) {
  const auto add = [](std::vector<std::string>& list, const std::string& name) {
    if (!Contains(list, name)) list.push_back(name);
  };
  for (const AtlasFigure& figure : figures) {
    if (!IsFigure(row) || !Contains(Drawn(figure), NumberOf(row))) continue;
    add(row.figures, figure.number);
    for (const std::string& scenario : figure.scenarios) add(row.scenarios, scenario);
  }
  for (const Claim& claim : claims) {
    if (claim.expect != "not_checkable" && IsAbout(claim, row)) add(row.claims, claim.id);
  }
}

/// The rules of one row. Every fault stands where the row does.
class RowRules {
 public:
  RowRules(const CoverageRow& row, const Known& known, Diagnostics& diagnostics)
      : row_(row), known_(known), diagnostics_(diagnostics) {}

  void Check(const std::vector<AtlasFigure>& figures, const std::vector<Claim>& claims) {
    Exist("figure", row_.figures);
    Exist("claim", row_.claims);
    Exist("study", row_.studies);
    Exist("plugin", row_.plugins);
    for (const std::string& id : row_.scenarios) {
      if (!std::filesystem::exists(std::filesystem::path(ScenarioFolder()) / (id + ".toml")))
        Fault(fmt::format("names a scenario \"{}\" that does not exist", id), "see: dynoproof list");
    }
    const bool whole = row_.state == "whole", named = !row_.CoveredBy().empty();
    const bool nothing = row_.state == "missing" || row_.state == "not_given";
    if (whole != row_.reason.empty())
      Fault(whole ? "has a reason for being less than whole" : "does not say why it is not whole",
            whole ? "leave the reason out, or give it another state" : "add reason = \"...\"");
    if (nothing == named)
      Fault(nothing ? "names what covers it" : "names nothing that covers it",
            nothing ? "give it another state" : "add scenarios, claims, figures, studies or plugins");
    if (row_.kind == "figure" && !nothing && row_.figures.empty())
      Fault("is not drawn", "add it to the atlas (figures.toml), or make it a diagram where it has no axes");
    // What a row rests on bounds what it may be called.
    for (const Claim& claim : claims) {
      const bool against = claim.expect == "contradicted" || claim.expect == "not_checkable";
      if (against && (whole || row_.state == "assumed") && (Contains(row_.claims, claim.id) || IsAbout(claim, row_)))
        Fault(fmt::format("rests on claim \"{}\", which is {}", claim.id, claim.expect), "state = \"partial\"");
    }
    for (const AtlasFigure& figure : figures) {
      if (whole && Contains(row_.figures, figure.number) && !figure.missing.empty())
        Fault(fmt::format("rests on figure {}, of which something is missing", figure.number), "state = \"partial\"");
    }
  }

 private:
  void Fault(const std::string& what, const std::string& hint) {
    diagnostics_.Error(row_.where, fmt::format("row \"{}\" ({}) {}", row_.name, row_.state, what), hint);
  }

  void Exist(const std::string& kind, const std::vector<std::string>& names) {
    const auto list = known_.find(kind);
    for (const std::string& name : names) {
      if (list != known_.end() && Contains(list->second, name)) continue;
      const std::optional<std::string> near = list != known_.end() ? Closest(name, list->second) : std::nullopt;
      Fault(fmt::format("names a {} \"{}\" that does not exist", kind, name),
            near ? fmt::format("did you mean \"{}\"?", *near) : "");
    }
  }

  const CoverageRow& row_;
  const Known& known_;
  Diagnostics& diagnostics_;
};

}  // namespace

std::string CoverageRow::CoveredBy() const {
  std::string text;
  const auto add = [&text](const char* one, const char* many, const std::vector<std::string>& names) {
    if (names.empty()) return;
    text += fmt::format("{}{} {}", text.empty() ? "" : "; ", names.size() == 1 ? one : many, fmt::join(names, ", "));
  };
  add("scenario", "scenarios", scenarios);
  add("claim", "claims", claims);
  add("figure", "figures", figures);
  add("study", "studies", studies);
  add("plugin", "plugins", plugins);
  return text;
}

std::vector<CoverageRow> ReadCoverage(const std::string& file, const Registry& registry,
                                      const std::vector<AtlasFigure>& figures, const std::vector<Claim>& claims,
                                      Diagnostics& diagnostics) {
  std::vector<CoverageRow> rows;
  const std::optional<Plan> plan = LoadPlan(file, {}, diagnostics);
  const Value* tables = plan ? plan->root.Find("row") : nullptr;
  if (tables == nullptr || !tables->is_array()) {
    if (plan) diagnostics.Error({file}, "there is no [[row]]");
    return rows;
  }
  const Known known = WhatThereIs(registry, figures, claims);
  std::set<std::string> names;
  for (const Value& table : tables->array()) {
    CoverageRow row;
    row.where = table.where();
    if (!ReadParams(table, row, diagnostics, "row")) continue;
    if (!names.insert(row.name).second)
      diagnostics.Error(row.where, fmt::format("a second row \"{}\"", row.name), "rename one, or make one of both");
    Complete(row, figures, claims);
    RowRules(row, known, diagnostics).Check(figures, claims);
    rows.push_back(std::move(row));
  }
  const auto must_have = [&](const std::string& name, const std::string& who) {
    if (!names.contains(name))
      diagnostics.Error({file}, fmt::format("there is no row \"{}\", which {} is about", name, who), "add a [[row]]");
  };
  for (const AtlasFigure& figure : figures) {
    for (const std::string& number : Drawn(figure))
      must_have("Fig. " + number, "figure " + figure.number + " of the atlas");
  }
  for (const Claim& claim : claims) {
    const std::string who = fmt::format("claim \"{}\"", claim.id);
    for (const std::string& number : NumbersIn(claim.place, "Fig")) must_have("Fig. " + number, who);
    for (const std::string& number : NumbersIn(claim.place, "Table")) must_have("Table " + number, who);
  }
  return rows;
}

std::vector<int> CountStates(const std::vector<CoverageRow>& rows, const std::string& kind) {
  const std::vector<std::string> states = CoverageRow::States();
  std::vector<int> counts(states.size(), 0);
  for (const CoverageRow& row : rows) {
    if (!kind.empty() && row.kind != kind) continue;
    const auto state = std::find(states.begin(), states.end(), row.state);
    if (state != states.end()) ++counts[static_cast<std::size_t>(state - states.begin())];
  }
  return counts;
}

}  // namespace dynoproof
