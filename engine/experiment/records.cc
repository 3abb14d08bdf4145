#include "experiment/records.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>

#include "base/text.h"
#include "base/units.h"
#include "trace/csv.h"
#include "trace/foreign_time.h"
#include "trace/hdf5_record.h"
#include "trace/mat.h"
#include "trace/time_base.h"

namespace dynoproof {
namespace {

/// 2 pi where a column counts turns and the signal is in rad/s, else 1. "1/min" and "Hz" count turns; 1/s is the SI's
/// other name for rad/s.
double RadiansPerTurn(const std::string& written, const Unit& from, const Unit& to) {
  const std::array<int, 6> rate = {0, 0, -1, 0, 0, 0}, angular = {0, 0, -1, 0, 0, 1};
  const bool turns = from.exponents == rate && (from.factor != 1.0 || written.find("Hz") != std::string::npos);
  return turns && to.exponents == angular ? 2.0 * std::numbers::pi : 1.0;
}

/// A channel with its instants as the file has them: those that are not on its clock yet.
struct Raw {
  std::string name;
  bool input = false;
  trace::TimeBase base;
  double known_from_s = 0.0;
  std::vector<double> values = {};                  // by instant, SI
  std::map<std::size_t, double> before_event = {};  // by number of the instant, SI
};

class Mapper {
 public:
  Mapper(const trace::Record& record, const RecordMap& map, Diagnostics& diagnostics)
      : record_(record), map_(map), diagnostics_(diagnostics) {}

  std::optional<MappedRecord> Run(const std::vector<SignalName>& inputs, const std::vector<SignalName>& outputs) {
    const int before = diagnostics_.error_count();
    result_.file = record_.source;
    result_.notes = record_.notes;
    Take(true, inputs);
    Take(false, outputs);
    for (const SignalName& input : inputs) {
      const bool driven =
          std::any_of(raw_.begin(), raw_.end(), [&](const Raw& raw) { return raw.input && raw.name == input.name; });
      if (driven) continue;
      result_.notes.push_back(
          fmt::format("the record does not drive the input \"{}\": it keeps the scenario's own source", input.name));
    }
    if (diagnostics_.error_count() == before && raw_.empty()) NothingMatches(inputs, outputs);
    if (diagnostics_.error_count() == before) OntoOneClock();
    if (diagnostics_.error_count() != before) return std::nullopt;
    return std::move(result_);
  }

 private:
  void NothingMatches(const std::vector<SignalName>& inputs, const std::vector<SignalName>& outputs) {
    std::vector<std::string> wanted;
    for (const auto* list : {&inputs, &outputs}) {
      for (const SignalName& name : *list) wanted.push_back(name.name);
    }
    diagnostics_.Error(
        {record_.source},
        fmt::format("no column is a signal of the scenario; columns: {}", fmt::join(record_.Names(), ", ")),
        fmt::format("the scenario has: {}; name them in a map file (--map), which dynoproof new map FILE --scenario ID "
                    "proposes",
                    fmt::join(wanted, ", ")));
  }

  void Take(bool input, const std::vector<SignalName>& signals) {
    if (map_.file.empty()) {
      for (const SignalName& signal : signals) {
        ChannelMap channel;
        channel.name = channel.column = signal.name;
        if (record_.Find(signal.name) || WhyLeftOut(signal.name) != nullptr) TakeOne(channel, input, signal);
      }
      return;
    }
    const char* section = input ? "input" : "output";
    for (const ChannelMap& channel : input ? map_.inputs : map_.outputs) {
      const auto signal =
          std::find_if(signals.begin(), signals.end(), [&](const SignalName& one) { return one.name == channel.name; });
      if (signal != signals.end()) {
        TakeOne(channel, input, *signal);
        continue;
      }
      std::vector<std::string> names;
      for (const SignalName& one : signals) names.push_back(one.name);
      const std::optional<std::string> near = Closest(channel.name, names);
      diagnostics_.Error(
          channel.where, fmt::format("the scenario has no {} \"{}\"", section, channel.name),
          near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("it has: {}", fmt::join(names, ", ")));
    }
  }

  /// Null where the reader has not left out a variable of this name.
  const std::string* WhyLeftOut(const std::string& name) const {
    const auto found = std::find_if(record_.left_out.begin(), record_.left_out.end(),
                                    [&](const auto& variable) { return variable.first == name; });
    return found != record_.left_out.end() ? &found->second : nullptr;
  }

  /// The column of this name; a diagnostic where there is none.
  const trace::Column* ColumnOf(const std::string& name, const SourceSpan& where) {
    if (const std::optional<std::size_t> index = record_.Find(name)) return &record_.columns[*index];
    if (const std::string* why = WhyLeftOut(name)) {
      diagnostics_.Error(where, fmt::format("{}: \"{}\" is no column of numbers", record_.source, name), "it " + *why);
      return nullptr;
    }
    const std::vector<std::string> names = record_.Names();
    const std::optional<std::string> near = Closest(name, names);
    std::string others = fmt::format("columns: {}", fmt::join(names, ", "));
    for (const auto& [variable, why] : record_.left_out) others += fmt::format("; \"{}\" {}", variable, why);
    diagnostics_.Error(where, fmt::format("{} has no column \"{}\"", record_.source, name),
                       near ? fmt::format("did you mean \"{}\"?", *near) : others);
    return nullptr;
  }

  void TakeOne(const ChannelMap& channel, bool input, const SignalName& signal) {
    const SourceSpan where = channel.where.known() ? channel.where : SourceSpan{record_.source};
    const trace::Column* column = ColumnOf(channel.column, where);
    if (column == nullptr) return;
    const std::optional<std::pair<double, double>> to_si = Conversion(channel, *column, signal, where);
    if (!to_si) return;
    if (map_.first >= column->values.size() && map_.first > 0) {
      diagnostics_.Error(
          map_.rows_where,
          fmt::format("rows begin at {}, {} has {} rows", map_.first, record_.source, column->values.size()),
          "rows are counted from 0");
      return;
    }
    double unit_s = 1.0;
    std::optional<std::vector<double>> stamps = StampsOf(channel, *column, where, unit_s);
    if (!stamps) return;
    std::vector<double> values = Rows(column->values);
    if (values.size() != stamps->size() || values.size() < 3) {
      diagnostics_.Error(
          where,
          fmt::format("column \"{}\" has {} values for {} time stamps", column->name, values.size(), stamps->size()),
          "a record needs three rows at least, and as many values as time stamps; a raster of its own has a clock of "
          "its own: time = \"NAME\" in the channel's table of a map");
      return;
    }
    if (!DropMissing(channel, *column, where, *stamps, values)) return;
    if (const std::size_t bad = trace::FirstFaultOf(*stamps); bad < stamps->size()) {
      diagnostics_.Error(
          {record_.source},
          fmt::format("the time of \"{}\" {} at row {} ({})", column->name,
                      std::isfinite((*stamps)[bad]) ? "falls" : "is not a number", map_.first + bad, (*stamps)[bad]),
          "time may not fall from row to row; rows at one instant are an event");
      return;
    }
    Raw raw{channel.name, input, BaseOf(*std::move(stamps), unit_s), signal.known_from_s};
    raw.base.start_s += clock_start_s_;
    // A sample of an output is what was measured before the event, a command holds from it on.
    for (std::size_t i = 0; i < raw.base.time_s.size(); ++i)
      raw.values.push_back(to_si->first * values[input ? raw.base.last_row[i] : raw.base.first_row[i]] + to_si->second);
    for (std::size_t i = 0; input && i < raw.base.time_s.size(); ++i) {
      const std::size_t first = raw.base.first_row[i];
      if (raw.base.last_row[i] > first) raw.before_event[i] = to_si->first * values[first] + to_si->second;
    }
    if (channel.derivative) Differentiate(raw);
    if (!channel.between.empty())
      result_.between[channel.name] = channel.between;
    else if (input && column->held && !channel.derivative)
      result_.between[channel.name] = "held";
    raw_.push_back(std::move(raw));
  }

  /// The rate of change at each instant: central differences, one-sided ones at the ends. At an event there is one rate.
  static void Differentiate(Raw& raw) {
    const std::vector<double> values = raw.values;
    const std::size_t last = values.size() - 1;
    for (std::size_t i = 0; i <= last; ++i) {
      const std::size_t before = i > 0 ? i - 1 : 0, after = std::min(i + 1, last);
      raw.values[i] = (values[after] - values[before]) / (raw.base.time_s[after] - raw.base.time_s[before]);
    }
    raw.before_event.clear();
  }

  /// The time base of the stamps, computed once where a channel shares the stamps of the one before, as most do.
  const trace::TimeBase& BaseOf(std::vector<double> stamps, double unit_s) {
    if (stamps != last_stamps_ || unit_s != last_unit_s_) {
      last_base_ = trace::TimeBaseOf(stamps, unit_s);
      last_stamps_ = std::move(stamps), last_unit_s_ = unit_s;
    }
    return last_base_;
  }

  /// Factor and offset that make SI of a column's numbers; none, with a diagnostic, for a unit of another quantity.
  std::optional<std::pair<double, double>> Conversion(const ChannelMap& channel, const trace::Column& column,
                                                      const SignalName& signal, const SourceSpan& where) {
    const std::string written = !channel.unit.empty() ? channel.unit : column.unit;
    double factor = 1.0, offset = 0.0;
    if (!written.empty() && !signal.unit.empty()) {
      std::optional<Unit> from = ParseUnit(written);
      const std::optional<Unit> to = ParseUnit(signal.unit);
      if (from && channel.derivative) --from->exponents[2];  // per second
      if (!from || !to || !SameQuantity(*from, *to)) {
        diagnostics_.Error(
            where,
            fmt::format("column \"{}\" is in \"{}\", {} is in \"{}\"", column.name, written, signal.name, signal.unit),
            from ? "these are different quantities: is it the right column?" : "unknown unit");
        return std::nullopt;
      }
      const double turn = RadiansPerTurn(written, *from, *to);
      if (turn != 1.0)
        result_.notes.push_back(fmt::format("column \"{}\" in \"{}\" is taken as turns: {} = 2 pi times it",
                                            column.name, written, signal.name));
      factor = turn * from->factor / to->factor;
      offset = (from->offset - to->offset) / to->factor;
    }
    return std::pair{channel.sign * factor * channel.gain, channel.sign * (factor * channel.offset + offset)};
  }

  /// The rows asked for of one column.
  std::vector<double> Rows(const std::vector<double>& values) const {
    const std::size_t begin = std::min(map_.first, values.size()), end = std::min(map_.last, values.size());
    return {values.begin() + static_cast<std::ptrdiff_t>(begin), values.begin() + static_cast<std::ptrdiff_t>(end)};
  }

  /// The stamps of a channel in their own unit, of which one is `unit_s`; none, with a diagnostic, where there are none.
  std::optional<std::vector<double>> StampsOf(const ChannelMap& channel, const trace::Column& column,
                                              const SourceSpan& where, double& unit_s) {
    const ClockMap& clock = channel.clock.given() ? channel.clock : map_.clock;
    clock_start_s_ = clock.start_s;
    if (clock.rate_hz > 0.0 && clock.column.empty()) {
      std::vector<double> stamps = Rows(column.values);
      for (std::size_t i = 0; i < stamps.size(); ++i) stamps[i] = static_cast<double>(map_.first + i);
      unit_s = 1.0 / clock.rate_hz;
      return stamps;
    }
    const trace::Column* time = nullptr;
    if (!clock.column.empty()) {
      time = ColumnOf(clock.column, clock.where.known() ? clock.where : where);
      if (time == nullptr) return std::nullopt;
    } else if (column.time) {
      time = &record_.columns[*column.time];
      if (!told_time_ && trace::ForeignTime(time->name)) {
        told_time_ = true;
        result_.notes.push_back(fmt::format("column \"{}\" is taken as the time, in {}", time->name,
                                            time->unit.empty() ? "s" : time->unit));
      }
    } else {
      if (!time_fault_)
        diagnostics_.Error(
            {record_.source},
            fmt::format("no time for column \"{}\": there is no column of stamps of its length", column.name),
            "say time = { column = ... } or time = { rate_hz = ... } in a map file (dynoproof describe map)");
      time_fault_ = true;
      return std::nullopt;
    }
    // Where neither map nor file says the unit the name may, "stamp_us".
    const std::string in_name = trace::TimeUnitOf(time->name);
    const std::string written = !clock.unit.empty()   ? clock.unit
                                : !time->unit.empty() ? time->unit
                                : !in_name.empty()    ? in_name
                                                      : "s";
    const std::optional<Unit> unit = ParseUnit(written);
    if (!unit || !SameQuantity(*unit, *ParseUnit("s"))) {
      diagnostics_.Error({record_.source},
                         fmt::format("the time \"{}\" is in \"{}\", which is no unit of time", time->name, written),
                         "say what it is in a map file: time = { column = ..., unit = \"ms\" }");
      return std::nullopt;
    }
    unit_s = unit->factor;
    result_.time_column = time->name, result_.time_unit = written;
    return Rows(time->values);
  }

  /// Leaves out the rows that have no number where that is no loss: behind the end of a column that is shorter than the
  /// others of its file, between the samples of a slower raster, or where the map allows for it.
  bool DropMissing(const ChannelMap& channel, const trace::Column& column, const SourceSpan& where,
                   std::vector<double>& stamps, std::vector<double>& values) {
    std::vector<double> kept_stamps, kept_values;
    std::size_t missing = 0, first = 0, in_time = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool stamped = std::isfinite(stamps[i]);
      if (!std::isfinite(values[i])) {
        if (stamped && missing++ == 0) first = i;
        continue;
      }
      in_time += stamped ? 0 : 1;
      kept_stamps.push_back(stamps[i]), kept_values.push_back(values[i]);
    }
    if (kept_values.size() == values.size()) return true;
    const bool whole = missing == 0 && in_time == 0;  // padded to the length of others
    const bool raster = kept_stamps.size() >= 3 && trace::FirstFaultOf(kept_stamps) == kept_stamps.size() &&
                        missing >= kept_stamps.size() / 2 && IsRaster(kept_stamps);
    if (!whole && !raster && !channel.missing) {
      diagnostics_.Error(
          where,
          fmt::format("column \"{}\" has {} values that are no numbers, the first in row {}", column.name, missing,
                      map_.first + first),
          "gaps are never filled silently: cut the record with rows = [first, end], or say missing = true in the map");
      return false;
    }
    if (missing > 0)
      result_.notes.push_back(fmt::format("{}: {} rows have no number and are no samples, the first is row {}",
                                          channel.name, missing, map_.first + first));
    if (kept_values.size() < 3) {
      diagnostics_.Error(where, fmt::format("column \"{}\" has {} numbers", column.name, kept_values.size()),
                         "a record needs three rows at least");
      return false;
    }
    stamps = std::move(kept_stamps), values = std::move(kept_values);
    return true;
  }

  static bool IsRaster(const std::vector<double>& stamps) {
    const trace::TimeBase base = trace::TimeBaseOf(stamps);
    return base.uniform() && base.dropped == 0 && base.events == 0;
  }

  /// Rasters of one logger count multiples of one step, of which each alone may tell less than all together.
  void ShareSteps() {
    Raw* finest = nullptr;
    for (Raw& raw : raw_) {
      if (raw.base.uniform() && (finest == nullptr || raw.base.step_s < finest->base.step_s)) finest = &raw;
    }
    if (finest == nullptr) return;
    // The best known of the steps, in finest ones.
    double step_s = finest->base.step_s, range = finest->base.step_range;
    bool plain = finest->base.plain;
    const auto steps_of = [&](const Raw& raw) -> double {
      const double ratio = raw.base.step_s / finest->base.step_s, whole = std::round(ratio);
      const double known = raw.base.step_range + finest->base.step_range + 1e-12;
      return raw.base.uniform() && std::abs(ratio / whole - 1.0) <= known ? whole : 0.0;
    };
    for (const Raw& raw : raw_) {
      const double steps = steps_of(raw);
      if (steps == 0.0 || std::pair(raw.base.plain, -raw.base.step_range) <= std::pair(plain, -range)) continue;
      step_s = raw.base.step_s / steps, range = raw.base.step_range, plain = raw.base.plain;
    }
    std::vector<double> shared;
    for (const Raw& raw : raw_) shared.push_back(steps_of(raw) * step_s);
    for (std::size_t i = 0; i < raw_.size(); ++i) {
      trace::TimeBase& base = raw_[i].base;
      if (shared[i] == 0.0 || shared[i] == base.step_s) continue;
      for (double& t : base.time_s) t = std::round(t / base.step_s) * shared[i];
      base.step_s = base.usual_step_s = shared[i];
    }
    finest_step_s_ = step_s;
    constexpr double kNothing = 1e-8;  // of a step, and so of the numbers
    if (plain || range < kNothing) return;
    result_.step_doubt = range;
    result_.notes.push_back(
        fmt::format("the stamps leave the step of {:.9g} s open by {:.2g} of it, for which intervals allow; a map may "
                    "say the rate",
                    step_s, range));
  }

  /// How much later than the origin a raster starts. Where the stamps allow it, by whole steps of the finest one.
  double OffsetOf(const Raw& raw, const Raw& origin) {
    constexpr double kChance = 0.05, kNothing = 1e-6;  // of a step: what lies as near to one by chance; what is nothing
    const double digit = std::max(raw.base.resolution_s, origin.base.resolution_s);
    // Where stamps have digits, their difference has, too: what is beyond is round-off of large numbers.
    double apart = raw.base.start_s - origin.base.start_s;
    if (digit > 1e-9) apart = std::round(apart / digit) * digit;
    const bool exact = raw.base.exact && origin.base.exact && digit > 1e-9;
    const double known = exact ? 0.0 : 0.5 * (raw.base.resolution_s + origin.base.resolution_s);
    if (apart == 0.0) return apart;
    const double step_s = finest_step_s_, on_grid = step_s > 0.0 ? std::round(apart / step_s) * step_s : apart;
    const bool snaps = step_s > 0.0 && std::abs(on_grid - apart) <= std::max(known, digit);
    const double usual_s = step_s > 0.0 ? step_s : raw.base.usual_step_s;
    if (snaps && known < kChance * usual_s) return on_grid;
    if (known > kNothing * usual_s) result_.shift_doubt_s[raw.name] = known;
    return snaps ? on_grid : apart;
  }

  /// All channels begin and end with the inputs. Offsets between rasters are known to the digits of their stamps.
  void OntoOneClock() {
    ShareSteps();
    const bool driven = std::any_of(raw_.begin(), raw_.end(), [](const Raw& raw) { return raw.input; });
    double begin = 0.0, end = 0.0;
    const Raw* origin = nullptr;
    for (const Raw& raw : raw_) {
      if (raw.input != driven) continue;
      const double last = raw.base.start_s + raw.base.time_s.back();
      const bool later = origin == nullptr || (driven ? raw.base.start_s > begin : raw.base.start_s < begin);
      end = origin == nullptr ? last : driven ? std::min(end, last) : std::max(end, last);
      if (later) begin = raw.base.start_s, origin = &raw;
    }
    if (origin == nullptr) return;
    // A person looks for what is told at 0.45 s in the file, by its own stamps.
    if (std::abs(begin) > 1.5 * origin->base.usual_step_s)
      result_.notes.push_back(fmt::format("its stamps begin at {:.12g} s, which is 0 s here", begin));
    const double span = end - begin;
    std::map<std::string, std::vector<std::string>> told;  // a sentence about a clock, and who has it
    for (const Raw& raw : raw_) {
      Put(raw, OffsetOf(raw, *origin), span, driven);
      for (const std::string& note : raw.base.Notes("")) told[note].push_back(raw.name);
      if (raw.base.uniform()) result_.step_s[raw.name] = raw.base.step_s;
    }
    for (const auto& [name, doubt_s] : result_.shift_doubt_s)
      result_.notes.push_back(fmt::format(
          "{}: its stamps leave its instants beside those of the inputs open by {:.2g} s, for which intervals allow",
          name, doubt_s));
    for (const auto& [note, names] : told)
      result_.notes.push_back((names.size() == raw_.size() ? "the record" : fmt::format("{}", fmt::join(names, ", "))) +
                              note);
  }

  void Put(const Raw& raw, double offset, double span, bool driven) {
    // The ends of channels that were to be alike differ by round-off.
    const double slack = 0.01 * raw.base.usual_step_s;
    std::vector<double> time, values;
    std::size_t before = 0, after = 0;
    for (std::size_t i = 0; i < raw.base.time_s.size(); ++i) {
      const double t = raw.base.time_s[i] + offset;
      if (driven && t > span + slack) {
        ++after;
        continue;
      }
      if (driven && !raw.input && t < -slack) {
        ++before;
        continue;
      }
      if (t < raw.known_from_s) continue;
      if (const auto event = raw.before_event.find(i); event != raw.before_event.end())
        time.push_back(t), values.push_back(event->second);
      time.push_back(t), values.push_back(raw.values[i]);
    }
    if (before + after > 0)
      result_.notes.push_back(
          fmt::format("{}: {} samples lie outside the span of the inputs and are left out", raw.name, before + after));
    if (time.size() < 3) {
      diagnostics_.Error({record_.source},
                         fmt::format("\"{}\" has {} samples in the span of the inputs", raw.name, time.size()),
                         "do their clocks begin at the same instant? a map may say start_s");
      return;
    }
    result_.end_s = std::max(result_.end_s, time.back());
    (raw.input ? result_.inputs : result_.outputs)[raw.name] = {
        std::make_shared<const std::vector<double>>(std::move(time)),
        std::make_shared<const std::vector<double>>(std::move(values))};
  }

  const trace::Record& record_;
  const RecordMap& map_;
  Diagnostics& diagnostics_;
  MappedRecord result_;
  std::vector<Raw> raw_;
  std::vector<double> last_stamps_;
  double last_unit_s_ = 0.0;
  trace::TimeBase last_base_;
  double clock_start_s_ = 0.0, finest_step_s_ = 0.0;
  bool time_fault_ = false, told_time_ = false;
};

/// By the names that the file offers, or by the paths that a map asks for.
Result<trace::Record> ReadHdf5(const std::string& file, const RecordMap& map) {
  const std::vector<std::string> wanted = map.Columns();
  std::vector<std::string> scaled;  // the map says what their numbers mean
  for (const std::vector<ChannelMap>* channels : {&map.inputs, &map.outputs}) {
    for (const ChannelMap& channel : *channels) {
      if (channel.gain != 1.0 || channel.offset != 0.0) scaled.push_back(channel.column);
    }
  }
  Result<trace::Record> record = trace::ReadHdf5Record(file, {}, scaled);
  const bool all = record.ok() && std::all_of(wanted.begin(), wanted.end(),
                                              [&](const std::string& name) { return record->Find(name).has_value(); });
  if (all || wanted.empty()) return record;
  return trace::ReadHdf5Record(file, wanted, scaled);
}

}  // namespace

std::string TooFew(std::size_t samples) {
  if (samples >= kFewestSamples) return "";
  return fmt::format("{} samples are too few to compare with a simulation (at least {})", samples, kFewestSamples);
}

Result<trace::Record> ReadRecord(const std::string& file, const RecordMap& map) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".h5" || ending == ".hdf5") return ReadHdf5(file, map);
  if (ending == ".mat") return trace::ReadMat(file);
  return trace::ReadCsv(file, map.skip);
}

std::optional<MappedRecord> MapRecord(const trace::Record& record, const RecordMap& map,
                                      const std::vector<SignalName>& inputs, const std::vector<SignalName>& outputs,
                                      Diagnostics& diagnostics) {
  return Mapper(record, map, diagnostics).Run(inputs, outputs);
}

std::optional<MappedRecord> OpenRecord(const std::string& file, const std::string& map_file,
                                       const std::vector<SignalName>& inputs, const std::vector<SignalName>& outputs,
                                       Diagnostics& diagnostics) {
  const std::optional<RecordMap> map = ReadRecordMap(map_file, diagnostics);
  if (!map) return std::nullopt;
  const Result<trace::Record> record = ReadRecord(file, *map);
  if (!record.ok()) {
    diagnostics.Error({file}, record.failure().message);
    return std::nullopt;
  }
  return MapRecord(*record, *map, inputs, outputs, diagnostics);
}

}  // namespace dynoproof
