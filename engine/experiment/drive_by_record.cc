#include "experiment/drive_by_record.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/units.h"
#include "experiment/gaps.h"

namespace dynoproof {
namespace {

/// Of a period: what an input that switches so much beside a tick moves is a millionth of what a period moves.
constexpr double kOnTick = 1e-3;

using Values = std::vector<double>;

Series MakeSeries(Values time, Values values) {
  return {std::make_shared<const Values>(std::move(time)), std::make_shared<const Values>(std::move(values))};
}

/// The largest distance of the samples from ticks of a period [periods].
double OffTicks(const Values& time, double period_s) {
  double off = 0.0;
  for (const double t : time) off = std::max(off, std::abs(t / period_s - std::round(t / period_s)));
  return off;
}

bool AllOnTicks(const MappedRecord& data, double period_s) {
  for (const auto* signals : {&data.inputs, &data.outputs}) {
    for (const auto& [name, series] : *signals) {
      if (OffTicks(*series.time, period_s) > kOnTick) return false;
    }
  }
  return true;
}

/// The series with its samples on ticks, where each is near one of its own.
Series OnTicks(const Series& series, double period_s) {
  Values ticks(series.time->size());
  for (std::size_t i = 0; i < ticks.size(); ++i) ticks[i] = std::round((*series.time)[i] / period_s) * period_s;
  return {std::make_shared<const Values>(std::move(ticks)), series.values};
}

/// The series half a period earlier: a source that interpolates then holds over each period the value of its middle,
/// without the lag of half a period that holding the value of its beginning has.
Series Centred(const Series& series, double period_s) {
  Values time = *series.time;
  for (double& t : time) t -= 0.5 * period_s;
  return {std::make_shared<const Values>(std::move(time)), series.values};
}

/// Of two samples at one instant, an event, the second: what holds from there on.
Series BehindEvents(const Series& series) {
  const Values& t = *series.time;
  if (std::adjacent_find(t.begin(), t.end()) == t.end()) return series;
  Values time, values;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (i + 1 < t.size() && t[i + 1] == t[i]) continue;
    time.push_back(t[i]), values.push_back((*series.values)[i]);
  }
  return MakeSeries(std::move(time), std::move(values));
}

/// The series with the rows that its uniform base misses. A short gap gets the values for which the sum of squares of
/// all fourth differences is least. For one row that is the polynomial through four samples on either side, which errs by 3e-4 of
/// the amplitude of a course at a tenth of the sampling rate. Longer gaps get a straight line: nothing is known there.
Series WithoutGaps(const Series& series, double step_s) {
  constexpr int kOrder = 4;
  constexpr std::array<double, kOrder + 1> kDifference = {1.0, -4.0, 6.0, -4.0, 1.0};
  const Values &t = *series.time, &x = *series.values;
  // A fit asks once a simulation, and most records have all their rows.
  if (std::lround((t.back() - t.front()) / step_s) + 1 == static_cast<long>(t.size())) return series;
  Values time, values;
  std::vector<std::pair<std::ptrdiff_t, std::ptrdiff_t>> gaps;  // first row, how many
  for (std::size_t i = 0; i < t.size(); ++i) {
    const auto missing = i == 0 ? 0 : std::lround((t[i] - t[i - 1]) / step_s) - 1;
    if (missing > 0) gaps.emplace_back(static_cast<std::ptrdiff_t>(time.size()), missing);
    for (long k = 1; k <= missing; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(missing + 1);
      time.push_back(t[i - 1] + share * (t[i] - t[i - 1])), values.push_back(x[i - 1] + share * (x[i] - x[i - 1]));
    }
    time.push_back(t[i]), values.push_back(x[i]);
  }
  const auto rows = static_cast<std::ptrdiff_t>(values.size());
  for (const auto& [first, count] : gaps) {
    if (count > kMostLost) continue;
    // Differences D x over the gap and its surroundings; the gap's own values solve D_g' D_g x_g = -D_g' D_rest x_rest.
    const std::ptrdiff_t from = std::max<std::ptrdiff_t>(0, first - kOrder);
    const std::ptrdiff_t to = std::min(rows, first + count + kOrder), differences = to - from - kOrder;
    if (differences < count) continue;
    Eigen::MatrixXd of_gap = Eigen::MatrixXd::Zero(differences, count);
    Eigen::VectorXd of_rest = Eigen::VectorXd::Zero(differences);
    for (std::ptrdiff_t d = 0; d < differences; ++d) {
      for (std::ptrdiff_t j = 0; j <= kOrder; ++j) {
        const std::ptrdiff_t row = from + d + j;
        const double factor = kDifference[static_cast<std::size_t>(j)];
        if (row >= first && row < first + count)
          of_gap(d, row - first) = factor;
        else
          of_rest[d] += factor * values[static_cast<std::size_t>(row)];
      }
    }
    const Eigen::VectorXd filled = of_gap.colPivHouseholderQr().solve(-of_rest);
    std::copy(filled.begin(), filled.end(), values.begin() + first);
  }
  return MakeSeries(std::move(time), std::move(values));
}

/// The mean over each period, held: of steps at the samples, or of straight lines between them.
Series MeansOf(const Series& series, double period_s, bool lines) {
  const Values &t = *series.time, &x = *series.values;
  const auto periods = static_cast<std::size_t>(std::ceil(t.back() / period_s - kOnTick)) + 1;
  Values time(periods), mean(periods);
  std::size_t i = 0;  // the sample at or before
  for (std::size_t k = 0; k < periods; ++k) {
    const double begin = static_cast<double>(k) * period_s, end = begin + period_s;
    double sum = 0.0, from = begin;
    while (from < end) {
      while (i + 1 < t.size() && t[i + 1] <= from) ++i;
      const bool inside = i + 1 < t.size() && from >= t[i];
      const double until = std::min(end, from < t.front() ? t.front() : inside ? t[i + 1] : end);
      double value = from < t.front() ? x.front() : x[i];
      if (lines && inside) {
        const double middle = 0.5 * (from + until);
        value += (x[i + 1] - x[i]) * (middle - t[i]) / (t[i + 1] - t[i]);
      }
      sum += value * (until - from);
      if (!(until > from)) break;
      from = until;
    }
    time[k] = begin, mean[k] = sum / period_s;
  }
  return MakeSeries(std::move(time), std::move(mean));
}

/// The finest uniform step of the inputs, or of the outputs where nothing is driven; 0: there is none.
double FinestStep(const MappedRecord& data) {
  double step = 0.0;
  for (const auto& [name, series] : data.inputs.empty() ? data.outputs : data.inputs) {
    const auto known = data.step_s.find(name);
    if (known != data.step_s.end() && (step == 0.0 || known->second < step)) step = known->second;
  }
  return step;
}

/// The period that divides a step, near the run's own [s]: one on whose ticks all samples lie, where there is one.
double PeriodFor(const MappedRecord& data, double step_s, double own_s) {
  constexpr int kFiner = 4;  // than the run's own: so many times as many ticks are worth it
  const int parts = std::max(1, static_cast<int>(std::lround(std::min(1e6, step_s / own_s))));
  for (int n = parts; n <= kFiner * parts; ++n) {
    if (AllOnTicks(data, step_s / n)) return step_s / n;
  }
  return step_s / parts;
}

/// Writes a period into [run]. The clock counts whole nanoseconds: for any other period it runs faster or slower.
/// Returns the period in seconds of the clock.
double KeepPeriod(double period_s, Value& run) {
  constexpr double kSame = 1e-12;  // a microsecond in eleven days
  const double clock_s = std::round(period_s * 1e9) * 1e-9, rate = period_s / clock_s;
  run["period_s"] = Value(clock_s);
  if (std::abs(rate - 1.0) > kSame)
    run["clock_rate"] = Value(rate);
  else
    run.Erase("clock_rate");
  return clock_s;
}

std::string BetweenOf(const MappedRecord& data, const std::string& name, const Plan& plan) {
  const auto said = data.between.find(name);
  const std::string text =
      said != data.between.end() ? said->second : plan.root.TextOr("input." + name + ".source.interpolation", "hold");
  return text == "held" ? "hold" : text;
}

/// A control block's period is a multiple of the run's: it cannot have another one.
bool HasControllers(const Plan& plan) {
  const Value* blocks = plan.root.Find("control");
  return blocks != nullptr && blocks->is_table() && !blocks->table().empty();
}

/// Numbers of `root` times those that stand at the same paths of `factors`.
void Multiply(Value& root, const Value& factors) {
  for (const Value::Entry& entry : factors.table()) {
    Value* own = root.Find(entry.key);
    if (own == nullptr) continue;
    if (entry.value.is_table() && own->is_table())
      Multiply(*own, entry.value);
    else if (entry.value.is_number() && own->is_number())
      *own = Value(own->number() * entry.value.number());
  }
}

}  // namespace

MappedRecord OntoClock(MappedRecord data, const Plan& plan) {
  if (data.period_s > 0.0) return data;
  const double own_s = plan.root.NumberOr("run.period_s", RunSettings{}.period_s);
  data.period_s = own_s;
  if (const double step_s = FinestStep(data); step_s > 0.0 && !HasControllers(plan) && !AllOnTicks(data, own_s)) {
    data.period_s = PeriodFor(data, step_s, own_s);
    data.notes.push_back(
        fmt::format("the run's period is {:.9g} s instead of {:g} s, so that the record's samples lie on its ticks",
                    data.period_s, own_s));
  }
  double shift_s = 0.0, beside_s = 0.0;
  for (auto* signals : {&data.inputs, &data.outputs}) {
    for (auto& [name, series] : *signals) {
      const double off_s = OffTicks(*series.time, data.period_s) * data.period_s;
      const bool near = off_s <= kOnTick * data.period_s;
      if (near) series = OnTicks(series, data.period_s);
      double& largest = near ? shift_s : beside_s;
      if (near || signals == &data.inputs) largest = std::max(largest, off_s);
    }
  }
  if (shift_s > 1e-9)
    data.notes.push_back(fmt::format("samples were moved onto the run's ticks, by {:.2g} s at most", shift_s));
  if (beside_s > 0.0)
    data.notes.push_back(
        fmt::format("samples of inputs lie up to {:.2g} s beside the ticks of {:g} s: each period holds the mean of "
                    "what the input does in it",
                    beside_s, data.period_s));
  return data;
}

void DriveByRecord(const MappedRecord& given, Plan& plan, Records& records) {
  // A fit drives its plans thousands of times by a record that is on the clock already: that is not copied.
  std::optional<MappedRecord> brought;
  const MappedRecord& data = given.period_s > 0.0 ? given : brought.emplace(OntoClock(given, plan));
  const double period_s = data.period_s;
  for (const auto& [name, given_series] : data.inputs) {
    std::string between = BetweenOf(data, name, plan);
    const bool on_ticks = OffTicks(*given_series.time, period_s) <= kOnTick;
    if (between.starts_with("band_limited") && !data.step_s.contains(name)) between = "linear";
    Series series = BehindEvents(given_series);
    const bool jumps = series.time != given_series.time;
    if (between.starts_with("band_limited")) series = WithoutGaps(series, data.step_s.at(name));
    if (between == "linear" && jumps) {
      records[name] = MeansOf(given_series, period_s, true);
      between = "hold";
    } else if (between == "band_limited" || (between == "linear" && on_ticks)) {
      records[name] = Centred(series, period_s);
    } else if (between == "band_limited_held") {
      records[name] = series;
      between = "band_limited";
    } else if (on_ticks) {
      records[name] = series;
    } else {
      records[name] = MeansOf(series, period_s, between == "linear");
      between = "hold";
    }
    Value& input = plan.root["input"][name];
    input.Erase("from");
    input["source"] = Value{{"type", "replay"}, {"record", name}, {"interpolation", between}};
  }
  Value& run = plan.root["run"];
  const double clock_s = KeepPeriod(period_s, run);
  run["duration_s"] = Value(std::max(1.0, std::ceil(data.end_s / period_s - kOnTick)) * clock_s);
}

std::string StartOfRecord(std::size_t record) { return fmt::format("of_record.{}.start", record); }

void WriteNumber(Value& root, const std::string& path, double value) {
  Value* table = &root;
  std::size_t begin = 0;
  for (std::size_t dot = path.find('.'); dot != std::string::npos; begin = dot + 1, dot = path.find('.', begin))
    table = &(*table)[path.substr(begin, dot - begin)];
  (*table)[path.substr(begin)] = Value(value);
}

bool IsOfAStart(std::string_view path) {
  return path.starts_with("of_record.") && path.find(".start.") != std::string_view::npos;
}

std::string DifferenceOfRecord(std::size_t record) { return fmt::format("of_record.{}.times", record); }

Plan StartingInto(const Plan& plan, std::size_t record) {
  const Value *start = plan.root.FindPath(StartOfRecord(record)),
              *difference = plan.root.FindPath(DifferenceOfRecord(record));
  Plan own = plan;
  own.root.Erase("of_record");
  if (start != nullptr) MergeInto(own.root, *start);
  if (difference != nullptr) Multiply(own.root, *difference);
  return own;
}

std::string TimeUnitFor(double span, double step, const Plan& plan, const std::string& read) {
  // A scenario's duration and period are those of its experiment. A record that lasts hundreds of times as long, in steps
  // as much longer, is another one, or in milliseconds.
  constexpr double kForeign = 100.0;
  static constexpr std::pair<const char*, double> kUnits[] = {
      {"us", 1e-6}, {"ms", 1e-3}, {"s", 1.0}, {"min", 60.0}, {"h", 3600.0}};
  const double duration_s = plan.root.NumberOr("run.duration_s", 0.0);
  const double period_s = plan.root.NumberOr("run.period_s", RunSettings{}.period_s);
  const std::optional<Unit> unit = ParseUnit(read);
  const double factor = unit ? unit->factor : 1.0, span_s = span * factor, step_s = step * factor;
  const bool slow = step_s > kForeign * period_s && span_s > kForeign * duration_s;
  const bool fast = step_s * kForeign < period_s && span_s * kForeign < duration_s;
  if (!(duration_s > 0.0) || (!slow && !fast)) return read;
  const double right = duration_s / span;
  return std::min_element(std::begin(kUnits), std::end(kUnits),
                          [&](const auto& a, const auto& b) {
                            return std::abs(std::log(a.second / right)) < std::abs(std::log(b.second / right));
                          })
      ->first;
}

std::optional<ForeignTime> ForeignTimeScale(const MappedRecord& data, const Plan& plan) {
  const auto& signals = data.inputs.empty() ? data.outputs : data.inputs;
  if (signals.empty()) return std::nullopt;
  const std::string read = data.time_unit.empty() ? "s" : data.time_unit;
  const double factor = ParseUnit(read) ? ParseUnit(read)->factor : 1.0;
  const double rows = static_cast<double>(std::max<std::size_t>(2, signals.begin()->second.time->size()));
  const double step_s = data.end_s / (rows - 1.0);
  const std::string unit = TimeUnitFor(data.end_s / factor, step_s / factor, plan, read);
  if (unit == read) return std::nullopt;
  const std::string way_out =
      data.time_column.empty()
          ? std::string("say its clock in a map file (dynoproof describe map)")
          : fmt::format("say it in a map file: time = {{ column = \"{}\", unit = \"{}\" }}", data.time_column, unit);
  return ForeignTime{
      fmt::format("the record lasts {:.4g} s in steps of {:.3g} s, the scenario {:.4g} s in steps of {:g} s: "
                  "its time was read in {}, is it in {}?",
                  data.end_s, step_s, plan.root.NumberOr("run.duration_s", 0.0),
                  plan.root.NumberOr("run.period_s", RunSettings{}.period_s), read, unit),
      way_out};
}

}  // namespace dynoproof
