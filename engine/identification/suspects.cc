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
constexpr double kClearly = 0.5;    // of the distance that was

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
  struct Cause {
    double factor;
    const char* text;
  };
  const bool turns = unit == "1" || unit.find("rad") != std::string::npos || unit.find("/s") != std::string::npos;
  static constexpr std::array<Cause, 5> kCauses = {{{1000.0, "a prefix: kilo or milli"},
                                                    {60.0, "minutes and seconds"},
                                                    {9.5493, "1/min and rad/s"},
                                                    {57.2958, "degrees and radians"},
                                                    {6.2832, "turns and radians (Hz and rad/s)"}}};
  for (const Cause& cause : kCauses) {
    if (!turns && cause.factor < 1000.0) continue;
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
    if (after.ok() && *after < kClearly * *before)
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

std::vector<Suspect> MisreadingsOf(const Plan& plan, const MappedRecord& record, const Registry& registry) {
  constexpr double kNear = 0.2, kThird = 1.0 / 3.0, kSame = 1.2;
  static constexpr std::array<double, 5> kFactors = {1000.0, 60.0, 9.5493, 57.2958, 6.2832};
  std::vector<Suspect> found;
  const auto distance = [&](const MappedRecord& as) {
    const Result<std::optional<estimation::HorizonLevel>> level = estimation::ShortestLevelOf(plan, as, registry);
    return level.ok() && *level ? (*level)->GeometricMean() : std::numeric_limits<double>::infinity();
  };
  const double given = distance(record);
  if (record.outputs.empty() || given < kNear) return found;
  std::vector<std::string> inputs, outputs, all;
  std::map<std::string, std::vector<std::string>> of_unit;
  for (const auto& [name, series] : record.inputs) inputs.push_back(name);
  for (const auto& [name, series] : record.outputs) outputs.push_back(name);
  all = inputs;
  all.insert(all.end(), outputs.begin(), outputs.end());
  const auto stated = [&](const std::string& name) {
    return plan.root.FindPath((record.inputs.contains(name) ? "input." : "output.") + name);
  };
  for (const std::string& name : all) of_unit[stated(name)->TextOr("unit", "1")].push_back(name);
  // How far signals are from their nominal values, in powers of ten.
  const auto unusual = [&](MappedRecord& as) {
    double sum = 0.0;
    for (const std::string& name : all) {
      const double size = score::Largest(*Find(as, name)->values);
      sum += size > 0.0 ? std::abs(std::log10(size / stated(name)->NumberOr("nominal", 1.0))) : 0.0;
    }
    return sum;
  };
  struct Reading {
    Suspect suspect;
    double unusual;
  };
  std::vector<Reading> readings;
  MappedRecord as_given = record;
  const double usual = unusual(as_given);
  const auto consider = [&](const char* kind, const std::string& column, const std::string& text,
                            const std::function<void(MappedRecord&)>& read) {
    MappedRecord as = record;
    read(as);
    const double now = unusual(as);
    if (std::string_view(kind) == "unit" && !(now < usual)) return;
    if (const double after = distance(as); after < kThird * given)
      readings.push_back({{text, after, true, {as}, kind, column}, now});
  };
  const auto scale = [](const std::vector<std::string>& names, double factor) {
    return [&names, factor](MappedRecord& as) {
      for (const std::string& name : names) *Find(as, name) = Scaled(*Find(as, name), factor);
    };
  };
  std::vector<std::vector<std::string>> groups;
  if (!inputs.empty()) groups.push_back(inputs);
  for (const std::string& name : outputs) groups.push_back({name});
  for (const std::vector<std::string>& names : groups)
    consider("sign", names.front(), fmt::format("{} with the other sign", fmt::join(names, ", ")), scale(names, -1.0));
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = std::max(i + 1, inputs.size()); k < all.size(); ++k)
      consider("swapped", all[k], fmt::format("{} and {} exchanged", all[i], all[k]),
               [&](MappedRecord& as) { Exchange(as, all[i], all[k]); });
  }
  for (const auto& [unit, names] : of_unit) {
    if (names.size() > 1) groups.push_back(names);
  }
  for (const std::vector<std::string>& names : groups) {
    const std::string unit = stated(names.front())->TextOr("unit", "1");
    for (const double known : kFactors) {
      for (const double factor : {known, 1.0 / known}) {
        if (CauseOfFactor(factor, unit))
          consider("unit", names.front(), TextOfFactor(fmt::format("{}", fmt::join(names, ", ")), factor, unit),
                   scale(names, factor));
      }
    }
  }
  if (readings.empty()) return found;
  std::ranges::sort(readings, {}, [](const Reading& one) { return one.suspect.nrmse; });
  const auto end = std::ranges::find_if(
      readings, [&](const Reading& one) { return one.suspect.nrmse > kSame * readings.front().suspect.nrmse; });
  std::stable_sort(readings.begin(), end, [](const Reading& a, const Reading& b) { return a.unusual < b.unusual; });
  for (auto one = readings.begin(); one != end; ++one) found.push_back(std::move(one->suspect));
  return found;
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
