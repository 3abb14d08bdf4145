#include "campaign/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/atomic_file.h"
#include "base/cpu.h"
#include "base/json_text.h"
#include "base/text.h"

namespace dynoproof::campaign {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kDigits = 9;  // runs sort by name

std::optional<Range> ParseName(const fs::path& path) {
  const std::string stem = path.stem().string();
  Range range;
  const char* const end = stem.data() + stem.size();
  const auto first = std::from_chars(stem.data(), end, range.begin);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != '-') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, range.end);
  if (second.ec != std::errc() || second.ptr != end || range.begin < 0 || range.end <= range.begin) return std::nullopt;
  return range;
}

/// The files of one kind, by range.
std::vector<std::pair<Range, std::string>> FilesIn(const fs::path& folder) {
  std::vector<std::pair<Range, std::string>> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename().string().starts_with('.')) continue;  // of a killed writer
    if (const auto range = ParseName(it->path())) files.emplace_back(*range, it->path().string());
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) {
    return a.first.begin != b.first.begin ? a.first.begin < b.first.begin : a.first.end < b.first.end;
  });
  return files;
}

std::optional<score::Verdict> ParseVerdict(const std::string& text) {
  using score::Verdict;
  for (const Verdict verdict : {Verdict::kPass, Verdict::kFail, Verdict::kBroken, Verdict::kInconclusive}) {
    if (text == score::ToString(verdict)) return verdict;
  }
  return std::nullopt;
}

Failure Bad(const std::string& file, const std::string& message) {
  return {message + "; remove the file and go on with --resume", file, {}, 2};
}

Failure OfAnother(const std::string& file) {
  return {"holds rows of another campaign, scenario or build; take another --out, or remove the folder", file, {}, 2};
}

}  // namespace

std::string ToLine(const Row& row) {
  json figures = json::array();
  for (const double value : row.figures) figures.push_back(std::isfinite(value) ? json(value) : json(nullptr));
  const json used = std::isfinite(row.used) ? json(row.used) : json(nullptr);
  return JsonText(json{row.run, score::ToString(row.verdict), std::move(figures), row.why, used, row.nearest});
}

std::optional<Row> ParseRow(std::string_view line) {
  const json parsed = json::parse(line, nullptr, false);
  if (!parsed.is_array() || parsed.size() != 6 || !parsed[0].is_number_integer() || !parsed[1].is_string() ||
      !parsed[2].is_array() || !parsed[3].is_string() || !(parsed[4].is_number() || parsed[4].is_null()) ||
      !parsed[5].is_string())
    return std::nullopt;
  const auto verdict = ParseVerdict(parsed[1].get<std::string>());
  if (!verdict) return std::nullopt;
  Row row{parsed[0].get<std::int64_t>(), *verdict, {}, parsed[3].get<std::string>()};
  if (parsed[4].is_number()) row.used = parsed[4].get<double>();
  row.nearest = parsed[5].get<std::string>();
  for (const json& value : parsed[2]) {
    if (!value.is_number() && !value.is_null()) return std::nullopt;
    row.figures.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
  }
  return row;
}

std::string RowStore::FileOf(const char* kind, Range range, const char* ending) const {
  return (fs::path(folder_) / kind / fmt::format("{:0{}}-{:0{}}.{}", range.begin, kDigits, range.end, kDigits, ending))
      .string();
}

Status RowStore::Write(std::span<const Row> rows, std::span<const Cost> costs) const {
  if (rows.empty()) return {};
  const Range range{rows.front().run, rows.back().run + 1};
  std::string lines;
  std::string prices = "run,wall_s,cpu_s,peak_MB\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    lines += ToLine(rows[i]) + "\n";
    prices += fmt::format("{},{:.6f},{:.6f},{:.1f}\n", rows[i].run, costs[i].wall_s, costs[i].cpu_s, costs[i].peak_MB);
  }
  if (Status failed = WriteFileAtomically(FileOf("costs", range, "csv"), prices)) return failed;
  const std::string text = JsonText(json{{"campaign", fingerprint_},
                                         {"cpu", CpuFeatureClass()},
                                         {"runs", rows.size()},
                                         {"fingerprint", Fingerprint(lines)}}) +
                           "\n" + lines;
  return WriteFileAtomically(FileOf("rows", range, "jsonl"), text);  // last: the piece is there from now on
}

std::vector<Range> RowStore::Stored() const {
  std::vector<Range> ranges;
  for (const auto& [range, file] : FilesIn(fs::path(folder_) / "rows")) ranges.push_back(range);
  return ranges;
}

std::vector<Range> RowStore::Missing() const {
  std::vector<Range> missing;
  std::int64_t next = 0;
  for (const Range& range : Stored()) {
    if (range.begin > next) missing.push_back({next, std::min(range.begin, runs_)});
    next = std::max(next, range.end);
  }
  if (next < runs_) missing.push_back({next, runs_});
  return missing;
}

Status RowStore::BelongsElsewhere() const {
  const auto files = FilesIn(fs::path(folder_) / "rows");
  if (files.empty()) return {};
  const std::string text = ReadTextFile(files.front().second).value_or("");
  const json header = json::parse(text.substr(0, text.find('\n')), nullptr, false);
  if (!header.is_object() || header.value("campaign", json()) == fingerprint_) return {};
  return OfAnother(files.front().second);
}

Result<Rows> RowStore::Merge() const {
  Rows merged;
  std::vector<std::string> from;  // files, for messages
  std::vector<std::uint32_t> source(static_cast<std::size_t>(runs_));
  std::vector<bool> there(static_cast<std::size_t>(runs_));
  merged.rows.resize(static_cast<std::size_t>(runs_));
  std::vector<std::string> classes;
  for (const auto& [range, file] : FilesIn(fs::path(folder_) / "rows")) {
    if (range.end > runs_) return Bad(file, fmt::format("the campaign has {} runs only", runs_));
    const std::optional<std::string> text = ReadTextFile(file);
    if (!text) return Bad(file, "cannot be read");
    std::istringstream lines(*text);
    std::string line;
    std::getline(lines, line);
    const json header = json::parse(line, nullptr, false);
    if (!header.is_object() || !header.value("cpu", json()).is_string())
      return Bad(file, "is damaged: it has no header");
    if (header.value("campaign", json()) != fingerprint_) return OfAnother(file);
    // Files of an earlier version have none.
    if (header.contains("fingerprint") &&
        header["fingerprint"] != Fingerprint(std::string_view(*text).substr(line.size() + 1)))
      return Bad(file, "holds other rows than were written: somebody changed it");
    classes.push_back(header["cpu"].get<std::string>());
    from.push_back(file);
    std::int64_t next = range.begin;
    while (std::getline(lines, line)) {
      std::optional<Row> row = ParseRow(line);
      if (!row || row->run != next || next >= range.end) return Bad(file, fmt::format("is damaged at run {}", next));
      const auto i = static_cast<std::size_t>(next++);
      if (there[i] && ToLine(merged.rows[i]) != line) {
        return Failure{fmt::format("run {} came out differently in {}: the same run must give the same row (are build "
                                   "and processor the same everywhere?)",
                                   row->run, from[source[i]]),
                       file};
      }
      there[i] = true;
      source[i] = static_cast<std::uint32_t>(from.size() - 1);
      merged.rows[i] = *std::move(row);
    }
    if (next != range.end) return Bad(file, fmt::format("is cut short at run {}", next));
  }
  const auto gap = std::find(there.begin(), there.end(), false);
  if (gap != there.end()) {
    return Failure{fmt::format("run {} is missing, and {} more; go on with --resume", gap - there.begin(),
                               std::count(gap, there.end(), false) - 1),
                   folder_};
  }
  std::sort(classes.begin(), classes.end());
  classes.erase(std::unique(classes.begin(), classes.end()), classes.end());
  merged.cpu = fmt::format("{}", fmt::join(classes, ", "));
  return merged;
}

std::vector<Cost> RowStore::Costs() const {
  std::vector<Cost> costs(static_cast<std::size_t>(runs_));
  for (const auto& [range, file] : FilesIn(fs::path(folder_) / "costs")) {
    std::istringstream lines(ReadTextFile(file).value_or(""));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      long long run = -1;
      Cost cost;
      if (std::sscanf(line.c_str(), "%lld,%lf,%lf,%lf", &run, &cost.wall_s, &cost.cpu_s, &cost.peak_MB) != 4) continue;
      if (run >= 0 && run < runs_) costs[static_cast<std::size_t>(run)] = cost;
    }
  }
  return costs;
}

std::vector<Range> Cut(const std::vector<Range>& ranges, std::int64_t most) {
  std::vector<Range> pieces;
  for (const Range& range : ranges) {
    for (std::int64_t begin = range.begin; begin < range.end; begin += most)
      pieces.push_back({begin, std::min(begin + most, range.end)});
  }
  return pieces;
}

std::int64_t CountRuns(const std::vector<Range>& ranges) {
  std::int64_t count = 0;
  for (const Range& range : ranges) count += range.size();
  return count;
}

}  // namespace dynoproof::campaign
