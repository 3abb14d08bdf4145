// dynoproof identify
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/measured.h"
#include "diagnosis/identify.h"

namespace dynoproof::app {
namespace {

struct IdentifyArguments {
  Common common;
  std::string scenario;
  std::vector<std::string> data, maps, overrides, free;
  int starts = 4;
};

int Identify(const IdentifyArguments& arguments) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  const std::optional<MeasuredCase> measured =
      LoadMeasured(arguments.scenario, arguments.data, arguments.maps, {}, arguments.overrides, *registry, diagnostics);
  if (Report(diagnostics) != kGood || !measured) return kUsage;
  for (const std::string& key : arguments.free) {
    const Value* value = measured->plan.root.FindPath(key);
    if (value == nullptr || !value->is_number())
      diagnostics.Error({"--free"}, fmt::format("\"{}\" is no number of the scenario", key),
                        "a dotted path such as plant.inertia.I5");
    else if (value->number() == 0.0)
      diagnostics.Error({"--free"}, fmt::format("\"{}\" is 0: it gives no magnitude to search around", key),
                        fmt::format("--set {}=VALUE", key));
  }
  if (Report(diagnostics) != kGood) return kUsage;
  for (const MappedRecord& record : measured->data) {
    if (!record.outputs.empty()) continue;
    Complain(fmt::format("{}: no output of the scenario is in it: nothing to compare\n", record.file));
    return kUndecided;
  }
  const Result<diagnosis::Identified> result =
      diagnosis::Identify(measured->plan, measured->data, *registry, arguments.free, arguments.starts,
                          [](double done) { ShowProgress("fitting", done); });
  ClearProgress();
  if (!result.ok()) {
    Complain(result.failure().ToString() + "\n");
    return result.failure().exit_code;
  }
  Print(arguments.common, diagnosis::ToTable(*result));
  nlohmann::json document = diagnosis::ToJson(*result);
  const int exit = result->converged == 0 ? kUndecided : kGood;
  document["exit"] = exit;
  const int written = WriteJson(arguments.common, document);
  return written == kGood ? exit : written;
}

}  // namespace

void AddIdentify(CLI::App& program, int& exit) {
  auto arguments = std::make_shared<IdentifyArguments>();
  CLI::App* command = program.add_subcommand("identify", "fit numbers of a scenario to records, by the free-run error");
  command->add_option("scenario", arguments->scenario, "id or file")->required();
  command->add_option("--data", arguments->data, "record (CSV, HDF5, MAT); may be given several times")
      ->required()
      ->allow_extra_args(false);
  command->add_option("--map", arguments->maps, "which column is which signal; one for all, or one each")
      ->allow_extra_args(false);
  command->add_option("--free", arguments->free, "KEY,...: dotted paths of the numbers to fit")
      ->required()
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--set", arguments->overrides, "KEY=VALUE: override any key by its dotted path")
      ->allow_extra_args(false);
  command->add_option("--starts", arguments->starts, "points to start from")->check(CLI::Range(1, 100));
  AddCommon(*command, arguments->common);
  AddExamples(*command,
              "  dynoproof identify diagnose/r2r_soft --data record.csv --free "
              "plant.inertia.I5,plant.shaft.k4.stiffness_Nm_per_rad");
  command->callback([arguments, &exit] { exit = Identify(*arguments); });
}

}  // namespace dynoproof::app
