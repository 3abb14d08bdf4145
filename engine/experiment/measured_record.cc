#include "experiment/measured_record.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/calendar.h"
#include "experiment/why.h"
#include "score/nrmse.h"

namespace dynoproof {
namespace {

template <class T>
const T* Find(const std::vector<std::pair<std::string, T>>& entries, const std::string& name) {
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.first == name; });
  return found == entries.end() ? nullptr : &found->second;
}

std::string Beside(const std::string& folder, const std::string& file) {
  return file.empty() ? "" : (std::filesystem::path(folder) / file).lexically_normal().string();
}

template <class Lines>
std::vector<SignalName> Names(const Lines& lines) {
  std::vector<SignalName> names;
  for (const auto& line : lines) names.push_back({.name = line.name, .unit = line.unit});
  return names;
}

}  // namespace

std::string HashOf(const std::string& file) {
  // A pipe that nobody writes to, and a device, have no end.
  if (std::error_code error; !std::filesystem::is_regular_file(file, error)) return "";
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return "";
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr);
  std::vector<char> buffer(1 << 20);
  while (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || stream.gcount() > 0) {
    EVP_DigestUpdate(context.get(), buffer.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) return "";
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int length = 0;
  EVP_DigestFinal_ex(context.get(), digest, &length);
  std::string text;
  for (unsigned int i = 0; i < length; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

void AcceptedGap::Check(Faults& faults) const {
  if (!IsDay(until)) faults.At("until", fmt::format("\"{}\" is no day", until), "write \"2026-12-31\"");
  if (reason.find_first_not_of(" \t\n") == std::string::npos) faults.At("reason", "is empty", "say why");
}

std::vector<SignalName> InputNames(const Rig& rig) { return Names(rig.inputs); }

std::vector<SignalName> OutputNames(const Rig& rig) {
  std::vector<SignalName> names = Names(rig.outputs);
  const std::vector<double> known_from = rig.KnownFrom();
  for (std::size_t i = 0; i < names.size(); ++i) names[i].known_from_s = known_from[i];
  return names;
}

std::string Today() {
  return fmt::format("{:%Y-%m-%d}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

std::optional<RecordSettings> ReadRecordSettings(const Plan& plan, const Rig& rig, Diagnostics& diagnostics) {
  const Value* table = plan.root.Find("record");
  if (table == nullptr) return std::nullopt;
  if (!table->is_table()) {
    diagnostics.Error(table->where(), "\"record\" is " + table->KindName(),
                      "write [record] with nrmse = { OUTPUT = ... }");
    return std::nullopt;
  }
  RecordSettings settings;
  if (!ReadParams(*table, settings, diagnostics, "record")) return std::nullopt;
  const auto known = [&](const char* key, const std::string& name) {
    if (FindOutput(rig, name) >= 0) return;
    diagnostics.Error(table->Find(key)->where(), fmt::format("there is no output \"{}\" to limit", name));
  };
  for (const auto& [name, limit] : settings.nrmse) known("nrmse", name);
  for (const auto& [name, gap] : settings.accepted) {
    known("accepted", name);
    if (Find(settings.nrmse, name) != nullptr) continue;
    diagnostics.Error(table->Find("accepted")->where(), fmt::format("{} has no limit of its own to fall back to", name),
                      fmt::format("add nrmse.{} = ...", name));
  }
  if (settings.file.empty()) {
    if (!settings.hash.empty() || !settings.map.empty()) {
      diagnostics.Error(table->where(), "hash and map belong to a file", "add file = \"...\"");
    }
  } else if (settings.hash.empty()) {
    const std::string folder = std::filesystem::path(plan.file).parent_path().string();
    const std::string hash = HashOf(Beside(folder, settings.file));
    diagnostics.Error(table->Find("file")->where(), "the record has no hash: a change of it would go unseen",
                      hash.empty() ? "add hash = \"...\", its SHA-256" : fmt::format("add hash = \"{}\"", hash));
  }
  return settings;
}

Result<MappedRecord> OpenRecord(const RecordSettings& settings, const std::string& folder, const Rig& rig) {
  const std::string file = Beside(folder, settings.file);
  const auto wrong = [&file](std::string why) {
    return Failure{.message = std::move(why), .signal = file, .exit_code = 1};
  };
  const std::string hash = HashOf(file);
  if (hash.empty()) {
    return wrong(
        fmt::format("the record \"{}\" is missing or cannot be read: put it beside the scenario, or mend "
                    "file in [record]",
                    settings.file));
  }
  if (hash != settings.hash) {
    return wrong(
        fmt::format("the record \"{}\" is another one than the scenario was written for: [record] expects the SHA-256 "
                    "{}, the file has {}. Put the record back that was meant, or, if the new one is meant, write "
                    "hash = \"{}\"",
                    settings.file, settings.hash, hash, hash));
  }
  Diagnostics diagnostics;
  std::optional<MappedRecord> mapped =
      OpenRecord(file, Beside(folder, settings.map), InputNames(rig), OutputNames(rig), diagnostics);
  if (!mapped) return wrong(diagnostics.Format());
  mapped->file = file;
  return std::move(*mapped);
}

std::vector<score::Check> CompareWithRecord(const Rig& rig, const Samples& samples, const MappedRecord& data,
                                            const RecordSettings& settings, const std::string& today,
                                            Figures& figures) {
  std::vector<score::Check> checks;
  for (const auto& [name, series] : data.outputs) {
    score::NrmseOptions options;
    std::string origin = "no limit stated in [record] nrmse: a tenth of the signal's own spread";
    options.limit = 0.1;
    if (const double* limit = Find(settings.nrmse, name)) {
      options.limit = *limit;
      origin = "stated in [record] of the scenario";
    }
    if (const AcceptedGap* gap = Find(settings.accepted, name)) {
      const bool holds = today <= gap->until;  // ISO days sort as texts
      const std::string own = fmt::format("own limit {:.3g}", options.limit);
      if (holds) options.limit = gap->nrmse;
      origin =
          holds ? fmt::format("gap accepted until {}: {} ({})", gap->until, gap->reason, own)
                : fmt::format("the gap was accepted until {} ({}): the {} holds again", gap->until, gap->reason, own);
    }
    options.constant_limit = options.limit;
    const score::Series measured{*series.time, *series.values};
    const score::Series simulated = SeriesOf(samples, rig, name, &options.nominal);
    const score::NrmseResult result = score::Nrmse(measured, simulated, options);
    score::Check check = score::NrmseCheck(result, options, "record " + name, origin);
    check.kind = check.stated = "record";
    if (result.nrmse) figures[name + ".nrmse"] = {*result.nrmse, "1"};
    if (score::FaultOf(measured, "record").empty()) {
      const std::string& unit = rig.outputs[FindOutput(rig, name)].unit;
      const double allowed = options.limit * score::StandardDeviation(*series.values);
      if (check.verdict != score::Verdict::kPass) Why(measured, simulated, allowed, unit).To(check);
      check.evidence =
          score::BandEvidence({name, unit, "record", "run"}, score::Evidence::Rule::kRms, measured, simulated, allowed);
    }
    if (const std::string few = TooFew(series.values->size()); !few.empty()) {
      check.verdict = score::Verdict::kInconclusive;
      check.explanation = few;
    }
    checks.push_back(std::move(check));
  }
  if (data.outputs.empty()) return checks;
  for (const auto& [name, limit] : settings.nrmse) {
    if (data.outputs.contains(name)) continue;
    score::Check& missing = checks.emplace_back();
    missing.name = "record " + name;
    missing.kind = "record";
    missing.explanation = "[record] limits this output, but the record does not have it";
  }
  return checks;
}

}  // namespace dynoproof
