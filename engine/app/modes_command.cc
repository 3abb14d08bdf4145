// dynoproof modes
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/one_scenario.h"
#include "experiment/analysis.h"
#include "experiment/prepare.h"
#include "reports/modes_page.h"
#include "reports/run_report.h"
#include "scenario/load.h"

namespace dynoproof::app {
namespace {

nlohmann::json ToJson(const std::string& id, const LinearAnalysis& analysis) {
  nlohmann::json document = {{"id", id},
                             {"modes", nlohmann::json::array()},
                             {"practical_resonances", nlohmann::json::array()},
                             {"zeros", nlohmann::json::array()},
                             {"notes", analysis.notes}};
  for (const mechanics::Mode& mode : analysis.modal.modes) {
    nlohmann::json one = {{"frequency_hz", mode.frequency_hz},
                          {"damping_ratio", mode.damping_ratio},
                          {"shape", nlohmann::json::object()},
                          {"energy", nlohmann::json::object()}};
    for (int i = 0; i < analysis.network->size(); ++i) one["shape"][analysis.network->nodes[i].name] = mode.shape[i];
    for (const auto& [element, share] : EnergyByElement(*analysis.network, mode)) one["energy"][element] = share;
    document["modes"].push_back(std::move(one));
  }
  for (const mechanics::Resonance& resonance : analysis.resonances) {
    document["practical_resonances"].push_back(
        {{"frequency_hz", resonance.frequency_hz},
         {"gain", resonance.unbounded ? nlohmann::json() : nlohmann::json(resonance.gain)}});
  }
  for (const mechanics::Zero& zero : analysis.zeros.zeros) {
    document["zeros"].push_back({{"frequency_hz", zero.frequency_hz}, {"damping_ratio", zero.damping_ratio}});
  }
  if (!analysis.no_zeros.empty()) document["notes"].push_back("no zeros: " + analysis.no_zeros);
  return document;
}

/// As five digits show it: what they round to 0 has no sign.
double Shown(double damping_ratio) { return std::abs(damping_ratio) < 0.5e-5 ? 0.0 : damping_ratio; }

std::string ToText(const LinearAnalysis& analysis, const AnalysisSettings& settings) {
  std::string text = fmt::format("{:>4}  {:>12}  {:>10}  energy\n", "mode", "frequency Hz", "damping");
  int number = 0, hidden = 0;
  for (const mechanics::Mode& mode : analysis.modal.modes) {
    ++number;
    if (mode.frequency_hz > settings.to_Hz) {
      ++hidden;
      continue;
    }
    std::vector<std::pair<std::string, double>> shares = EnergyByElement(*analysis.network, mode);
    std::stable_sort(shares.begin(), shares.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    std::string energy;
    for (std::size_t i = 0; i < std::min<std::size_t>(4, shares.size()); ++i) {
      if (shares[i].second >= 0.01) energy += fmt::format("{} {:.0f} %  ", shares[i].first, 100.0 * shares[i].second);
    }
    text += fmt::format("{:>4}  {:>12.3f}  {:>10.5f}  {}\n", number - 1, mode.frequency_hz, Shown(mode.damping_ratio),
                        energy);
  }
  if (hidden > 0) text += fmt::format("      {} more above {:g} Hz (--json has them all)\n", hidden, settings.to_Hz);
  text += fmt::format("\npractical resonances from {} to {}, {:g} to {:g} Hz\n", settings.input, settings.output,
                      settings.from_Hz, settings.to_Hz);
  for (const mechanics::Resonance& one : analysis.resonances) {
    text += fmt::format("      {:>12.3f}  gain {}\n", one.frequency_hz,
                        one.unbounded ? "unbounded (undamped)" : fmt::format("{:.4g}", one.gain));
  }
  text += "\nzeros\n";
  if (!analysis.no_zeros.empty()) text += fmt::format("      none: {}\n", analysis.no_zeros);
  for (const mechanics::Zero& one : analysis.zeros.zeros) {
    if (!one.oscillatory || one.frequency_hz > settings.to_Hz) continue;
    text += fmt::format("      {:>12.3f}  damping {:.5f}\n", one.frequency_hz, Shown(one.damping_ratio));
  }
  for (const std::string& note : analysis.notes) text += fmt::format("\nnote: {}\n", note);
  return text;
}

int Run(const Common& common, const std::string& name, const std::vector<std::string>& overrides,
        const std::string& html) {
  if (!CanWrite({html, common.json})) return kBroken;
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(common, diagnostics);
  const std::optional<std::string> file = OneScenario(name, diagnostics);
  std::unique_ptr<Prepared> prepared;
  if (file) prepared = Prepare(*file, {overrides, "", nullptr}, *registry, diagnostics);
  std::optional<AnalysisSettings> settings;
  if (prepared != nullptr) {
    settings = ReadAnalysis(prepared->plan, *prepared->rig, diagnostics);
    if (!settings && !diagnostics.has_errors()) {
      diagnostics.Error({*file}, "the scenario has no section [analysis]",
                        "add [analysis] with input = ... and output = ...");
    }
  }
  if (Report(diagnostics) != kGood) return kUsage;
  const Result<LinearAnalysis> analysis = Analyse(*prepared->rig, *settings);
  if (!analysis.ok()) {
    Complain(analysis.failure().ToString() + "\n");
    return analysis.failure().exit_code;
  }
  Print(common, fmt::format("{}\n\n", prepared->plan.id) + ToText(*analysis, *settings));
  KeepJson(ToJson(prepared->plan.id, *analysis));
  return html.empty() ? kGood : WriteHtml(html, reports::ModesPage(*prepared, *settings, *analysis));
}

}  // namespace

void AddModes(Command program) {
  struct Arguments {
    Common common;
    std::string name, html;
    std::vector<std::string> overrides;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = program.Subcommand("modes", "eigenfrequencies, damping, energies, practical resonances, zeros");
  command.Value("scenario", arguments->name, "id or file").Required();
  command.Value("--set", arguments->overrides, "KEY=VALUE: override any key by its dotted path").OneWord();
  command.Value("--html", arguments->html, "write the page: response, shapes, energies, poles and zeros").NamesFile();
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof modes r2r/soft_rotor_setup_1 --html out/modes.html\n"
      "  dynoproof modes heavy_duty/alternative_setup_1 --set plant.inertia.I5=0.33 --json -");
  command.Runs([arguments] { return Run(arguments->common, arguments->name, arguments->overrides, arguments->html); });
}

}  // namespace dynoproof::app
