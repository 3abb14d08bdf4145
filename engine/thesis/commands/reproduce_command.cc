// dynoproof reproduce
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiment/golden.h"
#include "reports/run_report.h"
#include "thesis/atlas.h"
#include "thesis/commands/atlas_page.h"
#include "thesis/commands/commands.h"
#include "thesis/coverage.h"
#include "thesis/ledger.h"

namespace dynoproof::app {
namespace {

std::string Cells(const std::string& id, const std::array<std::string, 5>& numbers, const std::string& unit,
                  const std::string& standing, const std::string& place) {
  const auto& [thesis, independent, ours, allowed, deviation] = numbers;
  return fmt::format("{:<26} {:>11} {:>11} {:>11} {:>15} {:>10} {:<9} {:<18} {}\n", id, thesis, independent, ours,
                     allowed, deviation, unit, standing, place);
}

std::string Short(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "-"; }

std::string Row(const ClaimResult& result) {
  const Claim& claim = result.claim;
  std::string ours = "-", deviation = "-";
  if (result.ours) {
    ours = fmt::format("{:.6g}", result.ours->value);
    if (std::isfinite(claim.Reference())) deviation = fmt::format("{:+.3g}", result.ours->value - claim.Reference());
  }
  const std::string allowed = AllowedText(claim);
  std::string row = Cells(
      claim.id, {Short(claim.thesis), Short(claim.independent), ours, allowed.empty() ? "-" : allowed, deviation},
      claim.unit == "1" ? "" : claim.unit, result.fault.empty() ? ToString(result.standing) : "fault", claim.place);
  if (!result.fault.empty()) row += "  fault: " + result.fault + "\n";
  if (!result.as_expected && result.fault.empty()) row += fmt::format("  the ledger expects: {}\n", claim.expect);
  return row;
}

/// The lines under a claim's row: its origin, assumptions and explanation.
std::string Words(const Claim& claim) {
  std::string text = fmt::format("  {}\n", claim.claim);
  if (!claim.origin.empty()) text += fmt::format("  allowed: {}\n", claim.origin);
  if (!claim.assumed.empty()) text += fmt::format("  assumed: {}\n", claim.assumed);
  if (!claim.explanation.empty()) text += fmt::format("  {}\n", claim.explanation);
  return text;
}

/// null for what is absent.
nlohmann::json OrNull(double value) { return std::isfinite(value) ? reports::Number(value) : nlohmann::json(); }

nlohmann::json ToJson(const ClaimResult& result) {
  const Claim& claim = result.claim;
  return {{"id", claim.id},
          {"place", claim.place},
          {"claim", claim.claim},
          {"thesis", OrNull(claim.thesis)},
          {"independent", OrNull(claim.independent)},
          {"ours", result.ours ? reports::Number(result.ours->value) : nlohmann::json()},
          {"allowed", OrNull(claim.allowed)},
          {"at_least", OrNull(claim.at_least)},
          {"at_most", OrNull(claim.at_most)},
          {"deviation", result.ours ? OrNull(result.ours->value - claim.Reference()) : nlohmann::json()},
          {"unit", claim.unit},
          {"origin", claim.origin},
          {"assumed", claim.assumed.empty() ? nlohmann::json() : nlohmann::json(claim.assumed)},
          {"standing", result.fault.empty() ? ToString(result.standing) : "fault"},
          {"expected", claim.expect},
          {"as_expected", result.as_expected},
          {"explanation", result.fault.empty() ? claim.explanation : result.fault}};
}

/// How many claims stand how, faults apart.
struct Summary {
  std::array<int, kStandings> counts = {};
  int faults = 0, unexpected = 0;

  void Add(const ClaimResult& result) {
    if (!result.fault.empty()) {
      ++faults;
      return;
    }
    ++counts[static_cast<std::size_t>(result.standing)];
    unexpected += result.as_expected ? 0 : 1;
  }
  std::string Text() const {
    std::string text;
    for (int i = 0; i < kStandings; ++i) {
      text += fmt::format("{}{} {}", i == 0 ? "" : ", ", counts[static_cast<std::size_t>(i)],
                          InWords(static_cast<Standing>(i)));
    }
    return fmt::format("{}; {} otherwise than the ledger expects, {} faults\n", text, unexpected, faults);
  }
  nlohmann::json Json() const {
    nlohmann::json json = {{"faults", faults}, {"otherwise_than_expected", unexpected}};
    for (int i = 0; i < kStandings; ++i) {
      json[ToString(static_cast<Standing>(i))] = counts[static_cast<std::size_t>(i)];
    }
    return json;
  }
};

std::string GoldenFile(const char* name) { return (std::filesystem::path(GoldenFolder()) / name).string(); }

/// `reproduce --coverage`: what of the thesis is here. Nothing is computed.
int RunCoverage(const Common& common) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(common, diagnostics);
  const std::vector<Claim> claims = ReadLedger(GoldenFile("published.toml"), diagnostics);
  const std::vector<AtlasFigure> figures = ReadFigures(GoldenFile("figures.toml"), diagnostics);
  const std::vector<CoverageRow> rows =
      ReadCoverage(GoldenFile("coverage.toml"), *registry, figures, claims, diagnostics);
  if (Report(diagnostics) != kGood) return kUsage;
  if (!CanWrite({common.json})) return kBroken;

  const std::vector<std::string> states = CoverageRow::States();
  std::string text = fmt::format("{:<12}{:<10}{:<38}{}\n{}\n", "kind", "state", "name",
                                 "what, why it is not whole, what covers it", std::string(140, '-'));
  nlohmann::json document = {{"rows", nlohmann::json::array()}, {"summary", nlohmann::json::object()}};
  for (const CoverageRow& row : rows) {
    text += fmt::format("{:<12}{:<10}{:<38}{}{}\n", row.kind, row.state, row.name, row.title,
                        row.place.empty() ? "" : "; " + row.place);
    if (!row.reason.empty()) text += fmt::format("{:60}{}\n", "", row.reason);
    if (!row.CoveredBy().empty()) text += fmt::format("{:60}{}\n", "", row.CoveredBy());
    document["rows"].push_back({{"name", row.name},
                                {"kind", row.kind},
                                {"place", row.place},
                                {"title", row.title},
                                {"state", row.state},
                                {"reason", row.reason.empty() ? nlohmann::json() : nlohmann::json(row.reason)},
                                {"scenarios", row.scenarios},
                                {"claims", row.claims},
                                {"figures", row.figures},
                                {"studies", row.studies},
                                {"plugins", row.plugins}});
  }
  text += "\n";
  std::vector<std::string> kinds = CoverageRow::Kinds();
  kinds.push_back("");
  for (const std::string& kind : kinds) {
    const std::vector<int> counts = CountStates(rows, kind);
    std::string line;
    for (std::size_t i = 0; i < states.size(); ++i) {
      line += fmt::format("{}{} {}", i == 0 ? "" : ", ", counts[i], states[i]);
      document["summary"][kind.empty() ? "all" : kind][states[i]] = counts[i];
    }
    text += fmt::format("{:<12}{}\n", kind.empty() ? "all" : kind, line);
  }
  Print(common, text);
  KeepJson(std::move(document));
  return kGood;
}

int Run(const Common& common, const std::string& which, const std::string& html) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(common, diagnostics);
  const std::vector<Claim> claims = ReadLedger(GoldenFile("published.toml"), diagnostics);
  std::vector<const Claim*> chosen;
  std::vector<std::string> ids;
  for (const Claim& claim : claims) {
    ids.push_back(claim.id);
    if (which == "all" || claim.id == which) chosen.push_back(&claim);
  }
  if (chosen.empty() && !diagnostics.has_errors()) {
    const std::optional<std::string> near = Closest(which, ids);
    diagnostics.Error({which}, "is no claim of the ledger",
                      near ? fmt::format("did you mean \"{}\"?", *near) : "see: dynoproof reproduce all");
  }
  std::vector<AtlasFigure> figures;
  std::vector<CoverageRow> coverage;
  if (!html.empty()) {
    figures = ReadFigures(GoldenFile("figures.toml"), diagnostics);
    coverage = ReadCoverage(GoldenFile("coverage.toml"), *registry, figures, claims, diagnostics);
    std::erase_if(coverage, [&](const CoverageRow& row) {
      return which != "all" && std::find(row.claims.begin(), row.claims.end(), which) == row.claims.end();
    });
    std::erase_if(figures, [&](const AtlasFigure& figure) {
      return which != "all" && std::none_of(chosen.begin(), chosen.end(),
                                            [&](const Claim* claim) { return Names(claim->place, figure.number); });
    });
    // A row leads to the figures of this page.
    for (CoverageRow& row : coverage) {
      std::erase_if(row.figures, [&](const std::string& number) {
        return std::ranges::none_of(figures, [&](const AtlasFigure& figure) { return figure.number == number; });
      });
    }
  }
  if (Report(diagnostics) != kGood) return kUsage;
  if (!CanWrite({html, common.json})) return kBroken;

  std::vector<ClaimResult> results;
  std::string text =
      Cells("claim", {"thesis says", "independent", "ours", "allowed", "deviation"}, "unit", "standing", "place");
  text += std::string(140, '-') + "\n";
  nlohmann::json document = {{"claims", nlohmann::json::array()}};
  int exit = kGood;
  Summary summary;
  for (const Claim* claim : chosen) {
    ShowProgress(claim->id, static_cast<double>(document["claims"].size()) / static_cast<double>(chosen.size()));
    const ClaimResult& result = results.emplace_back(Reproduce(*registry, *claim));
    summary.Add(result);
    if (!result.as_expected) exit = kShort;
    text += Row(result);
    const bool against = result.standing == Standing::kContradicted || result.standing == Standing::kMisprint;
    if (chosen.size() == 1 || against) text += Words(*claim);
    document["claims"].push_back(ToJson(result));
  }
  ClearProgress();
  text += "\n" + summary.Text();
  document["summary"] = summary.Json();
  Print(common, text);
  if (!html.empty()) {
    const std::vector<DrawnFigure> drawn = Draw(*registry, figures, ShowProgress);
    ClearProgress();
    for (const DrawnFigure& one : drawn) {
      if (one.fault.empty()) continue;
      Complain(fmt::format("Fig. {}: {}\n", one.figure.number, one.fault));
      exit = reports::WorseExit(exit, kShort);
    }
    exit = reports::WorseExit(exit, WriteHtml(html, reports::AtlasPage(results, drawn, coverage)));
  }
  KeepJson(std::move(document));
  return exit;
}

}  // namespace

void AddReproduce(Command program) {
  struct Arguments {
    Common common;
    std::string which = "all", html;
    bool coverage = false;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = program.Subcommand(
      "reproduce", "the claims of the thesis: what it says, an independent value, ours, what is allowed, standing");
  const Option claim = command.Value("claim", arguments->which, "a claim's id, or all");
  const Option html =
      command.Value("--html", arguments->html, "write the atlas: claims and figures in one page without a network")
          .NamesFile();
  command
      .Flag("--coverage", arguments->coverage,
            "what of the thesis is here: each model, algorithm, experiment, figure and table, and how far")
      .Excludes(claim)
      .Excludes(html);
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof reproduce all\n  dynoproof reproduce all --html out/atlas.html\n  dynoproof reproduce "
      "B.1-numeric --json -\n  dynoproof reproduce --coverage");
  command.Runs([arguments] {
    return arguments->coverage ? RunCoverage(arguments->common)
                               : Run(arguments->common, arguments->which, arguments->html);
  });
}

}  // namespace dynoproof::app
