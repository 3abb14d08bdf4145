#include "experiment/record_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "base/units.h"
#include "scenario/load.h"

namespace dynoproof {
namespace {

/// time = { ... }.
struct TimeTable {
  std::string column, unit;
  double rate_hz = 0.0, start_s = 0.0;
  void Visit(auto& v) {
    v.Optional("column", column, Any(), "name of the column of time stamps");
    v.Optional("unit", unit, Any(), "its unit; else what the file says, else s");
    v.Optional("rate_hz", rate_hz, Positive("Hz"), "samples per second, where there is no such column");
    v.Optional("start_s", start_s, Any(), "time of the first row by rate_hz; added to the stamps of a column");
  }
};

struct ChannelTable {
  std::string column, unit, between, time_unit;
  double sign = 1.0, gain = 1.0, offset = 0.0, rate_hz = 0.0, start_s = 0.0;
  bool missing = false, derivative = false;
  Value time;
  void Visit(auto& v) {
    v.Required("column", column, Any(), "name of the column; of HDF5 a path, of a matrix \"path[j]\"");
    v.Optional("unit", unit, Any(), "unit of the column; else what the file says, else the signal's own");
    v.Optional("sign", sign, Between(-1.0, 1.0), "-1 turns the sign");
    v.Optional("gain", gain, Any(), "value = sign (gain column + offset), in `unit`");
    v.Optional("offset", offset, Any(), "see gain");
    v.Optional(
        "between", between, std::vector<std::string>{"", "held", "linear", "band_limited", "band_limited_held"},
        "of an input, what it does between its samples: held; linear; band_limited (an analogue signal); "
        "band_limited_held (the "
        "same, held over each period of the run: a controller's command that the logger saw less often). Not said: the "
        "outputs decide, and a note says so");
    v.Optional("missing", missing, Any(), "true: rows without a number are rows without a sample");
    v.Optional("derivative", derivative, Any(),
               "true: the signal is the column's change per second, by central differences; `unit` is the column's");
    v.Optional("time", time, Any(),
               "a clock of its own: name of its column of stamps, or a table as for the whole file");
    v.Optional("time_unit", time_unit, Any(), "unit of those stamps");
    v.Optional("rate_hz", rate_hz, Between(0.0, 1e12), "a rate of its own instead");
    v.Optional("start_s", start_s, Any(), "time of its first row by that rate");
  }
  void Check(Faults& faults) const {
    if (std::abs(sign) != 1.0) faults.At("sign", "is 1 or -1");
    if (!std::isfinite(gain) || gain == 0.0) faults.At("gain", "is a number other than 0");
  }
};

/// The entries beside the tables of channels.
struct FileTable {
  std::string time_unit;
  double rate_hz = 0.0, start_s = 0.0;
  int skip = 0;
  Value time, rows;
  void Visit(auto& v) {
    v.Optional("time", time, Any(), "name of the column of time stamps, or { column, unit } or { rate_hz, start_s }");
    v.Optional("time_unit", time_unit, Any(), "unit of the stamps; else what the file says, else s");
    v.Optional("rate_hz", rate_hz, Between(0.0, 1e12), "samples per second, where there is no such column");
    v.Optional("start_s", start_s, Any(), "time of the first row by rate_hz");
    v.Optional("rows", rows, Any(), "[first, end): this part of the record, rows counted from 0");
    v.Optional("skip", skip, Between(0, 1000000), "lines of a text file before its names");
  }
};

class Reader {
 public:
  explicit Reader(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  void Read(const Value& root, RecordMap& map) {
    Value file = root;
    file.Erase("input");
    file.Erase("output");
    FileTable table;
    if (ReadParams(file, table, diagnostics_, "a map file")) {
      map.skip = table.skip;
      map.clock = Clock(root.Find("time"), table.time_unit, table.rate_hz, table.start_s, root.where());
      if (const Value* rows = root.Find("rows")) Rows(*rows, map);
    }
    Channels(root, "input", map.inputs);
    Channels(root, "output", map.outputs);
  }

 private:
  ClockMap Clock(const Value* time, const std::string& unit, double rate_hz, double start_s, const SourceSpan& where) {
    ClockMap clock{.column = "", .unit = unit, .rate_hz = rate_hz, .start_s = start_s, .where = where};
    if (time != nullptr && time->is_string()) {
      clock.column = time->string();
    } else if (time != nullptr) {
      TimeTable table;
      if (!ReadParams(*time, table, diagnostics_, "time")) return clock;
      clock.column = table.column;
      if (!table.unit.empty()) clock.unit = table.unit;
      if (table.rate_hz > 0.0) clock.rate_hz = table.rate_hz;
      if (table.start_s != 0.0) clock.start_s = table.start_s;
    }
    if (time != nullptr) clock.where = time->where();
    if (time != nullptr && clock.column.empty() == (clock.rate_hz == 0.0))
      diagnostics_.Error(clock.where, "\"time\" needs exactly one of column and rate_hz",
                         "time = { column = \"t\", unit = \"s\" } or time = { rate_hz = 1000 }");
    if (!clock.unit.empty()) {
      const std::optional<Unit> known = ParseUnit(clock.unit);
      if (!known || !SameQuantity(*known, *ParseUnit("s")))
        diagnostics_.Error(clock.where, fmt::format("\"{}\" is no unit of time", clock.unit), "s, ms, us, min, ...");
    }
    return clock;
  }

  void Rows(const Value& rows, RecordMap& map) {
    const bool good = rows.is_array() && rows.array().size() == 2 && rows.array()[0].is_integer() &&
                      rows.array()[1].is_integer() && rows.array()[0].integer() >= 0 &&
                      rows.array()[0].integer() < rows.array()[1].integer();
    if (!good) {
      diagnostics_.Error(rows.where(), "\"rows\" is no range", "write rows = [first, end) with 0 <= first < end");
      return;
    }
    map.first = static_cast<std::size_t>(rows.array()[0].integer());
    map.last = static_cast<std::size_t>(rows.array()[1].integer());
    map.rows_where = rows.where();
  }

  void Channels(const Value& root, const char* section, std::vector<ChannelMap>& into) {
    const Value* tables = root.Find(section);
    if (tables == nullptr) return;
    if (!tables->is_table()) {
      diagnostics_.Error(tables->where(), fmt::format("\"{}\" is {}", section, tables->KindName()),
                         fmt::format("write [{}.NAME]", section));
      return;
    }
    for (const Value::Entry& entry : tables->table()) {
      if (!entry.value.is_table()) {
        diagnostics_.Error(entry.value.where(), fmt::format("{}.{} is {}", section, entry.key, entry.value.KindName()),
                           "write a table");
        continue;
      }
      ChannelTable table;
      if (!ReadParams(entry.value, table, diagnostics_, fmt::format("{}.{}", section, entry.key))) continue;
      if (!table.between.empty() && std::string_view(section) == "output")
        diagnostics_.Error(entry.value.Find("between")->where(), "\"between\" belongs to an input",
                           "an output is compared at its own instants");
      into.push_back(
          {entry.key, table.column, table.unit, table.between, table.gain, table.offset, table.sign, table.missing,
           table.derivative,
           Clock(entry.value.Find("time"), table.time_unit, table.rate_hz, table.start_s, entry.value.where()),
           entry.where});
    }
  }

  Diagnostics& diagnostics_;
};

template <class P>
std::string KeysTable() {
  std::string text;
  for (const ParamInfo& key : ListParams<P>())
    text += fmt::format("  {:<10} {:<8} {}{}\n", key.name, key.type, key.description,
                        key.fallback.empty() ? " (required)" : "");
  return text;
}

}  // namespace

std::vector<std::string> RecordMap::Columns() const {
  std::vector<std::string> columns;
  const auto add = [&columns](const std::string& column) {
    if (!column.empty() && std::find(columns.begin(), columns.end(), column) == columns.end())
      columns.push_back(column);
  };
  add(clock.column);
  for (const std::vector<ChannelMap>* channels : {&inputs, &outputs}) {
    for (const ChannelMap& channel : *channels) add(channel.clock.column), add(channel.column);
  }
  return columns;
}

std::optional<RecordMap> ReadRecordMap(const std::string& file, Diagnostics& diagnostics) {
  RecordMap map;
  if (file.empty()) return map;
  const int before = diagnostics.error_count();
  const std::optional<Plan> plan = LoadPlan(file, {}, diagnostics);
  if (!plan) return std::nullopt;
  map.file = file;
  Reader(diagnostics).Read(plan->root, map);
  if (diagnostics.error_count() != before) return std::nullopt;
  return map;
}

std::string DescribeRecordMap() {
  return "map: a TOML file that says which column of a record (CSV, HDF5, MAT) is which signal\n"
         "\nfor the whole file\n" +
         KeysTable<FileTable>() + "\ntime = { ... }, where a name is not enough\n" + KeysTable<TimeTable>() +
         "\n[input.NAME] and [output.NAME], NAME as the scenario has it\n" + KeysTable<ChannelTable>() +
         "\nexample\n"
         "  time = { column = \"t\", unit = \"ms\" }\n"
         "  rows = [0, 50000]\n"
         "\n"
         "  [input.T_airgap]\n"
         "  column = \"M_airgap\"\n"
         "  unit = \"kN m\"\n"
         "  between = \"held\"\n"
         "\n"
         "  [output.T_shaft]\n"
         "  column = \"torque_flange\"\n"
         "  sign = -1\n"
         "  time = \"t_slow\"          # a raster of its own\n"
         "\nmore: new map FILE --scenario ID proposes one; check-data FILE --map MAP\n";
}

}  // namespace dynoproof
