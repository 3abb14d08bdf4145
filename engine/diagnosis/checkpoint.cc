#include "diagnosis/checkpoint.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/atomic_file.h"
#include "base/json_text.h"
#include "base/text.h"
#include "scenario/load.h"

namespace dynoproof::diagnosis {
namespace {

using nlohmann::json;

std::string NameOf(const std::vector<EffectInstance>& effects) {
  std::string name;
  for (const EffectInstance& instance : effects) name += instance.ToString() + " ";
  return name;
}

std::string FingerprintOf(const EstimationProblem& problem) {
  std::string bytes = ToToml(problem.plan().root);
  const auto add = [&bytes](const double* values, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(double));
  };
  add(problem.measured().data(), static_cast<std::size_t>(problem.measured().size()));
  for (const MappedRecord& record : problem.records()) {
    for (const auto& [name, series] : record.inputs) add(series.values->data(), series.values->size());
  }
  return Fingerprint(bytes);
}

json Finite(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }
double NumberOf(const json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

SavedFits::SavedFits(std::string file, bool resume, const EstimationProblem& problem)
    : file_(std::move(file)), fingerprint_(FingerprintOf(problem)) {
  if (!resume) return;
  const std::optional<std::string> text = ReadTextFile(file_);
  const json saved = text ? json::parse(*text, nullptr, false) : json();
  if (!saved.is_object() || saved.value("fingerprint", json()) != fingerprint_) return;
  try {
    for (const auto& [stage, list] : saved.at("screening").items()) {
      std::vector<Screened> screened;
      for (const json& one : list) {
        screened.push_back({one.at("candidate"), one.at("parameters"), NumberOf(one.at("chi2")),
                            NumberOf(one.at("criterion")), one.at("left"), one.at("closest"),
                            NumberOf(one.at("smallest")), 0, one.at("promising")});
      }
      screenings_.emplace_back(stage, std::move(screened));
    }
    for (const auto& [name, parameters] : saved.at("optima").items()) optima_.emplace_back(name, parameters);
  } catch (const json::exception&) {  // a file of another version: begin anew
    screenings_.clear();
    optima_.clear();
  }
}

std::vector<Screened> SavedFits::Screening(const std::string& stage) const {
  for (const auto& [name, screened] : screenings_) {
    if (name == stage) return screened;
  }
  return {};
}

void SavedFits::KeepScreening(const std::string& stage, const std::vector<Screened>& screened) {
  screenings_.emplace_back(stage, screened);
  Write();
}

bool SavedFits::Recall(std::vector<EffectInstance>& effects) const {
  for (const auto& [name, parameters] : optima_) {
    if (name != NameOf(effects) || parameters.size() != effects.size()) continue;
    for (std::size_t i = 0; i < effects.size(); ++i) {
      if (parameters[i].size() != effects[i].parameters.size()) return false;
    }
    for (std::size_t i = 0; i < effects.size(); ++i) effects[i].parameters = parameters[i];
    return true;
  }
  return false;
}

void SavedFits::Keep(const std::vector<EffectInstance>& effects) {
  std::vector<std::vector<double>> parameters;
  for (const EffectInstance& instance : effects) parameters.push_back(instance.parameters);
  std::erase_if(optima_, [&](const auto& entry) { return entry.first == NameOf(effects); });
  optima_.emplace_back(NameOf(effects), std::move(parameters));
  Write();
}

void SavedFits::Write() const {
  json saved = {{"fingerprint", fingerprint_}, {"screening", json::object()}, {"optima", json::object()}};
  for (const auto& [stage, list] : screenings_) {
    json& out = saved["screening"][stage] = json::array();
    for (const Screened& one : list) {
      out.push_back({{"candidate", one.candidate},
                     {"parameters", one.parameters},
                     {"chi2", Finite(one.chi2)},
                     {"criterion", Finite(one.criterion)},
                     {"left", one.left},
                     {"closest", one.closest},
                     {"smallest", Finite(one.smallest)},
                     {"promising", one.promising}});
    }
  }
  for (const auto& [name, parameters] : optima_) saved["optima"][name] = parameters;
  // A state that cannot be written costs time later, not a result now: the result's own files report a full disk.
  (void)WriteFileAtomically(file_, JsonText(saved));
}

}  // namespace dynoproof::diagnosis
