// dynoproof coupling
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/one_scenario.h"
#include "experiment/prepare.h"
#include "scenario/load.h"
#include "thesis/commands/commands.h"
#include "thesis/coupling.h"

namespace dynoproof::app {
namespace {

struct Arguments {
  Common common;
  std::string name, shaft = "coupling", data;
  std::vector<std::string> overrides;
  double static_stiffness = 0.0;
};

nlohmann::json Number(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); }
std::string Cell(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:>9.{}f}", value, digits) : fmt::format("{:>9}", "-");
}

int Run(const Arguments& arguments) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  const std::optional<std::string> file = OneScenario(arguments.name, diagnostics);
  std::unique_ptr<Prepared> prepared;
  if (file) prepared = Prepare(*file, {arguments.overrides, "", nullptr}, *registry, diagnostics);
  const Value* shaft = prepared != nullptr ? prepared->plan.root.FindPath("plant.shaft." + arguments.shaft) : nullptr;
  if (prepared != nullptr && shaft == nullptr)
    diagnostics.Error({*file}, fmt::format("there is no shaft \"{}\"", arguments.shaft), "--shaft NAME");
  if (Report(diagnostics) != kGood) return kUsage;
  const auto fail = [](const Failure& failure) {
    Complain(failure.ToString() + "\n");
    return failure.exit_code;
  };

  mechanics::CouplingTable table;
  std::optional<mechanics::OilCouplingFit> fit;
  if (!arguments.data.empty()) {
    Result<mechanics::CouplingTable> read = ReadCouplingTable(arguments.data);
    if (!read.ok()) return fail(read.failure());
    table = std::move(*read);
    const Result<mechanics::OilCouplingFit> fitted = FitOilCoupling(table);
    if (!fitted.ok()) return fail(fitted.failure());
    fit = *fitted;
  } else {
    for (int i = 0; i <= 12; ++i) table.nu.push_back(50.0 * i);
    table.stiffness.assign(table.nu.size(), std::numeric_limits<double>::quiet_NaN());
    table.damping = table.stiffness;
  }
  const auto own = [&](double nu) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    return SteadyValues(*shaft, nu).value_or(mechanics::DynamicValues{none, none});
  };
  double k_0 = arguments.static_stiffness;
  if (k_0 == 0.0) k_0 = fit ? At(table, 0.0).stiffness : own(0.0).stiffness;
  if (!(k_0 > 0.0)) {
    Complain("the coupling's static stiffness is not known: give --static-stiffness or --data\n");
    return kUsage;
  }
  const Result<CouplingChoice> choice =
      ChooseCouplingMode(*prepared->rig->FindBlock("plant")->component->network(), arguments.shaft, k_0);
  if (!choice.ok()) return fail(choice.failure());
  const mechanics::DynamicValues chosen = fit ? At(table, choice->nu_0) : own(choice->nu_0);

  std::string text = fmt::format(
      "{}, shaft {}\n\nchoice of a Kelvin-Voigt model (thesis Sec. 4.2), static stiffness {:.4g} N m/rad\n"
      "  nu_0 {:.2f} rad/s   k_KV {:.5g} N m/rad   c_KV {:.4g} N m s/rad   (k, c of {})\n\n"
      "  {:>12}  coupling's share of all twists\n",
      prepared->plan.id, arguments.shaft, k_0, choice->nu_0, chosen.stiffness, chosen.damping,
      fit ? "the data sheet" : "the scenario's law", "mode rad/s");
  nlohmann::json document = {{"id", prepared->plan.id},          {"shaft", arguments.shaft},
                             {"static_stiffness", k_0},          {"nu_0", choice->nu_0},
                             {"k_KV", Number(chosen.stiffness)}, {"c_KV", Number(chosen.damping)},
                             {"modes", nlohmann::json::array()}, {"curves", nlohmann::json::array()}};
  for (std::size_t i = 0; i < choice->modes.size(); ++i) {
    const CouplingMode& mode = choice->modes[i];
    document["modes"].push_back({{"nu", mode.nu_rad_per_s}, {"share", mode.share}});
    if (i < 6) text += fmt::format("  {:>12.2f}  {:.4f}\n", mode.nu_rad_per_s, mode.share);
  }
  if (fit) {
    const char* names[] = {"k_s", "K", "kappa_p"};
    const char* units[] = {"N m/rad", "N m/rad", "1/s"};
    const double values[] = {fit->k_s, fit->oil_stiffness, fit->kappa_p};
    text += fmt::format("\noil model (4.20) fitted to {}: residuals {:.1f} % RMS\n", arguments.data, 100.0 * fit->rms);
    document["fit"] = {{"rms", fit->rms}};
    for (int i = 0; i < 3; ++i) {
      text += fmt::format("  {:<8} {:>10.5g} +- {:.2g} {}\n", names[i], values[i], fit->interval[i], units[i]);
      document["fit"][names[i]] = {{"value", values[i]},
                                   {"unit", units[i]},
                                   {"ci95", {values[i] - fit->interval[i], values[i] + fit->interval[i]}}};
    }
  }
  text += fmt::format("\n{:>9} | k kNm/rad {:>25} | c Nms/rad\n{:>9}", "nu rad/s", "", "");
  for (int i = 0; i < 2; ++i) text += fmt::format(" | {:>9} {:>9} {:>9} {:>8}", "sheet", "scenario", "fitted", "off %");
  text += "\n";
  for (std::size_t i = 0; i < table.nu.size(); ++i) {
    const double nu = table.nu[i], none = std::numeric_limits<double>::quiet_NaN();
    const mechanics::DynamicValues law = own(nu);
    const mechanics::DynamicValues fitted =
        fit ? mechanics::OilCoupling{fit->k_s, 1.0, fit->kappa_p, fit->oil_stiffness}.At(nu)
            : mechanics::DynamicValues{none, none};
    const double off_k = fit ? fit->stiffness_residual[i] : none, off_c = fit ? fit->damping_residual[i] : none;
    text += fmt::format("{:>9.1f} | {} {} {} {} | {} {} {} {}\n", nu, Cell(1e-3 * table.stiffness[i], 2),
                        Cell(1e-3 * law.stiffness, 2), Cell(1e-3 * fitted.stiffness, 2), Cell(100 * off_k, 1).substr(1),
                        Cell(table.damping[i], 1), Cell(law.damping, 1), Cell(fitted.damping, 1),
                        Cell(100 * off_c, 1).substr(1));
    document["curves"].push_back({{"nu", nu},
                                  {"sheet", {{"k", Number(table.stiffness[i])}, {"c", Number(table.damping[i])}}},
                                  {"scenario", {{"k", Number(law.stiffness)}, {"c", Number(law.damping)}}},
                                  {"fitted", {{"k", Number(fitted.stiffness)}, {"c", Number(fitted.damping)}}},
                                  {"residual", {{"k", Number(off_k)}, {"c", Number(off_c)}}}});
  }
  Print(arguments.common, text);
  KeepJson(std::move(document));
  return kGood;
}

}  // namespace

void AddCoupling(Command program) {
  auto arguments = std::make_shared<Arguments>();
  Command command = program.Subcommand(
      "coupling", "hydrodynamic coupling: choice of k_KV and c_KV, k(nu) and c(nu), fit to a data sheet");
  command.Value("scenario", arguments->name, "id or file of a drive line").Required();
  command.Value("--shaft", arguments->shaft, "name of the coupling's shaft").ShowsDefault();
  command.Value("--data", arguments->data, "data sheet: CSV with columns nu, k, c and a row of units");
  command.Value("--static-stiffness", arguments->static_stiffness, "k(0) [N m/rad] for the choice").Positive();
  command.Value("--set", arguments->overrides, "KEY=VALUE: override any key by its dotted path").OneWord();
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof coupling coupling/startup_oil --static-stiffness 94e3\n"
      "  dynoproof coupling coupling/startup_oil --data scenarios/coupling/assumed_data_sheet.csv");
  command.Runs([arguments] { return Run(*arguments); });
}

}  // namespace dynoproof::app
