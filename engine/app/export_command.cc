// dynoproof export
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "app/app.h"
#include "app/one_scenario.h"
#include "base/text.h"
#include "experiment/records.h"
#include "fmu/unit.h"
#include "trace/csv_write.h"
#include "trace/mat_write.h"

namespace dynoproof::app {
namespace {

struct ExportArguments {
  Common common;
  std::string trace, to = "csv", out, fmu;
  std::vector<std::string> overrides;
  std::vector<std::string> signals;
  int every = 1;
};

/// Columns of one raster, its time first.
using Raster = std::vector<trace::Column>;

/// The columns asked for by raster, every n-th row; what is not there becomes a diagnostic.
std::vector<Raster> RastersOf(const trace::Record& record, const ExportArguments& arguments, Diagnostics& diagnostics) {
  for (const std::string& name : arguments.signals) {
    if (record.Find(name)) continue;
    const std::optional<std::string> near = Closest(name, record.Names());
    diagnostics.Error(
        {"--signals"}, fmt::format("{} has no signal \"{}\"", arguments.trace, name),
        near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("it has: {}", fmt::join(record.Names(), ", ")));
  }
  std::map<std::size_t, Raster> rasters;
  const auto thinned = [&](trace::Column column) {
    std::vector<double> kept;
    for (std::size_t i = 0; i < column.values.size(); i += static_cast<std::size_t>(arguments.every))
      kept.push_back(column.values[i]);
    column.values = std::move(kept);
    return column;
  };
  for (const trace::Column& column : record.columns) {
    const bool wanted = arguments.signals.empty() || std::find(arguments.signals.begin(), arguments.signals.end(),
                                                               column.name) != arguments.signals.end();
    if (!column.time || !wanted) continue;
    Raster& raster = rasters[*column.time];
    if (raster.empty()) raster.push_back(thinned(record.columns[*column.time]));
    raster.push_back(thinned(column));
  }
  std::vector<Raster> all;
  for (auto& [time, raster] : rasters) all.push_back(std::move(raster));
  if (all.empty() && !diagnostics.has_errors())
    diagnostics.Error({arguments.trace}, "has no signal with time stamps", "nothing to export");
  return all;
}

/// A scenario as a unit that other simulators step.
int ExportFmu(const ExportArguments& arguments) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  const std::optional<std::string> file = OneScenario(arguments.fmu, diagnostics);
  std::unique_ptr<Prepared> prepared;
  if (file) prepared = Prepare(*file, {arguments.overrides, "realtime"}, *registry, diagnostics);
  if (Report(diagnostics) != kGood) return kUsage;
  const Result<fmu::Fmu> unit = fmu::FmuOf(*prepared);
  if (!unit.ok()) {
    Complain(unit.failure().ToString() + "\n");
    return unit.failure().exit_code;
  }
  const std::string out = arguments.out.empty() ? unit->identifier + ".fmu" : arguments.out;
  if (const Status failed = fmu::Write(out, *unit, prepared->plan)) {
    Complain(failed->ToString() + "\n");
    return failed->exit_code;
  }
  std::string table =
      fmt::format("{}\n  FMI 2.0, co-simulation in steps of whole periods of {:g} s\n", out, unit->period_s);
  for (const auto& [kind, some] : {std::pair("inputs", &unit->inputs), std::pair("outputs", &unit->outputs),
                                   std::pair("parameters", &unit->parameters)}) {
    table += fmt::format("\n  {}\n", kind);
    for (const fmu::Variable& one : *some)
      table += fmt::format("    {:<40} {:>12.6g} {}\n", one.name, one.start, one.unit);
  }
  Print(arguments.common, table);
  KeepJson({{"files", {out}}});
  return kGood;
}

int Export(const ExportArguments& arguments) {
  if (arguments.trace.empty() == arguments.fmu.empty()) {
    Complain("dynoproof export: a trace or --fmu SCENARIO, one of both\n");
    return kUsage;
  }
  if (!arguments.fmu.empty()) return ExportFmu(arguments);
  const Result<trace::Record> record = ReadRecord(arguments.trace);
  if (!record.ok()) {
    Complain(record.failure().ToString() + "\n");
    return kUsage;
  }
  Diagnostics diagnostics;
  std::vector<Raster> rasters = RastersOf(*record, arguments, diagnostics);
  if (Report(diagnostics) != kGood) return kUsage;
  const std::filesystem::path out =
      arguments.out.empty() ? std::filesystem::path(arguments.trace).replace_extension("." + arguments.to).filename()
                            : std::filesystem::path(arguments.out);
  std::vector<std::string> files;
  Status failed;
  if (arguments.to == "mat") {
    std::vector<trace::Column> columns;
    for (Raster& raster : rasters) columns.insert(columns.end(), raster.begin(), raster.end());
    failed = trace::WriteMat(out, columns);
    files.push_back(out.string());
  }
  for (std::size_t r = 0; arguments.to == "csv" && r < rasters.size() && !failed; ++r) {
    // A table has one time: each raster is a file of its own.
    std::filesystem::path file = out;
    if (r > 0) file.replace_filename(fmt::format("{}_{}{}", out.stem().string(), r, out.extension().string()));
    rasters[r].front().name = "time";
    failed = trace::WriteCsv(file, rasters[r]);
    files.push_back(file.string());
    if (rasters.size() > 1 && !failed) {
      std::vector<std::string> names;
      for (const trace::Column& column : std::span(rasters[r]).subspan(1)) names.push_back(column.name);
      Note(fmt::format("{}: {} rows of {}\n", file.string(), rasters[r].front().values.size(), fmt::join(names, ", ")));
    }
  }
  if (failed) {
    Complain(failed->ToString() + "\n");
    return failed->exit_code;
  }
  if (arguments.every > 1)
    Note(fmt::format("every {}th row is kept as it is, without a filter: what was faster looks slower\n",
                     arguments.every));
  for (const std::string& file : files) Print(arguments.common, file + "\n");
  KeepJson({{"files", files}});
  return kGood;
}

}  // namespace

void AddExport(Command program) {
  auto arguments = std::make_shared<ExportArguments>();
  Command command = program.Subcommand("export", "a trace, record or scenario as a file that other tools open");
  command.Value("trace", arguments->trace, "HDF5, CSV or MAT file");
  command.Value("--to", arguments->to, "csv (a file a raster) or mat (version 4)").OneOf({"csv", "mat"});
  command.Value("--out", arguments->out, "file (default: the trace's or scenario's name, here)").NamesFile();
  const Option fmu = command.Value("--fmu", arguments->fmu,
                                   "a scenario, id or file, as a Functional Mock-up Unit (FMI 2.0, co-simulation)");
  command.Value("--set", arguments->overrides, "KEY=VALUE: of the unit's scenario").OneWord().Needs(fmu);
  command.Value("--signals", arguments->signals, "NAME,...: these only").SplitAtCommas().OneWord();
  command.Value("--every", arguments->every, "every n-th row").Within(1, 1000000);
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof export out/my_line.h5 --to csv\n"
      "  dynoproof export out/my_line.h5 --to mat --signals T_shaft,omega_1 --out bench.mat\n"
      "  dynoproof export out/my_line.h5 --to csv --every 10 --out at_1_kHz.csv\n"
      "  dynoproof export --fmu heavy_duty/soft_rotor_setup_1 --out line.fmu");
  command.Runs([arguments] { return Export(*arguments); });
}

}  // namespace dynoproof::app
