#include "app/reduce_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/interruption.h"
#include "app/measured.h"
#include "app/one_scenario.h"
#include "app/scratch.h"
#include "base/text.h"
#include "base/within.h"
#include "diagnosis/data_check.h"
#include "experiment/run_scenario.h"
#include "identification/bring_in.h"
#include "reduce/cut.h"
#include "reduce/symptom.h"
#include "scenario/load.h"
#include "score/series.h"
#include "trace/csv_write.h"

namespace dynoproof::app {
namespace {

namespace fs = std::filesystem;
using reduce::Symptom;

/// Rows [first, last) of every column.
trace::Record RowsOf(const trace::Record& record, std::size_t first, std::size_t last) {
  trace::Record part = record;
  part.non_finite.clear();
  for (trace::Column& column : part.columns) {
    const auto begin = column.values.begin();
    column.values = {begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last)};
  }
  trace::FinishRecord(part);
  return part;
}

/// What `run --data` and `check-data` say of a record: what falls short, by name, and the spread of each output.
struct Judged {
  std::vector<Symptom> shown;
  std::map<std::string, double> spread;  // by the name of the check that compares it
};

class Judge {
 public:
  Judge(std::string file, const RecordReduction& arguments, RecordMap map, const Registry& registry)
      : file_(std::move(file)), arguments_(arguments), map_(std::move(map)), registry_(registry) {
    map_.first = 0;
    map_.last = static_cast<std::size_t>(-1);
  }

  /// Faults of the record alone first, as "clipping T_shaft". A record that cannot be mapped says nothing more; `diagnostics` say why.
  Judged Of(const trace::Record& record, Diagnostics& diagnostics) const {
    Judged judged;
    std::vector<Symptom>& shown = judged.shown;
    for (const diagnosis::Finding& finding : diagnosis::CheckRecord(record)) Add(finding, shown);
    PrepareOptions options;
    options.overrides = arguments_.overrides;
    std::unique_ptr<Prepared> prepared = Prepare(file_, options, registry_, diagnostics);
    if (prepared == nullptr) return judged;
    std::optional<MappedRecord> data =
        MapRecord(record, map_, InputNames(*prepared->rig), OutputNames(*prepared->rig), diagnostics);
    if (!data || !identification::BringIn(prepared->plan, registry_, *data, diagnostics)) return judged;
    options.data = &*data;
    options.start = BeginAsRecorded(prepared->plan, registry_, *data);
    prepared = Prepare(file_, options, registry_, diagnostics);
    if (prepared == nullptr) return judged;
    const diagnosis::EstimationProblem problem(prepared->plan, {*data}, registry_);
    if (const auto findings = diagnosis::CheckAgainst(problem); findings.ok()) {
      for (const diagnosis::Finding& finding : *findings) Add(finding, shown);
    }
    for (const auto& [name, series] : data->outputs)
      judged.spread["record " + name] = score::StandardDeviation(*series.values);
    const ScenarioResult result = RunScenario(*prepared, {.out = "", .data = &*data});
    if (!result.broken.empty()) shown.push_back({.words = reduce::WithoutNumbers(result.broken)});
    for (const score::Check& check : result.checks) {
      if (check.verdict == score::Verdict::kFail) shown.push_back(reduce::SymptomOf(check));
    }
    return judged;
  }

 private:
  static void Add(const diagnosis::Finding& finding, std::vector<Symptom>& shown) {
    if (!finding.fault) return;
    Symptom one{.name = finding.kind + " " + finding.column};
    one.check.name = one.name;
    one.check.explanation = finding.text;
    shown.push_back(std::move(one));
  }

  std::string file_;
  const RecordReduction& arguments_;
  RecordMap map_;
  const Registry& registry_;
};

std::string NameOf(const Symptom& one) { return one.name.empty() ? "run" : one.check.name; }

/// The symptom of the name, or kind of fault, that was asked for; without one the worst failed check, or the first fault where none failed.
const Symptom* Chosen(const std::vector<Symptom>& shown, const std::string& asked) {
  const Symptom* chosen = nullptr;
  for (const Symptom& one : shown) {
    const std::string name = NameOf(one);
    if (!asked.empty() && name != asked && !name.starts_with(asked + " ")) continue;
    if (chosen == nullptr || (one.number && (!chosen->number || one.share > chosen->share))) chosen = &one;
  }
  return chosen;
}

std::string Said(const Symptom& one) {
  return one.number ? fmt::format("{}: {:.3g}, limit {:.3g}", NameOf(one), one.check.value, one.check.limit)
                    : fmt::format("{}: {}", NameOf(one), one.check.explanation);
}

/// Columns as the reader tells name and unit apart again.
std::vector<trace::Column> AsWritten(const trace::Record& record) {
  std::vector<trace::Column> columns = record.columns;
  for (trace::Column& column : columns) {
    if (column.heading.empty()) continue;
    column.name = column.heading;
    column.unit.clear();
  }
  return columns;
}

/// From the first stamp to the last, in their own unit; NaN where the record has none.
double SpanOf(const trace::Record& record) {
  if (!record.time || record.columns[*record.time].values.size() < 2) return std::nan("");
  const std::vector<double>& stamps = record.columns[*record.time].values;
  return stamps.back() - stamps.front();
}

int Fault(const std::string& text, int exit) {
  ClearProgress();
  Complain(text + "\n");
  return exit;
}

}  // namespace

int ReduceRecord(const RecordReduction& arguments, const Common& common) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(common, diagnostics);
  const std::optional<std::string> file = OneScenario(arguments.scenario, diagnostics);
  const std::optional<RecordMap> map = ReadRecordMap(arguments.map, diagnostics);
  if (Report(diagnostics) != kGood || !file || !map) return kUsage;
  if (!CanWrite({arguments.out, common.json})) return kBroken;
  std::error_code error;
  if (fs::equivalent(arguments.out, arguments.data, error))
    return Fault(arguments.out + ": is the record itself; --out names another file", kUsage);
  Result<trace::Record> read = ReadRecord(arguments.data, *map);
  if (!read.ok()) return Fault(read.failure().ToString(), kUsage);
  const std::size_t rows = read->columns.empty() ? 0 : read->columns.front().values.size();
  if (std::ranges::any_of(read->columns, [&](const trace::Column& column) { return column.values.size() != rows; }))
    return Fault(
        arguments.data + ": its columns have several lengths; a cut has one: `dynoproof export` writes one raster",
        kUsage);
  const std::size_t begin = std::min(map->first, rows);
  const trace::Record whole = RowsOf(*read, begin, std::min(map->last, rows));
  const std::size_t length = std::min(map->last, rows) - begin;
  const Interruption interruption(common, [] { return std::string("nothing was written"); });

  const Judge judge(*file, arguments, *map, *registry);
  const Judged judged = judge.Of(whole, diagnostics);
  const std::vector<Symptom>& shown = judged.shown;
  const Symptom* chosen = Chosen(shown, arguments.check);
  if (shown.empty() && Report(diagnostics) != kGood) return kUsage;
  if (chosen == nullptr) {
    std::vector<std::string> names;
    for (const Symptom& one : shown) names.push_back(NameOf(one));
    return Fault(names.empty() ? "the record fails no check and has no fault: there is nothing to reduce"
                               : fmt::format("nothing that fails is called \"{}\"; these do: {}", arguments.check,
                                             fmt::join(names, ", ")),
                 kShort);
  }
  std::optional<Symptom> last;
  const auto shows = [&](const trace::Record& record) {
    Diagnostics refused;
    const Judged part = judge.Of(record, refused);
    for (const Symptom& one : part.shown) {
      if (!chosen->Same(one)) continue;
      // A stretch at rest has little spread, beside which noise is large: the misfit must be one beside the whole record, too.
      const auto of = judged.spread.find(one.check.name), here = part.spread.find(one.check.name);
      if (one.number && of != judged.spread.end() && here != part.spread.end() &&
          Within(one.check.value * here->second, one.check.limit * of->second))
        continue;
      last = one;
      return true;
    }
    return false;
  };
  int runs = 1;
  const reduce::Cut cut =
      reduce::ShortestCut(length, std::min(length, kFewestSamples), std::max(1, arguments.most_runs - 2),
                          [&](std::size_t first, std::size_t end) {
                            ++runs;
                            ShowProgress(fmt::format("run {}: rows {} to {}", runs, begin + first, begin + end),
                                         static_cast<double>(runs) / static_cast<double>(arguments.most_runs));
                            return shows(RowsOf(whole, first, end));
                          });
  ClearProgress();
  const trace::Record left = RowsOf(whole, cut.first, cut.last);

  // As it will be read: a file may lose what the reader guessed of the whole one.
  const Scratch scratch("cut");
  if (!scratch.ok()) return kBroken;
  const std::string tried = (scratch.folder() / "cut.csv").string();
  const std::vector<trace::Column> columns = AsWritten(left);
  if (const Status failed = trace::WriteCsv(tried, columns)) return Fault(failed->ToString(), failed->exit_code);
  ++runs;
  const Result<trace::Record> again = ReadRecord(tried, *map);
  if (!again.ok() || !shows(*again))
    return Fault("what is left no longer shows it once it is a file of its own; nothing was written", kBroken);
  if (const Status failed = trace::WriteCsv(arguments.out, columns))
    return Fault(failed->ToString(), failed->exit_code);

  const double span = SpanOf(whole), now = SpanOf(left);
  std::string command =
      fmt::format("dynoproof run {} --data {}", ShellQuoted(arguments.scenario), ShellQuoted(arguments.out));
  if (!arguments.map.empty()) command += " --map " + ShellQuoted(arguments.map);
  for (const std::string& one : arguments.overrides) command += " --set " + ShellQuoted(one);
  Print(common,
        fmt::format(
            "{}: rows {} to {} of {} ({:.3g} of {:.3g} of its time) still show \"{}\"\n  before  {}\n  now     {}\n\n"
            "{} runs{}; {}\n",
            arguments.data, begin + cut.first, begin + cut.last, rows, now, span, NameOf(*chosen), Said(*chosen),
            Said(*last), runs, cut.complete ? "" : ", and more would cut more off: --most-runs", command));
  if (map->first != 0 || map->last < rows)
    Note(arguments.map + " takes a part of the record by \"rows\": that is done, leave it out for " + arguments.out +
         "\n");
  KeepJson({{"id", arguments.scenario},
            {"check", NameOf(*chosen)},
            {"record", arguments.out},
            {"rows", {{"before", length}, {"after", cut.last - cut.first}}},
            {"first_row", begin + cut.first},
            {"seconds", {{"before", span}, {"after", now}}},
            {"runs", runs},
            {"complete", cut.complete}});
  return kGood;
}

}  // namespace dynoproof::app
