#include "experiment/records.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "base/text.h"
#include "base/units.h"
#include "model/params.h"
#include "scenario/load.h"
#include "trace/csv.h"
#include "trace/hdf5_record.h"
#include "trace/mat.h"

namespace dynoproof {
namespace {

/// [input.NAME] and [output.NAME] of a map file.
struct ColumnMap {
  std::string column, unit;
  double sign = 1.0;
  SourceSpan where;
  void Visit(auto& v) {
    v.Required("column", column, Any(), "name of the column");
    v.Optional("unit", unit, Any(), "unit of the column; that of the signal when not given");
    v.Optional("sign", sign, Between(-1.0, 1.0), "-1 turns the sign");
  }
  void Check(Faults& faults) const {
    if (std::abs(sign) != 1.0) faults.At("sign", "is 1 or -1");
  }
};

struct TimeMap {
  std::string column, unit = "s";
  double rate_hz = 0.0;
  void Visit(auto& v) {
    v.Optional("column", column, Any(), "name of the time column");
    v.Optional("unit", unit, Any(), "its unit");
    v.Optional("rate_hz", rate_hz, Positive("Hz"), "samples per second, when there is no time column");
  }
};

/// 2 pi where a column counts turns and the signal is in rad/s, else 1. "1/min" and "Hz" count turns; 1/s is the SI's
/// other name for rad/s.
double RadiansPerTurn(const std::string& written, const Unit& from, const Unit& to) {
  const std::array<int, 6> rate = {0, 0, -1, 0, 0, 0}, angular = {0, 0, -1, 0, 0, 1};
  const bool turns = from.exponents == rate && (from.factor != 1.0 || written.find("Hz") != std::string::npos);
  return turns && to.exponents == angular ? 2.0 * std::numbers::pi : 1.0;
}

class Mapper {
 public:
  Mapper(const trace::Record& record, Diagnostics& diagnostics) : record_(record), diagnostics_(diagnostics) {}

  std::optional<MappedRecord> Run(const std::string& map_file, const std::vector<SignalName>& inputs,
                                  const std::vector<SignalName>& outputs) {
    const int before = diagnostics_.error_count();
    result_.file = record_.source;
    result_.notes = record_.notes;
    Value map;
    if (!map_file.empty()) {
      const std::optional<Plan> plan = LoadPlan(map_file, {}, diagnostics_);
      if (!plan) return std::nullopt;
      map = plan->root;
      CheckMapKeys(map);
    }
    ReadTime(map);
    Take(map, "input", inputs, result_.inputs, map_file.empty());
    Take(map, "output", outputs, result_.outputs, map_file.empty());
    for (const SignalName& input : inputs) {
      if (result_.inputs.contains(input.name)) continue;
      result_.notes.push_back(
          fmt::format("the record does not drive the input \"{}\": it keeps the scenario's own source", input.name));
    }
    if (diagnostics_.error_count() == before && result_.inputs.empty() && result_.outputs.empty()) {
      std::vector<std::string> wanted;
      for (const auto* list : {&inputs, &outputs}) {
        for (const SignalName& name : *list) wanted.push_back(name.name);
      }
      diagnostics_.Error(
          {record_.source},
          fmt::format("no column is a signal of the scenario; columns: {}", fmt::join(record_.Names(), ", ")),
          fmt::format("the scenario has: {}; name them in a map file (--map)", fmt::join(wanted, ", ")));
    }
    if (diagnostics_.error_count() != before) return std::nullopt;
    return std::move(result_);
  }

 private:
  void CheckMapKeys(const Value& map) {
    const std::vector<std::string> known = {"time", "rows", "input", "output"};
    for (const Value::Entry& entry : map.table()) {
      if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
      const std::optional<std::string> near = Closest(entry.key, known);
      diagnostics_.Error(entry.where, fmt::format("unknown key \"{}\" in a map file", entry.key),
                         near ? fmt::format("did you mean \"{}\"?", *near) : "known: time, rows, input, output");
    }
    for (const char* section : {"input", "output"}) {
      const Value* tables = map.Find(section);
      if (tables == nullptr || tables->is_table()) continue;
      diagnostics_.Error(tables->where(), fmt::format("\"{}\" is {}", section, tables->KindName()),
                         fmt::format("write [{}.NAME]", section));
    }
    if (const Value* rows = map.Find("rows")) {
      const bool good = rows->is_array() && rows->array().size() == 2 && rows->array()[0].is_integer() &&
                        rows->array()[1].is_integer() && rows->array()[0].integer() >= 0 &&
                        rows->array()[0].integer() < rows->array()[1].integer();
      if (good) {
        first_ = static_cast<std::size_t>(rows->array()[0].integer());
        last_ = static_cast<std::size_t>(rows->array()[1].integer());
        rows_where_ = rows->where();
      } else {
        diagnostics_.Error(rows->where(), "\"rows\" is no range", "write rows = [first, end) with 0 <= first < end");
      }
    }
  }

  template <class T>
  std::shared_ptr<const std::vector<double>> Share(T values) {
    return std::make_shared<const std::vector<double>>(std::move(values));
  }

  /// The rows asked for of one column.
  std::vector<double> Rows(const std::vector<double>& values) const {
    const std::size_t begin = std::min(first_, values.size()), end = std::min(last_, values.size());
    return {values.begin() + static_cast<std::ptrdiff_t>(begin), values.begin() + static_cast<std::ptrdiff_t>(end)};
  }

  void ReadTime(const Value& map) {
    if (const Value* time = map.Find("time")) {
      if (!ReadParams(*time, time_, diagnostics_, "time")) return;
      if (time_.column.empty() == (time_.rate_hz == 0.0)) {
        diagnostics_.Error(time->where(), "\"time\" needs exactly one of column and rate_hz",
                           "time = { column = \"t\", unit = \"s\" }");
      }
      const std::optional<Unit> unit = ParseUnit(time_.unit);
      if (!unit || !SameQuantity(*unit, *ParseUnit("s"))) {
        diagnostics_.Error(time->where(), fmt::format("\"{}\" is no unit of time", time_.unit), "s, ms, min, ...");
      } else {
        time_factor_ = unit->factor;
      }
    }
  }

  /// The time stamps of a column in seconds, from 0; null with a diagnostic when there are none.
  std::shared_ptr<const std::vector<double>> TimeOf(const trace::Column& column) {
    if (time_.rate_hz > 0.0) {
      std::vector<double> time(Rows(column.values).size());
      for (std::size_t i = 0; i < time.size(); ++i) time[i] = static_cast<double>(i) / time_.rate_hz;
      return Share(std::move(time));
    }
    std::optional<std::size_t> index = time_.column.empty() ? column.time : record_.Find(time_.column);
    if (!index) {
      if (!time_fault_) {
        diagnostics_.Error({record_.source},
                           fmt::format("no time for column \"{}\": there is no column {}", column.name,
                                       time_.column.empty() ? "t or time" : time_.column),
                           "say time = { column = ... } or time = { rate_hz = ... } in a map file");
      }
      time_fault_ = true;
      return nullptr;
    }
    if (const auto known = times_.find(*index); known != times_.end()) return known->second;
    std::vector<double> time = Rows(record_.columns[*index].values);
    const double begin = time.empty() ? 0.0 : time.front();
    for (std::size_t i = 0; i < time.size(); ++i) {
      const bool rises = i == 0 || time[i] > time[i - 1];
      if (!std::isfinite(time[i]) || !rises) {
        diagnostics_.Error(
            {record_.source},
            fmt::format("time \"{}\" {} at row {} ({})", record_.columns[*index].name,
                        std::isfinite(time[i]) ? "does not rise" : "is not a number", first_ + i, time[i]),
            "time must rise from row to row");
        time.clear();
        break;
      }
    }
    for (double& value : time) value = (value - begin) * time_factor_;
    return times_[*index] = time.empty() ? nullptr : Share(std::move(time));
  }

  void Take(const Value& map, const char* section, const std::vector<SignalName>& signals,
            std::map<std::string, Series>& into, bool by_name) {
    std::map<std::string, ColumnMap> wanted;
    if (by_name) {
      for (const SignalName& signal : signals) {
        if (record_.Find(signal.name)) wanted[signal.name].column = signal.name;
      }
    } else if (const Value* tables = map.Find(section); tables != nullptr && tables->is_table()) {
      for (const Value::Entry& entry : tables->table()) {
        const bool known =
            std::any_of(signals.begin(), signals.end(), [&](const SignalName& s) { return s.name == entry.key; });
        if (!known) {
          std::vector<std::string> names;
          for (const SignalName& signal : signals) names.push_back(signal.name);
          const std::optional<std::string> near = Closest(entry.key, names);
          diagnostics_.Error(
              entry.where, fmt::format("the scenario has no {} \"{}\"", section, entry.key),
              near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("it has: {}", fmt::join(names, ", ")));
          continue;
        }
        ColumnMap column;
        column.where = entry.value.where();
        if (entry.value.is_table() &&
            ReadParams(entry.value, column, diagnostics_, fmt::format("{}.{}", section, entry.key))) {
          wanted[entry.key] = column;
        } else if (!entry.value.is_table()) {
          diagnostics_.Error(entry.value.where(),
                             fmt::format("{}.{} is {}", section, entry.key, entry.value.KindName()), "write a table");
        }
      }
    }
    for (const auto& [name, column] : wanted) TakeOne(name, column, signals, into);
  }

  void TakeOne(const std::string& name, const ColumnMap& map, const std::vector<SignalName>& signals,
               std::map<std::string, Series>& into) {
    const auto signal =
        std::find_if(signals.begin(), signals.end(), [&](const SignalName& s) { return s.name == name; });
    const std::optional<std::size_t> index = record_.Find(map.column);
    if (!index) {
      const auto left_out = std::find_if(record_.left_out.begin(), record_.left_out.end(),
                                         [&](const auto& variable) { return variable.first == map.column; });
      if (left_out != record_.left_out.end()) {
        diagnostics_.Error(map.where, fmt::format("{}: variable \"{}\" is no column", record_.source, map.column),
                           fmt::format("it {}", left_out->second));
        return;
      }
      const std::vector<std::string> names = record_.Names();
      const std::optional<std::string> near = Closest(map.column, names);
      diagnostics_.Error(
          map.where, fmt::format("{} has no column \"{}\"", record_.source, map.column),
          near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("columns: {}", fmt::join(names, ", ")));
      return;
    }
    const trace::Column& column = record_.columns[*index];
    const SourceSpan where = map.where.known() ? map.where : SourceSpan{record_.source};
    const std::string written = !map.unit.empty() ? map.unit : column.unit;
    double factor = map.sign, offset = 0.0;
    if (!written.empty() && !signal->unit.empty()) {
      const std::optional<Unit> from = ParseUnit(written), to = ParseUnit(signal->unit);
      if (!from || !to || !SameQuantity(*from, *to)) {
        diagnostics_.Error(
            where, fmt::format("column \"{}\" is in \"{}\", {} is in \"{}\"", column.name, written, name, signal->unit),
            from ? "these are different quantities: is it the right column?" : "unknown unit");
        return;
      }
      const double turn = RadiansPerTurn(written, *from, *to);
      if (turn != 1.0)
        result_.notes.push_back(
            fmt::format("column \"{}\" in \"{}\" is taken as turns: {} = 2 pi times it", column.name, written, name));
      factor = map.sign * turn * from->factor / to->factor;
      offset = map.sign * (from->offset - to->offset) / to->factor;
    }
    if (first_ >= column.values.size()) {
      diagnostics_.Error(rows_where_,
                         fmt::format("rows begin at {}, {} has {} rows", first_, record_.source, column.values.size()),
                         "rows are counted from 0");
      return;
    }
    const std::shared_ptr<const std::vector<double>> time = TimeOf(column);
    if (time == nullptr) return;
    std::vector<double> values = Rows(column.values);
    if (values.size() != time->size() || values.size() < 3) {
      diagnostics_.Error(
          where,
          fmt::format("column \"{}\" has {} values for {} time stamps", column.name, values.size(), time->size()),
          "a record needs three rows at least, and as many values as time stamps");
      return;
    }
    std::size_t bad = 0, first_bad = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i]) && bad++ == 0) first_bad = i;
      values[i] = factor * values[i] + offset;
    }
    if (bad > 0) {
      diagnostics_.Error(where,
                         fmt::format("column \"{}\" has {} values that are no numbers, the first in row {}",
                                     column.name, bad, first_ + first_bad),
                         "gaps are never filled silently: cut the record with rows = [first, end]");
      return;
    }
    result_.end_s = std::max(result_.end_s, time->back());
    into[name] = {time, Share(std::move(values))};
  }

  const trace::Record& record_;
  Diagnostics& diagnostics_;
  MappedRecord result_;
  TimeMap time_;
  double time_factor_ = 1.0;
  bool time_fault_ = false;
  std::size_t first_ = 0, last_ = static_cast<std::size_t>(-1);
  SourceSpan rows_where_;
  std::map<std::size_t, std::shared_ptr<const std::vector<double>>> times_;
};

}  // namespace

std::string TooFew(std::size_t samples) {
  if (samples >= kFewestSamples) return "";
  return fmt::format("{} samples are too few to compare with a simulation (at least {})", samples, kFewestSamples);
}

Result<trace::Record> ReadRecord(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".h5" || ending == ".hdf5") return trace::ReadHdf5Record(file);
  if (ending == ".mat") return trace::ReadMat(file);
  return trace::ReadCsv(file);
}

std::optional<MappedRecord> MapRecord(const trace::Record& record, const std::string& map_file,
                                      const std::vector<SignalName>& inputs, const std::vector<SignalName>& outputs,
                                      Diagnostics& diagnostics) {
  return Mapper(record, diagnostics).Run(map_file, inputs, outputs);
}

}  // namespace dynoproof
