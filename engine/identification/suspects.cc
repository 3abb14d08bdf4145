#include "identification/suspects.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "estimation/horizon.h"
#include "identification/objective.h"
#include "score/series.h"

namespace dynoproof::identification {
namespace {

constexpr double kAccounted = 0.5;  // NRMSE: a quarter of the squares is left
constexpr double kSure = 0.1;       // NRMSE: a hundredth of the squares
constexpr double kShareLeft = 0.5;  // of the distance that was

/// Factors by which people mistake units.
struct Cause {
  double factor;
  const char* text;
  bool of_angles, of_rates;  // of which quantities; both false: of all
};
constexpr std::array<Cause, 6> kCauses = {{{1000.0, "a prefix: kilo or milli", false, false},
                                           {60.0, "minutes and seconds", true, true},
                                           {9.5493, "1/min and rad/s", true, false},
                                           {57.2958, "degrees and radians", true, false},
                                           {6.2832, "turns and radians (Hz and rad/s)", true, false},
                                           {3.6, "hours and seconds (km/h and m/s)", false, true}}};

Series Scaled(const Series& series, double factor) {
  std::vector<double> values = *series.values;
  for (double& value : values) value *= factor;
  return {series.time, std::make_shared<const std::vector<double>>(std::move(values))};
}

Series* Find(MappedRecord& record, const std::string& name) {
  for (auto* signals : {&record.inputs, &record.outputs}) {
    if (const auto found = signals->find(name); found != signals->end()) return &found->second;
  }
  return nullptr;
}

void Exchange(MappedRecord& record, const std::string& a, const std::string& b) {
  Series *first = Find(record, a), *second = Find(record, b);
  if (first == nullptr || second == nullptr) return;
  std::swap(*first, *second);
  const auto step_of = [&](const std::string& name) {
    const auto found = record.step_s.find(name);
    return found != record.step_s.end() ? found->second : 0.0;
  };
  const double step_a = step_of(a), step_b = step_of(b);
  for (const auto& [name, step_s] : {std::pair(a, step_b), std::pair(b, step_a)}) {
    if (step_s > 0.0)
      record.step_s[name] = step_s;
    else
      record.step_s.erase(name);
  }
}

/// An output beside its prediction, both without their means.
struct Beside {
  double factor = 1.0, correlation = 0.0;  // of the prediction; 0 where one of them stands still
};

Beside Compare(const EstimationProblem& problem, const Eigen::VectorXd& predicted, const std::string& name) {
  double both = 0.0, measured = 0.0, simulated = 0.0;
  for (const ComparedOutput& c : problem.channels()) {
    if (c.name != name) continue;
    const Eigen::ArrayXd x = problem.measured().segment(c.begin, c.count), y = predicted.segment(c.begin, c.count);
    both += ((x - x.mean()) * (y - y.mean())).sum();
    measured += (x - x.mean()).square().sum(), simulated += (y - y.mean()).square().sum();
  }
  if (!(measured > 0.0) || !(simulated > 0.0)) return {};
  return {std::copysign(std::sqrt(measured / simulated), both), both / std::sqrt(measured * simulated)};
}

std::string TextOfFactor(const std::string& names, double factor, const std::string& unit) {
  const std::string size = fmt::format("{:.4g} times as large", std::abs(factor));
  if (std::abs(std::abs(factor) - 1.0) < 0.1) return fmt::format("{} with the other sign", names);
  const std::optional<std::string> cause = CauseOfFactor(factor, unit);
  return fmt::format("{} {}{} ({})", names, size, factor < 0.0 ? " and with the other sign" : "",
                     cause ? *cause : "another unit, e.g. volts of a sensor?");
}

}  // namespace

std::optional<std::string> CauseOfFactor(double factor, const std::string& unit) {
  const bool angle = unit == "1" || unit == "1/s" || unit.find("rad") != std::string::npos;
  const bool rate = !angle && unit.find("/s") != std::string::npos;
  for (const Cause& cause : kCauses) {
    if ((cause.of_angles || cause.of_rates) && !(cause.of_angles && angle) && !(cause.of_rates && rate)) continue;
    for (const double f : {cause.factor, 1.0 / cause.factor}) {
      if (std::abs(std::log(std::abs(factor) / f)) < 0.03) return fmt::format("about {:.4g}: {}?", f, cause.text);
    }
  }
  return std::nullopt;
}

bool AccountsFor(double nrmse) { return nrmse < kAccounted; }

Result<std::vector<Suspect>> SuspectsOf(const EstimationProblem& problem, const Plan& plan) {
  std::vector<Suspect> suspects;
  const auto distance = [&](const EstimationProblem& of) { return NrmseOf(*FreeRunObjective(of), plan); };
  const Result<double> before = distance(problem);
  if (!before.ok()) return before.failure();
  if (AccountsFor(*before) || problem.channels().empty()) return suspects;
  const Result<Eigen::VectorXd> predicted = problem.PredictPlan(plan);
  if (!predicted.ok()) return predicted.failure();
  const auto consider = [&](const std::string& text, bool known, const std::function<void(MappedRecord&)>& read) {
    std::vector<MappedRecord> records = problem.records();
    for (MappedRecord& record : records) read(record);
    const Result<double> after = distance({problem.plan(), records, problem.registry()});
    if (after.ok() && *after < kShareLeft * *before)
      suspects.push_back({text, *after, known && *after < kSure, std::move(records)});
  };
  std::vector<std::string> inputs, outputs;
  for (const auto& [name, series] : problem.records().front().inputs) inputs.push_back(name);
  for (const auto& [name, series] : problem.records().front().outputs) outputs.push_back(name);
  const auto unit_of = [&](const char* section, const std::string& name) {
    return plan.root.TextOr(fmt::format("{}.{}.unit", section, name), "1");
  };
  double mean = 0.0;  // logarithmic, of the outputs' factors
  for (const std::string& name : outputs) {
    const Beside beside = Compare(problem, *predicted, name);
    mean += std::log(std::abs(beside.factor)) / static_cast<double>(outputs.size());
    const std::string unit = unit_of("output", name);
    const bool known = CauseOfFactor(beside.factor, unit).has_value();
    consider(TextOfFactor(name, 1.0 / beside.factor, unit), known, [&](MappedRecord& record) {
      if (Series* series = Find(record, name)) *series = Scaled(*series, 1.0 / beside.factor);
    });
  }
  if (!inputs.empty()) {
    const std::string unit = unit_of("input", inputs.front());
    consider(TextOfFactor(fmt::format("{}", fmt::join(inputs, ", ")), std::exp(mean), unit),
             CauseOfFactor(std::exp(mean), unit).has_value(), [&](MappedRecord& record) {
               for (auto& [name, series] : record.inputs) series = Scaled(series, std::exp(mean));
             });
  }
  std::vector<std::string> all = inputs;
  all.insert(all.end(), outputs.begin(), outputs.end());
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = std::max(i + 1, inputs.size()); k < all.size(); ++k)
      consider(fmt::format("{} and {} exchanged", all[i], all[k]), true,
               [&](MappedRecord& record) { Exchange(record, all[i], all[k]); });
  }
  std::sort(suspects.begin(), suspects.end(), [](const auto& a, const auto& b) { return a.nrmse < b.nrmse; });
  return suspects;
}

namespace {

/// One way to read a record otherwise.
struct Reading {
  std::string kind, column, text;
  std::function<void(MappedRecord&)> read;
};

const Value* Stated(const Plan& plan, const MappedRecord& record, const std::string& name) {
  return plan.root.FindPath((record.inputs.contains(name) ? "input." : "output.") + name);
}

std::function<void(MappedRecord&)> Scaling(const std::vector<std::string>& names, double factor) {
  return [names, factor](MappedRecord& as) {
    for (const std::string& name : names) *Find(as, name) = Scaled(*Find(as, name), factor);
  };
}

/// The ways that MisreadingsOf() tries.
std::vector<Reading> ReadingsOf(const Plan& plan, const MappedRecord& record) {
  std::vector<std::string> inputs, all;
  for (const auto& [name, series] : record.inputs) inputs.push_back(name);
  all = inputs;
  for (const auto& [name, series] : record.outputs) all.push_back(name);
  std::map<std::string, std::vector<std::string>> of_unit;
  for (const std::string& name : all) of_unit[Stated(plan, record, name)->TextOr("unit", "1")].push_back(name);
  std::vector<std::vector<std::string>> groups;  // that share a sign, or a unit
  if (!inputs.empty()) groups.push_back(inputs);
  for (const auto& [name, series] : record.outputs) groups.push_back({name});
  std::vector<Reading> readings;
  for (const std::vector<std::string>& names : groups)
    readings.push_back(
        {"sign", names.front(), fmt::format("{} with the other sign", fmt::join(names, ", ")), Scaling(names, -1.0)});
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = std::max(i + 1, inputs.size()); k < all.size(); ++k)
      readings.push_back({"swapped", all[k], fmt::format("{} and {} exchanged", all[i], all[k]),
                          [a = all[i], b = all[k]](MappedRecord& as) { Exchange(as, a, b); }});
  }
  for (const auto& [unit, names] : of_unit) {
    if (names.size() > 1) groups.push_back(names);
  }
  for (const std::vector<std::string>& names : groups) {
    const std::string unit = Stated(plan, record, names.front())->TextOr("unit", "1");
    for (const Cause& known : kCauses) {
      for (const double factor : {known.factor, 1.0 / known.factor}) {
        if (CauseOfFactor(factor, unit))
          readings.push_back({"unit", names.front(),
                              TextOfFactor(fmt::format("{}", fmt::join(names, ", ")), factor, unit),
                              Scaling(names, factor)});
      }
    }
  }
  return readings;
}

/// How far signals are from their nominal values, in powers of ten.
double UnusualnessOf(const Plan& plan, const MappedRecord& record) {
  double sum = 0.0;
  for (const auto* signals : {&record.inputs, &record.outputs}) {
    for (const auto& [name, series] : *signals) {
      const double size = score::Largest(*series.values);
      if (size > 0.0) sum += std::abs(std::log10(size / Stated(plan, record, name)->NumberOr("nominal", 1.0)));
    }
  }
  return sum;
}

}  // namespace

std::vector<Suspect> MisreadingsOf(const Plan& plan, const MappedRecord& record, const Registry& registry) {
  constexpr double kNear = 0.2, kThird = 1.0 / 3.0, kSame = 1.2;
  if (record.outputs.empty()) return {};
  const auto distance = [&](const MappedRecord& as) {
    const Result<std::optional<estimation::HorizonLevel>> level = estimation::ShortestLevelOf(plan, as, registry);
    return level.ok() && *level ? (*level)->GeometricMean() : std::numeric_limits<double>::infinity();
  };
  const double given = distance(record), usual = UnusualnessOf(plan, record);
  if (given < kNear) return {};
  std::vector<std::pair<double, Suspect>> found;  // with how unusual its values are
  for (const Reading& reading : ReadingsOf(plan, record)) {
    MappedRecord as = record;
    reading.read(as);
    const double now = UnusualnessOf(plan, as);
    if (reading.kind == "unit" && !(now < usual))
      continue;  // a unit that takes signals farther from what is usual is none
    if (const double after = distance(as); after < kThird * given)
      found.emplace_back(now, Suspect{reading.text, after, true, {as}, reading.kind, reading.column});
  }
  std::ranges::sort(found, {}, [](const auto& one) { return one.second.nrmse; });
  const auto far = [&](const auto& one) { return one.second.nrmse > kSame * found.front().second.nrmse; };
  found.erase(std::ranges::find_if(found, far), found.end());
  std::ranges::stable_sort(found, {}, [](const auto& one) { return one.first; });
  std::vector<Suspect> suspects;
  for (auto& [unusual, suspect] : found) suspects.push_back(std::move(suspect));
  return suspects;
}

double LargestCorrelation(const EstimationProblem& problem, const Plan& plan) {
  const Result<Eigen::VectorXd> predicted = problem.PredictPlan(plan);
  double largest = 0.0;
  if (!predicted.ok()) return largest;
  for (const ComparedOutput& c : problem.channels())
    largest = std::max(largest, std::abs(Compare(problem, *predicted, c.name).correlation));
  return largest;
}

}  // namespace dynoproof::identification
