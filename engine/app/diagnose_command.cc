// dynoproof diagnose
#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/interruption.h"
#include "app/measured.h"
#include "diagnosis/data_check.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/look.h"
#include "diagnosis/report.h"
#include "reports/diagnosis_page.h"
#include "reports/run_report.h"

namespace dynoproof::app {
namespace {

struct DiagnoseArguments {
  Common common;
  std::string scenario, method, out = "out", html;
  std::vector<std::string> data, maps, holdout, overrides;
  double most_simulations = diagnosis::DiagnoseOptions().most_simulations;
  double most_cpu_s = 0.0;
  bool strict = false, resume = false, explain = false;
};

int Diagnose(const DiagnoseArguments& arguments) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  std::optional<MeasuredCase> measured = LoadMeasured(arguments.scenario, arguments.data, arguments.maps,
                                                      arguments.holdout, arguments.overrides, *registry, diagnostics);
  if (Report(diagnostics) != kGood || !measured) return kUsage;
  for (const auto* records : {&measured->data, &measured->holdout}) {
    for (const MappedRecord& record : *records) {
      if (!record.outputs.empty()) continue;
      Complain(fmt::format("{}: no output of the scenario is in it: nothing to compare\n", record.file));
      return kUndecided;
    }
  }
  Diagnostics faults;
  // A fault of the record would be explained as one of the machine: it stops here.
  for (const auto* records : {&measured->data, &measured->holdout}) {
    for (const MappedRecord& record : *records) {
      const Result<std::vector<diagnosis::Finding>> findings =
          diagnosis::CheckAgainst(diagnosis::EstimationProblem(measured->plan, {record}, *registry));
      if (!findings.ok()) {
        Complain(findings.failure().ToString() + "\n");
        return findings.failure().exit_code;
      }
      for (const diagnosis::Finding& finding : *findings) {
        if (finding.fault) faults.Error({record.file}, finding.column + ": " + finding.text, "dynoproof check-data");
      }
    }
  }
  if (Report(faults) != kGood) return kUsage;
  std::vector<std::string> of_records;
  for (auto* records : {&measured->data, &measured->holdout}) {
    if (std::string note = diagnosis::KeepTo(diagnosis::kMostSamples, *records); !note.empty())
      of_records.push_back(std::move(note));
    for (const MappedRecord& record : *records) {
      for (const std::string& note : record.notes) of_records.push_back(fmt::format("{}: {}", record.file, note));
    }
  }
  for (const std::string& note : of_records) Note(note + "\n");
  std::error_code error;
  std::filesystem::create_directories(arguments.out, error);
  diagnosis::DiagnoseOptions options;
  options.out = arguments.out;
  options.scenario_file = measured->file;
  options.overrides = arguments.overrides;
  options.resume = arguments.resume;
  options.most_simulations = arguments.most_simulations;
  if (arguments.most_cpu_s > 0.0) options.most_cpu_s = arguments.most_cpu_s;
  std::mutex screen;
  options.progress = [&screen](const std::string& what, double fraction) {
    const std::lock_guard<std::mutex> lock(screen);
    ShowProgress(what, fraction);
  };
  Result<diagnosis::Diagnosis> result = [&] {
    const Interruption interruption(arguments.common,
                                    [] { return "interrupted: --resume goes on from the fits that are saved\n"; });
    return diagnosis::Diagnose(measured->plan, measured->data, measured->holdout, *registry, options);
  }();
  ClearProgress();
  if (!result.ok()) {
    Complain(result.failure().ToString() + "\n");
    return result.failure().exit_code;
  }
  Print(arguments.common, diagnosis::ToTable(*result));
  if (arguments.explain) Print(arguments.common, diagnosis::ToText(result->journal));
  for (const std::string& note : result->notes) Note(note + "\n");
  result->notes.insert(result->notes.end(), of_records.begin(), of_records.end());
  const bool open =
      result->verdict != diagnosis::Conclusion::kEffectFound && result->verdict != diagnosis::Conclusion::kNoEffect;
  const int exit = arguments.strict && open ? kUndecided : kGood;
  int written = kGood;
  if (!arguments.html.empty()) {
    const Result<std::vector<Picture>> pictures = diagnosis::Look(measured->plan, measured->data, *result, *registry);
    if (!pictures.ok()) Complain(pictures.failure().ToString() + "\n");
    written = WriteHtml(arguments.html, reports::DiagnosisPage(measured->plan.id, arguments.data, *result,
                                                               pictures.ok() ? *pictures : std::vector<Picture>()));
    if (!pictures.ok()) written = kBroken;
  }
  nlohmann::json json = diagnosis::ToJson(*result);
  if (arguments.explain) json["journal"] = diagnosis::ToJson(result->journal);
  KeepJson(std::move(json));
  return reports::WorseExit(exit, written);
}

}  // namespace

void AddDiagnose(Command program) {
  auto arguments = std::make_shared<DiagnoseArguments>();
  Command command =
      program.Subcommand("diagnose", "name the cause of a difference between a scenario and measured data");
  command.Value("scenario", arguments->scenario, "id or file").Required();
  command.Value("--data", arguments->data, "record to explain (CSV, HDF5, MAT); may be given several times")
      .Required()
      .OneWord();
  command.Value("--map", arguments->maps, "which column is which signal; one for all records, or one each").OneWord();
  command.Value("--holdout", arguments->holdout, "record that takes no part in the choice (else: the last 30 %)")
      .OneWord();
  command.Value("--set", arguments->overrides, "KEY=VALUE: override any key by its dotted path").OneWord();
  command.Value("--out", arguments->out, "folder of extended.toml and the saved fits (default out)");
  command.Value("--html", arguments->html, "write a page that shows all of it").NamesFile();
  command.Flag("--strict", arguments->strict, "exit 4 for an ambiguous or unexplained verdict");
  command.Flag("--explain", arguments->explain, "say what was compared, by which rule and with which numbers");
  command
      .Value("--most-simulations", arguments->most_simulations,
             "simulations of all the data after which the search ends with the best it has (default 25000)")
      .Positive();
  command
      .Value("--most-cpu", arguments->most_cpu_s,
             "CPU seconds after which it does so, too (default: none, for the result then depends on the machine)")
      .Positive();
  // There is one method; scripts from when there were two name it.
  command.Value("--method", arguments->method).OneOf({"corrected"}).Hidden();
  command.Flag("--resume", arguments->resume, "go on from the fits saved in --out");
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof diagnose diagnose/heavy_duty_lumped --data record.csv\n"
      "  dynoproof diagnose diagnose/r2r_soft --data a.csv --data b.csv --holdout c.csv --map map.toml --out out/r2r\n"
      "  dynoproof diagnose my_line.toml --data record.csv --explain\n"
      "  dynoproof diagnose my_line.toml --data record.h5 --strict --json -\n"
      "  dynoproof diagnose my_line.toml --data record.csv --most-cpu 60\n"
      "Interrupted (Ctrl-C) it ends with 4; --resume goes on.\n");
  command.Runs([arguments] { return Diagnose(*arguments); });
}

}  // namespace dynoproof::app
