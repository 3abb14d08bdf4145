#include "diagnosis/extension_gain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/report.h"
#include "experiment/prepare.h"

namespace dynoproof::diagnosis {
namespace {

// A signal that the extension does not touch is computed in another order: no gain and no loss [NRMSE].
constexpr double kRoundOff = 1e-9;

bool Gains(const SignalGain& gain) { return gain.lower > kRoundOff; }

Result<RecordGains> GainsIn(const MappedRecord& record, bool holdout, const Plan& nominal, Plan extended,
                            const Registry& registry) {
  RecordGains result{record.file, holdout, {}};
  if (record.outputs.empty()) return result;
  // The nominal plan's study serves both, so that both are compared over the same rows.
  const EstimationProblem problem(nominal, {record}, registry);
  StartFromRecord(record, registry, extended);
  auto gains = MeasureGains(problem, problem.plan(), extended);
  if (!gains.ok()) return gains.failure();
  result.gains = *std::move(gains);
  return result;
}

}  // namespace

std::string Lacking(const std::vector<RecordGains>& records) {
  bool gained = false;
  for (const RecordGains& record : records) {
    if (record.gains.empty())
      return fmt::format("{}: nothing compared, no output of the scenario has ten samples in it", record.file);
    for (const auto& [name, gain] : record.gains) {
      const double numbers[] = {gain.before, gain.after, gain.lower, gain.upper};
      if (!std::all_of(std::begin(numbers), std::end(numbers), [](double x) { return std::isfinite(x); }))
        return fmt::format("{}: the gain in {} is no number", record.file, name);
      if (gain.upper < -kRoundOff) return fmt::format("{}: {} is foretold worse", record.file, name);
      gained = gained || (record.holdout && Gains(gain));
    }
  }
  return gained ? "" : "no signal of the hold-out is foretold better: every interval includes zero";
}

Result<ExtensionGain> WeighExtension(const Plan& nominal, const Plan& extended, const MappedRecord& holdout,
                                     const std::vector<MappedRecord>& others, const Registry& registry) {
  ExtensionGain extension;
  std::vector<const MappedRecord*> records = {&holdout};
  for (const MappedRecord& other : others) records.push_back(&other);
  for (const MappedRecord* record : records) {
    Result<RecordGains> gains = GainsIn(*record, record == &holdout, nominal, extended, registry);
    if (!gains.ok()) return gains.failure();
    extension.records.push_back(*std::move(gains));
  }
  extension.lacking = Lacking(extension.records);
  return extension;
}

nlohmann::json ToJson(const ExtensionGain& extension) {
  nlohmann::json out = nlohmann::json::array();
  for (const RecordGains& one : extension.records)
    out.push_back({{"record", one.file}, {"holdout", one.holdout}, {"gain", ToJson(one.gains, true)}});
  return out;
}

std::string ToTable(const ExtensionGain& extension) {
  std::size_t width = 6;
  for (const RecordGains& one : extension.records) width = std::max(width, one.file.size());
  std::string text = fmt::format("  {:<{}}  {:<12}{:>12}{:>12}{:>24}\n", "record", width, "signal", "NRMSE before",
                                 "after", "gain, 95 %");
  for (const RecordGains& one : extension.records) {
    for (const auto& [name, gain] : one.gains)
      text += fmt::format("  {:<{}}  {:<12}{:>12.4g}{:>12.4g}{:>12.4g} ... {:.4g}{}\n", one.file, width, name,
                          gain.before, gain.after, gain.lower, gain.upper, one.holdout ? "  hold-out" : "");
    if (one.gains.empty()) text += fmt::format("  {:<{}}  nothing compared\n", one.file, width);
  }
  return text;
}

std::string GainSentence(const ExtensionGain& extension) {
  std::vector<std::string> parts;
  for (const RecordGains& one : extension.records) {
    for (const auto& [name, gain] : one.gains) {
      if (one.holdout && Gains(gain))
        parts.push_back(fmt::format("{} from {:.3g} to {:.3g} (gain {:.3g} ... {:.3g})", name, gain.before, gain.after,
                                    gain.lower, gain.upper));
    }
  }
  const std::string file = extension.records.empty() ? "" : extension.records.front().file;
  return fmt::format("NRMSE on the hold-out {}: {}; intervals are 95 %.", file, fmt::join(parts, ", "));
}

}  // namespace dynoproof::diagnosis
