// dynoproof check-data
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/measured.h"
#include "base/text.h"
#include "diagnosis/data_check.h"
#include "diagnosis/prospects.h"
#include "estimation/horizon.h"
#include "identification/suspects.h"
#include "scenario/find.h"
#include "scenario/load.h"

namespace dynoproof::app {
namespace {

struct CheckArguments {
  Common common;
  std::string data, map, scenario;
  bool candidates = false;
};

/// Columns that a map or the scenario asks for, by name; all of them where neither does.
std::vector<std::string> Used(const CheckArguments& arguments, const trace::Record& record, const RecordMap& map) {
  if (!map.file.empty()) return map.Columns();
  if (arguments.scenario.empty()) return record.Names();
  Diagnostics ignored;  // reported where the scenario is loaded
  std::vector<std::string> names;
  for (const std::string& file : FindScenarios(arguments.scenario, ignored)) {
    const std::optional<Plan> plan = LoadPlan(file, {}, ignored);
    for (const char* section : {"input", "output"}) {
      const Value* table = plan ? plan->root.Find(section) : nullptr;
      if (table == nullptr || !table->is_table()) continue;
      for (const std::string& name : KeysOf(*table)) names.push_back(name);
    }
  }
  return names;
}

/// Whether a map answers what a finding asks: which clock, in which unit.
bool ToldByMap(const diagnosis::Finding& finding, const RecordMap& map) {
  if (finding.kind == "unit") return !map.clock.unit.empty() && map.clock.column == finding.column;
  const auto has_clock = [](const ChannelMap& channel) { return channel.clock.given(); };
  return finding.kind == "no_time" && !map.file.empty() &&
         (map.clock.given() ||
          (std::ranges::all_of(map.inputs, has_clock) && std::ranges::all_of(map.outputs, has_clock)));
}

/// A map alone: its columns, units and clocks, without a scenario that would say what they are.
void CheckMap(const trace::Record& record, const RecordMap& map, Diagnostics& diagnostics) {
  std::vector<SignalName> inputs, outputs;
  for (const ChannelMap& channel : map.inputs) inputs.push_back({channel.name, channel.unit});
  for (const ChannelMap& channel : map.outputs) outputs.push_back({channel.name, channel.unit});
  const std::optional<MappedRecord> mapped = MapRecord(record, map, inputs, outputs, diagnostics);
  if (!mapped) return;
  for (const std::string& note : mapped->notes) Note(note + "\n");
}

/// Adds the readings of the record (signs, units, columns) under which the simulation comes near it, where it is far off as it is.
/// Findings of the corrected run replace those of the free run on single signals.
void AddSuspects(const diagnosis::EstimationProblem& problem, std::vector<diagnosis::Finding>& findings) {
  const std::vector<identification::Suspect> misread =
      identification::MisreadingsOf(problem.plan(), problem.records().front(), problem.registry());
  if (!misread.empty()) {
    std::erase_if(findings, [](const diagnosis::Finding& f) {
      return f.fault && (f.kind == "sign" || f.kind == "unit" || f.kind == "swapped");
    });
    std::string all;
    for (const identification::Suspect& one : misread) all += (all.empty() ? "" : ", or ") + one.text;
    const identification::Suspect& first = misread.front();
    findings.push_back(
        {true, first.kind, first.column,
         fmt::format("the model would be near the record, {:.2g} off it (NRMSE, corrected with a short memory), "
                     "if that were read otherwise: {}; a map says units, signs and columns",
                     first.nrmse, all),
         0, 0.0, first.nrmse});
    return;
  }
  if (std::ranges::any_of(findings, &diagnosis::Finding::fault)) return;
  const Result<std::vector<identification::Suspect>> suspects =
      identification::SuspectsOf(problem, problem.PlanOf(problem.Nominal()));
  if (!suspects.ok()) return;
  for (const identification::Suspect& one : *suspects) {
    if (!identification::AccountsFor(one.nrmse)) continue;
    findings.push_back({one.certain, "suspect", "",
                        fmt::format("with {} the record would be {:.3g} off the simulation (NRMSE): a map says units, "
                                    "signs and columns",
                                    one.text, one.nrmse),
                        0, 0.0, one.nrmse});
  }
}

/// What a comparison with a scenario's simulation has told beside its findings.
struct Beside {
  bool compared = false;
  std::optional<estimation::Horizon> horizon;
  std::optional<diagnosis::Prospects> prospects;
};

/// How far ahead the scenario predicts and, where it is asked for and the record has no fault, which candidate would help.
Status LookAhead(const CheckArguments& arguments, const MeasuredCase& measured, const Registry& registry, bool faulty,
                 Beside& beside) {
  Result<std::optional<estimation::Horizon>> ahead =
      estimation::HorizonOf(measured.plan, measured.data.front(), registry);
  if (!ahead.ok()) return ahead.failure();
  beside.horizon = *std::move(ahead);
  if (!beside.horizon)
    Note("how far ahead the scenario predicts is not told: no output moves, or the record is too short\n");
  if (!arguments.candidates || faulty) return {};
  Result<diagnosis::Prospects> found = diagnosis::ProspectsOf(measured.plan, measured.data, registry);
  if (!found.ok()) return found.failure();
  beside.prospects = *std::move(found);
  return {};
}

Status CompareWithScenario(const CheckArguments& arguments, const Registry& registry,
                           std::vector<diagnosis::Finding>& findings, Diagnostics& diagnostics, Beside& beside) {
  const std::vector<std::string> maps =
      arguments.map.empty() ? std::vector<std::string>{} : std::vector<std::string>{arguments.map};
  Diagnostics loading;
  std::optional<MeasuredCase> measured =
      LoadMeasured(arguments.scenario, {arguments.data}, maps, {}, {}, registry, loading);
  // A used column with cells that are no numbers is told by the finding, with all others.
  const bool told = !measured && std::any_of(findings.begin(), findings.end(), [](const diagnosis::Finding& f) {
    return f.fault && f.kind == "not_finite";
  });
  if (!told) diagnostics.Append(loading);
  if (!measured) return {};
  StartAt(BeginAsRecorded(measured->plan, registry, measured->data.front()), measured->plan);
  for (const std::string& note : measured->data.front().notes) Note(note + "\n");
  // The mapper has spoken of cells without a number.
  std::erase_if(findings, [](const diagnosis::Finding& f) { return f.kind == "not_finite"; });
  const diagnosis::EstimationProblem problem(measured->plan, measured->data, registry);
  for (const auto& check : {diagnosis::CheckAgainst, diagnosis::DistancesOf}) {
    const Result<std::vector<diagnosis::Finding>> against = check(problem);
    if (!against.ok()) return against.failure();
    findings.insert(findings.end(), against->begin(), against->end());
  }
  beside.compared = !measured->data.front().outputs.empty();
  if (!beside.compared) return {};
  AddSuspects(problem, findings);
  return LookAhead(arguments, *measured, registry, std::ranges::any_of(findings, &diagnosis::Finding::fault), beside);
}

int CheckData(const CheckArguments& arguments) {
  Diagnostics diagnostics;
  if (arguments.candidates && arguments.scenario.empty()) {
    Complain("--candidates asks what a scenario lacks: name it with --scenario\n");
    return kUsage;
  }
  const std::optional<RecordMap> map = ReadRecordMap(arguments.map, diagnostics);
  if (!map) return Report(diagnostics);
  const Result<trace::Record> record = ReadRecord(arguments.data, *map);
  if (!record.ok()) {
    Complain(record.failure().ToString() + "\n");
    return kUsage;
  }
  std::vector<diagnosis::Finding> findings = diagnosis::CheckRecord(*record);
  std::erase_if(findings, [&](const diagnosis::Finding& f) { return ToldByMap(f, *map); });
  // What nobody uses is worth a note at most; stamps are used by all.
  const std::vector<std::string> used = Used(arguments, *record, *map);
  for (diagnosis::Finding& finding : findings) {
    const std::optional<std::size_t> index = record->Find(finding.column);
    const bool time = index && std::any_of(record->columns.begin(), record->columns.end(),
                                           [&](const trace::Column& column) { return column.time == index; });
    if (!time && std::find(used.begin(), used.end(), finding.column) == used.end()) finding.fault = false;
  }
  if (arguments.scenario.empty() && arguments.map.empty()) {
    for (const std::string& note : record->notes) Note(note + "\n");
  } else if (arguments.scenario.empty()) {
    CheckMap(*record, *map, diagnostics);
  }
  // Stamps that fall and columns that are too short cannot be simulated with: the record's own faults come first. A map
  // may allow for cells that are missing.
  const bool usable = std::none_of(findings.begin(), findings.end(), [](const diagnosis::Finding& f) {
    return f.fault && (f.kind == "not_rising" || f.kind == "short");
  });
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  Beside beside;
  if (!arguments.scenario.empty() && usable) {
    const Status failed = CompareWithScenario(arguments, *registry, findings, diagnostics, beside);
    if (failed) {
      Complain(failed->ToString() + "\n");
      return failed->exit_code;
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
  if (beside.horizon && faults == 0) text += beside.horizon->ToText() + "\n";
  if (beside.prospects) text += beside.prospects->ToTable() + "\n";
  if (beside.horizon && faults > 0) text += "\nWhat the model gets wrong can be told when the faults are mended.\n\n";
  text += fmt::format("{}: {}, {}, {}{}\n", arguments.data, Counted(record->columns.size(), "column"),
                      Counted(static_cast<std::size_t>(faults), "fault"),
                      Counted(findings.size() - static_cast<std::size_t>(faults), "note"),
                      arguments.scenario.empty() ? ""
                      : beside.compared          ? ", compared with the simulation"
                                                 : ", nothing compared");
  Print(arguments.common, text);
  const int exit = faults > 0 ? kUsage : !arguments.scenario.empty() && !beside.compared ? kUndecided : kGood;
  nlohmann::json json = {{"findings", std::move(list)}};
  if (beside.horizon) AddTo(json, *beside.horizon);
  if (beside.prospects) AddTo(json, *beside.prospects);
  KeepJson(std::move(json));
  return exit;
}

}  // namespace

void AddCheckData(Command program) {
  auto arguments = std::make_shared<CheckArguments>();
  Command command = program.Subcommand("check-data", "find the faults of a record before it is compared");
  command.Value("record", arguments->data, "CSV, HDF5 or MAT file").Required();
  command.Value("--map", arguments->map, "which column is which signal (TOML)");
  command.Value("--scenario", arguments->scenario, "check units, signs, delays and columns against its simulation");
  command.Flag("--candidates", arguments->candidates,
               "tell which effect at which place would remove how much of what the scenario gets wrong");
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof check-data record.csv\n"
      "  dynoproof check-data record.csv --map map.toml --scenario diagnose/r2r_soft\n"
      "  dynoproof check-data record.csv --scenario diagnose/r2r_soft --candidates\n"
      "With --scenario it says how far each output is off the simulation, in its own spread (NRMSE), and how "
      "far ahead the\n"
      "scenario predicts it: in runs that the record corrects, by a memory from a few samples on, and in a free run.");
  command.Runs([arguments] { return CheckData(*arguments); });
}

}  // namespace dynoproof::app
