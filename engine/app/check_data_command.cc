// dynoproof check-data
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/measured.h"
#include "diagnosis/data_check.h"

namespace dynoproof::app {
namespace {

struct CheckArguments {
  Common common;
  std::string data, map, scenario;
};

int CheckData(const CheckArguments& arguments) {
  const Result<trace::Record> record = ReadRecord(arguments.data);
  if (!record.ok()) {
    Complain(record.failure().ToString() + "\n");
    return kUsage;
  }
  std::vector<diagnosis::Finding> findings = diagnosis::CheckRecord(*record);
  if (arguments.scenario.empty()) {
    for (const std::string& note : record->notes) Note(note + "\n");
  }
  Diagnostics diagnostics;
  if (!arguments.map.empty() && arguments.scenario.empty())
    diagnostics.Error({"--map"}, "says which column is which signal of a scenario", "add --scenario ID");
  // What is no number or does not rise cannot be simulated with: the record's own faults come first.
  const bool usable = std::none_of(findings.begin(), findings.end(), [](const diagnosis::Finding& f) {
    return f.kind == "not_finite" || f.kind == "not_rising" || f.kind == "short";
  });
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  bool compared = false;
  if (!arguments.scenario.empty() && usable) {
    const std::vector<std::string> maps =
        arguments.map.empty() ? std::vector<std::string>{} : std::vector<std::string>{arguments.map};
    const std::optional<MeasuredCase> measured =
        LoadMeasured(arguments.scenario, {arguments.data}, maps, {}, {}, *registry, diagnostics);
    if (measured) {
      for (const std::string& note : measured->data.front().notes) Note(note + "\n");
      const diagnosis::EstimationProblem problem(measured->plan, measured->data, *registry);
      for (const auto& check : {diagnosis::CheckAgainst, diagnosis::DistancesOf}) {
        const Result<std::vector<diagnosis::Finding>> against = check(problem);
        if (!against.ok()) {
          Complain(against.failure().ToString() + "\n");
          return against.failure().exit_code;
        }
        findings.insert(findings.end(), against->begin(), against->end());
      }
      compared = !measured->data.front().outputs.empty();
    }
  }
  if (Report(diagnostics) != kGood) return kUsage;
  int faults = 0;
  nlohmann::json list = nlohmann::json::array();
  std::string text;
  for (const diagnosis::Finding& finding : findings) {
    faults += finding.fault ? 1 : 0;
    text += fmt::format("{:<8}{:<12} {:<14} {}\n", finding.fault ? "fault" : "note", finding.kind, finding.column,
                        finding.text);
    list.push_back({{"fault", finding.fault},
                    {"kind", finding.kind},
                    {"column", finding.column},
                    {"text", finding.text},
                    {"count", finding.count},
                    {"at_s", finding.at_s},
                    {"nrmse", finding.nrmse ? nlohmann::json(*finding.nrmse) : nlohmann::json()}});
  }
  text += fmt::format("{}: {} columns, {} faults, {} notes{}\n", arguments.data, record->columns.size(), faults,
                      findings.size() - static_cast<std::size_t>(faults),
                      arguments.scenario.empty() ? ""
                      : compared                 ? ", compared with the simulation"
                                                 : ", nothing compared");
  Print(arguments.common, text);
  const int exit = faults > 0 ? kUsage : !arguments.scenario.empty() && !compared ? kUndecided : kGood;
  KeepJson({{"findings", std::move(list)}});
  return exit;
}

}  // namespace

void AddCheckData(CLI::App& program, int& exit) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = program.add_subcommand("check-data", "find the faults of a record before it is compared");
  command->add_option("record", arguments->data, "CSV, HDF5 or MAT file")->required();
  command->add_option("--map", arguments->map, "which column is which signal (TOML)");
  command->add_option("--scenario", arguments->scenario,
                      "check units, signs, delays and columns against its simulation");
  AddCommon(*command, arguments->common);
  AddExamples(*command,
              "  dynoproof check-data record.csv\n"
              "  dynoproof check-data record.csv --map map.toml --scenario diagnose/r2r_soft\n"
              "With --scenario it says how far each output is off the simulation, in its own spread (NRMSE).");
  command->callback([arguments, &exit] { exit = CheckData(*arguments); });
}

}  // namespace dynoproof::app
