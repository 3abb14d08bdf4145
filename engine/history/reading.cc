#include "history/reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "score/series.h"

namespace dynoproof::history {
namespace {

using nlohmann::json;

constexpr double kTime = 0.03;          // times: three per cent
constexpr double kInstructions = 0.01;  // exact counts: one per cent, as bench/budgets.toml
constexpr double kOfLimit = 0.05;       // a score: a twentieth of its limit
constexpr double kFigure = 1e-3;        // a figure: a thousandth of itself
constexpr double kCounter = 0.05;       // a solver's counter: a twentieth of itself
constexpr double kCoverage = 0.5;       // a share of lines: half a point

std::optional<double> ValueOf(const json& entry, const char* key) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// A time, a rate: what is not above 0 was not measured.
std::optional<double> PositiveOf(const json& entry, const char* key) {
  const std::optional<double> value = ValueOf(entry, key);
  return value && *value > 0.0 ? value : std::nullopt;
}

double Magnitude(const std::optional<double>& value) { return value ? std::abs(*value) : 0.0; }

void AddRun(const json& scenario, std::vector<Reading>& readings) {
  const std::string id = scenario.at("id");
  for (const json& check : scenario.at("checks")) {
    const auto limit = ValueOf(check, "limit");
    readings.push_back({"score/" + id + "/" + check.at("name").get<std::string>(), ValueOf(check, "value"),
                        check.value("unit", ""), false, Sense::kLessIsBetter, kOfLimit * Magnitude(limit)});
  }
  for (const auto& [name, figure] : scenario.at("figures").items()) {
    const auto value = ValueOf(figure, "value");
    readings.push_back({"figure/" + id + "/" + name, value, figure.value("unit", ""), false, Sense::kNeither,
                        kFigure * Magnitude(value)});
  }
  if (!scenario.contains("counters")) return;  // a run that broke, or results of an earlier version
  for (const auto& [name, count] : scenario.at("counters").items()) {
    const double value = count.get<double>();
    readings.push_back({"counter/" + id + "/" + name, value, "1", false, Sense::kNeither, kCounter * std::abs(value)});
  }
}

void AddBench(const json& scenario, std::vector<Reading>& readings) {
  const std::string id = scenario.at("id");
  if (scenario.at("quantiles_us").contains("0.5")) {  // tails say how busy the machine was
    const std::optional<double> median = PositiveOf(scenario.at("quantiles_us"), "0.5");
    readings.push_back({"bench/" + id + "/median", median, "us", true, Sense::kLessIsBetter, kTime});
  }
  readings.push_back({"bench/" + id + "/simulated_s_per_s", PositiveOf(scenario, "simulated_s_per_s"), "1", true,
                      Sense::kMoreIsBetter, kTime});
  readings.push_back(
      {"bench/" + id + "/heap_growth", ValueOf(scenario, "heap_growth_bytes"), "B", false, Sense::kLessIsBetter, 0.0});
}

/// The summary of gcovr: the lines that tests pass through, of each folder below the first one and of all.
void AddCoverage(const json& files, std::vector<Reading>& readings) {
  struct Lines {
    double covered = 0.0, total = 0.0;
    bool known = true;  // both numbers of every file are counts, and no more is covered than there is
  };
  std::map<std::string, Lines> folders;
  for (const json& file : files) {
    const std::string path = file.at("filename");
    const auto covered = ValueOf(file, "line_covered"), total = ValueOf(file, "line_total");
    const auto first = path.find('/'), second = first == path.npos ? first : path.find('/', first + 1);
    for (const std::string& name : {std::string("all"), path.substr(0, second)}) {
      Lines& lines = folders[name];
      lines.known = lines.known && covered && total && *covered >= 0.0 && *covered <= *total;
      lines.covered += covered.value_or(0.0);
      lines.total += total.value_or(0.0);
    }
  }
  for (const auto& [name, lines] : folders) {
    const bool measured = lines.known && lines.total > 0.0;
    readings.push_back({"coverage/" + name,
                        measured ? std::optional(100.0 * lines.covered / lines.total) : std::nullopt, "%", false,
                        Sense::kMoreIsBetter, kCoverage});
  }
}

/// Nanoseconds of a unit of time; nothing for any other.
std::optional<double> NanosecondsOf(const std::string& unit) {
  static const std::map<std::string, double> factors = {{"ns", 1.0}, {"us", 1e3}, {"ms", 1e6}, {"s", 1e9}};
  const auto found = factors.find(unit);
  return found == factors.end() ? std::nullopt : std::optional(found->second);
}

/// A time in nanoseconds, where the entry has one that was measured.
std::optional<double> TimeOf(const json& entry, const char* key, const char* unit) {
  const std::optional<double> time = PositiveOf(entry, key), factor = NanosecondsOf(entry.value(unit, "ns"));
  return time && factor ? std::optional(*time * *factor) : std::nullopt;
}

void AddBudget(const json& budget, std::vector<Reading>& readings) {
  const std::string unit = budget.value("unit", "");
  const bool time = NanosecondsOf(unit).has_value();
  const auto value = time ? TimeOf(budget, "value", "unit") : ValueOf(budget, "value");
  readings.push_back({"budget/" + budget.at("name").get<std::string>(), value, time ? "ns" : unit, time,
                      Sense::kLessIsBetter, time ? kTime : kInstructions * Magnitude(value)});
}

/// What the entries of one benchmark of a Google Benchmark program say together.
struct Repetitions {
  std::vector<double> times_ns;     // of the single repetitions
  std::optional<double> median_ns;  // the program's own, of all of them
  double announced = 0.0;           // how many repetitions its entries say there are
  bool failed = false;              // an entry that ended in an error, was skipped or has no time
};

/// A flag, whatever it is written as: true, 1, "true". What cannot be read as false counts as set.
bool IsSet(const json& entry, const char* key) {
  const auto found = entry.find(key);
  if (found == entry.end() || found->is_null()) return false;
  if (found->is_boolean()) return found->get<bool>();
  if (found->is_number()) return found->get<double>() != 0.0;
  return !found->is_string() || (*found != "" && *found != "false" && *found != "0");
}

/// Versions of the library differ in how they say that a benchmark ended early; a message without its flag, or no
/// iteration at all, says the same. The time beside it is none.
bool EndedEarly(const json& benchmark) {
  for (const char* key : {"error_occurred", "error_message", "skipped", "skip_message"}) {
    if (IsSet(benchmark, key)) return true;
  }
  return ValueOf(benchmark, "iterations") == 0.0;
}

void AddGoogle(const json& benchmarks, std::vector<Reading>& readings) {
  std::map<std::string, Repetitions> all;
  std::vector<std::string> names;  // in the order of the file
  for (const json& benchmark : benchmarks) {
    const std::string name = benchmark.value("run_name", benchmark.at("name").get<std::string>());
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    Repetitions& of = all[name];
    const bool is_single = benchmark.value("run_type", "iteration") != "aggregate";
    // A mean, a deviation or a growth with n is no reading beside a median, and its zero no fault.
    if (!is_single && benchmark.value("aggregate_name", "") != "median") continue;
    if (!is_single && benchmark.value("aggregate_unit", "time") != "time") continue;  // a percentage is no time
    if (is_single) of.announced = std::max(of.announced, ValueOf(benchmark, "repetitions").value_or(0.0));
    const std::optional<double> time = TimeOf(benchmark, "cpu_time", "time_unit");
    const bool failed = EndedEarly(benchmark);
    of.failed = of.failed || failed || !time;
    if (failed || !time) continue;
    if (is_single) {
      of.times_ns.push_back(*time);
    } else {
      of.median_ns = time;
    }
  }
  for (const std::string& name : names) {
    Repetitions& of = all[name];
    // A program that died on the way leaves the repetitions that it made: no median of all.
    const auto made = static_cast<double>(of.times_ns.size());
    if (made > 0.0 && made < of.announced) of.failed = true;
    if (of.times_ns.empty() && !of.median_ns && !of.failed) continue;  // other aggregates alone
    const double median = of.median_ns ? *of.median_ns : score::Median(of.times_ns);
    readings.push_back(
        {"time/" + name, of.failed ? std::nullopt : std::optional(median), "ns", true, Sense::kLessIsBetter, kTime});
  }
}

}  // namespace

Result<std::vector<Reading>> Readings(const json& document) {
  std::vector<Reading> readings;
  try {
    if (document.is_array()) {
      for (const json& budget : document) AddBudget(budget, readings);
    } else if (document.contains("benchmarks")) {
      AddGoogle(document.at("benchmarks"), readings);
    } else if (document.contains("gcovr/summary_format_version")) {
      AddCoverage(document.at("files"), readings);
    } else if (document.contains("scenarios")) {
      for (const json& scenario : document.at("scenarios")) {
        scenario.contains("quantiles_us") ? AddBench(scenario, readings) : AddRun(scenario, readings);
      }
    }
  } catch (const json::exception& fault) {
    return Failure{.message = std::string("not a result that history knows: ") + fault.what(), .exit_code = 2};
  }
  if (readings.empty()) {
    return Failure{.message =
                       "no reading in it: expected the JSON of run, bench, ci/check_budgets.py, ci/coverage.sh or "
                       "Google Benchmark",
                   .exit_code = 2};
  }
  return readings;
}

json ParseResult(std::string text) {
  json document = json::parse(text, nullptr, false);
  if (!document.is_discarded()) return document;
  static constexpr std::array<std::string_view, 6> kNoNumbers = {"-NaN", "NaN", "nan", "-Infinity", "Infinity", "inf"};
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && quoted) {
      ++i;
    } else if (text[i] == '"') {
      quoted = !quoted;
    } else if (!quoted) {
      for (const std::string_view word : kNoNumbers) {
        if (text.compare(i, word.size(), word) == 0) text.replace(i, word.size(), "null");
      }
    }
  }
  return json::parse(text, nullptr, false);
}

}  // namespace dynoproof::history
