#include "history/reading.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace dynoproof::history {
namespace {

using nlohmann::json;

constexpr double kTime = 0.03;          // times: three per cent
constexpr double kInstructions = 0.01;  // exact counts: one per cent, as bench/budgets.toml
constexpr double kOfLimit = 0.05;       // a score: a twentieth of its limit
constexpr double kFigure = 1e-3;        // a figure: a thousandth of itself
constexpr double kCounter = 0.05;       // a solver's counter: a twentieth of itself

std::optional<double> ValueOf(const json& entry, const char* key) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
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
  for (const auto& [quantile, value] : scenario.at("quantiles_us").items()) {
    if (quantile != "0.5") continue;  // tails say how busy the machine was
    readings.push_back({"bench/" + id + "/median", value.get<double>(), "us", true, Sense::kLessIsBetter, kTime});
  }
  readings.push_back({"bench/" + id + "/simulated_s_per_s", ValueOf(scenario, "simulated_s_per_s"), "1", true,
                      Sense::kMoreIsBetter, kTime});
  readings.push_back(
      {"bench/" + id + "/heap_growth", ValueOf(scenario, "heap_growth_bytes"), "B", false, Sense::kLessIsBetter, 0.0});
}

void AddBudget(const json& budget, std::vector<Reading>& readings) {
  const auto value = ValueOf(budget, "value");
  const bool time = budget.value("unit", "") == "ns";
  readings.push_back({"budget/" + budget.at("name").get<std::string>(), value, budget.value("unit", ""), time,
                      Sense::kLessIsBetter, time ? kTime : kInstructions * Magnitude(value)});
}

void AddGoogle(const json& benchmark, std::vector<Reading>& readings) {
  if (benchmark.value("run_type", "") == "aggregate" && benchmark.value("aggregate_name", "") != "median") return;
  readings.push_back({"time/" + benchmark.value("run_name", benchmark.at("name").get<std::string>()),
                      ValueOf(benchmark, "cpu_time"), benchmark.value("time_unit", ""), true, Sense::kLessIsBetter,
                      kTime});
}

}  // namespace

Result<std::vector<Reading>> Readings(const json& document) {
  std::vector<Reading> readings;
  try {
    if (document.is_array()) {
      for (const json& budget : document) AddBudget(budget, readings);
    } else if (document.contains("benchmarks")) {
      for (const json& benchmark : document.at("benchmarks")) AddGoogle(benchmark, readings);
    } else if (document.contains("scenarios")) {
      for (const json& scenario : document.at("scenarios")) {
        scenario.contains("quantiles_us") ? AddBench(scenario, readings) : AddRun(scenario, readings);
      }
    }
  } catch (const json::exception& fault) {
    return Failure{.message = std::string("not a result that history knows: ") + fault.what(), .exit_code = 2};
  }
  if (readings.empty()) {
    return Failure{
        .message = "no reading in it: expected the JSON of run, bench, ci/check_budgets.py or Google Benchmark",
        .exit_code = 2};
  }
  return readings;
}

}  // namespace dynoproof::history
