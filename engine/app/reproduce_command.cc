// dynoproof reproduce
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "experiment/atlas.h"
#include "experiment/golden.h"
#include "experiment/ledger.h"
#include "reports/atlas_page.h"
#include "reports/run_report.h"

namespace dynoproof::app {
namespace {

std::string Row(const ClaimResult& result) {
  const Claim& claim = result.claim;
  const std::string unit = claim.unit == "1" ? "" : claim.unit;
  std::string ours = "-", deviation = "-", published = "-";
  if (claim.expect != "not_checkable") published = fmt::format("{:.6g}", claim.published);
  if (result.ours) {
    ours = fmt::format("{:.6g}", result.ours->value);
    deviation = fmt::format("{:+.3g}", result.ours->value - claim.published);
  }
  std::string row = fmt::format("{:<30} {:>11} {:>11} {:>10} {:<9} {:<14} {}\n", claim.id, published, ours, deviation,
                                unit, result.fault.empty() ? ToString(result.standing) : "fault", claim.place);
  if (!result.fault.empty()) row += "  fault: " + result.fault + "\n";
  if (!result.as_expected && result.fault.empty()) row += fmt::format("  the ledger expects: {}\n", claim.expect);
  return row;
}

nlohmann::json ToJson(const ClaimResult& result) {
  const Claim& claim = result.claim;
  return {{"id", claim.id},
          {"place", claim.place},
          {"claim", claim.claim},
          {"published", claim.expect == "not_checkable" ? nlohmann::json() : reports::Number(claim.published)},
          {"ours", result.ours ? reports::Number(result.ours->value) : nlohmann::json()},
          {"deviation", result.ours ? reports::Number(result.ours->value - claim.published) : nlohmann::json()},
          {"tolerance", claim.tolerance},
          {"origin", claim.origin},
          {"unit", claim.unit},
          {"verdict", result.fault.empty() ? ToString(result.standing) : "fault"},
          {"as_expected", result.as_expected},
          {"explanation", result.fault.empty() ? claim.explanation : result.fault}};
}

int Run(const Common& common, const std::string& which, const std::string& html) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(common, diagnostics);
  const std::string file = (std::filesystem::path(GoldenFolder()) / "published.toml").string();
  const std::vector<Claim> claims = ReadLedger(file, diagnostics);
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
  if (!html.empty()) {
    figures = ReadFigures((std::filesystem::path(GoldenFolder()) / "figures.toml").string(), diagnostics);
    std::erase_if(figures, [&](const AtlasFigure& figure) {
      return which != "all" && std::none_of(chosen.begin(), chosen.end(),
                                            [&](const Claim* claim) { return Names(claim->place, figure.number); });
    });
  }
  if (Report(diagnostics) != kGood) return kUsage;
  if (!CanWrite({html, common.json})) return kBroken;

  std::vector<ClaimResult> results;
  std::string text = fmt::format("{:<30} {:>11} {:>11} {:>10} {:<9} {:<14} {}\n", "claim", "published", "ours",
                                 "deviation", "unit", "verdict", "place");
  text += std::string(120, '-') + "\n";
  nlohmann::json document = {{"claims", nlohmann::json::array()}};
  int exit = kGood, counts[3] = {}, faults = 0, unexpected = 0;
  for (const Claim* claim : chosen) {
    ShowProgress(claim->id, static_cast<double>(document["claims"].size()) / static_cast<double>(chosen.size()));
    const ClaimResult& result = results.emplace_back(Reproduce(*registry, *claim));
    if (result.fault.empty()) ++counts[static_cast<int>(result.standing)];
    faults += result.fault.empty() ? 0 : 1;
    unexpected += result.fault.empty() && !result.as_expected ? 1 : 0;
    if (!result.as_expected) exit = kShort;
    text += Row(result);
    const bool tell = chosen.size() == 1 || result.standing == Standing::kContradicted;
    if (tell) text += fmt::format("  {}\n", claim->claim);
    if (tell && !claim->explanation.empty()) text += fmt::format("  {}\n", claim->explanation);
    document["claims"].push_back(ToJson(result));
  }
  ClearProgress();
  text += fmt::format(
      "\n{} reproduced, {} contradicted, {} not checkable; {} otherwise than the ledger expects, {} faults\n",
      counts[0], counts[1], counts[2], unexpected, faults);
  Print(common, text);
  if (!html.empty()) {
    const std::vector<DrawnFigure> drawn = Draw(*registry, figures, ShowProgress);
    ClearProgress();
    for (const DrawnFigure& one : drawn) {
      if (one.fault.empty()) continue;
      Complain(fmt::format("Fig. {}: {}\n", one.figure.number, one.fault));
      exit = reports::WorseExit(exit, kShort);
    }
    exit = reports::WorseExit(exit, WriteHtml(html, reports::AtlasPage(results, drawn)));
  }
  document["exit"] = exit;
  return reports::WorseExit(exit, WriteJson(common, document));
}

}  // namespace

void AddReproduce(CLI::App& program, int& exit) {
  struct Arguments {
    Common common;
    std::string which = "all", html;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      program.add_subcommand("reproduce", "the claims of the thesis: published, ours, deviation, verdict");
  command->add_option("claim", arguments->which, "a claim's id, or all");
  command->add_option("--html", arguments->html, "write the atlas: claims and figures in one page without a network");
  AddCommon(*command, arguments->common);
  AddExamples(*command,
              "  dynoproof reproduce all\n  dynoproof reproduce all --html out/atlas.html\n  dynoproof reproduce "
              "B.1-numeric --json -");
  command->callback([arguments, &exit] { exit = Run(arguments->common, arguments->which, arguments->html); });
}

}  // namespace dynoproof::app
