#include "trace/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>
#include <cmath>
#include <set>

namespace dynoproof::trace {
namespace {

template <class Entries>
auto FindEntry(Entries& entries, std::string_view name) {
  return std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.first == name; });
}

template <class Entries, class Value>
void SetEntry(Entries& entries, std::string_view name, const Value& value) {
  const auto found = FindEntry(entries, name);
  if (found == entries.end()) {
    entries.emplace_back(std::string(name), value);
  } else {
    found->second = value;
  }
}

/// Counts what is not finite in `values` and appends a sentence on it. Returns whether all is finite.
bool CheckFinite(const std::string& what, std::span<const double> values, std::span<const double> time,
                 std::vector<std::string>& problems) {
  std::size_t count = 0, first = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    if (count++ == 0) first = i;
  }
  if (count == 0) return true;
  const bool has_time = first < time.size() && std::isfinite(time[first]);
  problems.push_back(fmt::format("{}: {} of {} values {} not finite, the first ({}) at row {}{}", what, count,
                                 values.size(), count == 1 ? "is" : "are", values[first], first,
                                 has_time ? fmt::format(", t = {:.9g} s", time[first]) : ""));
  return false;
}

void CheckTime(const std::string& what, std::span<const double> time, std::vector<std::string>& problems) {
  if (time.empty()) {
    problems.push_back(fmt::format("{}: no samples", what));
    return;
  }
  if (!CheckFinite(what, time, {}, problems)) return;
  std::size_t count = 0, first = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (time[i] > time[i - 1]) continue;
    if (count++ == 0) first = i;
  }
  if (count == 0) return;
  problems.push_back(fmt::format("{}: does not rise at {} of {} steps, first from {:.17g} s to {:.17g} s at row {}",
                                 what, count, time.size() - 1, time[first - 1], time[first], first));
}

bool IsAbsolutePath(std::string_view word) {
  if (word.size() >= 2 && word[0] == '/' && (std::isalnum(static_cast<unsigned char>(word[1])) || word[1] == '.')) {
    return true;
  }
  return word.size() >= 3 && std::isalpha(static_cast<unsigned char>(word[0])) && word[1] == ':' &&
         (word[2] == '\\' || word[2] == '/');
}

/// Calls visit(word) for each piece of `text` between the separators.
template <class Visit>
void ForEachWord(std::string_view text, std::string_view separators, Visit visit) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(separators), text.size());
    if (end > 0) visit(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

}  // namespace

std::string_view ToText(Interpolation interpolation) {
  return interpolation == Interpolation::kHold ? "hold" : "linear";
}

std::optional<Interpolation> ParseInterpolation(std::string_view text) {
  if (text == "linear") return Interpolation::kLinear;
  if (text == "hold") return Interpolation::kHold;
  return {};
}

void Provenance::Set(std::string_view name, std::string_view value) { SetEntry(texts, name, std::string(value)); }

void Provenance::SetCounter(std::string_view name, std::int64_t value) { SetEntry(counters, name, value); }

std::optional<std::string> Provenance::Text(std::string_view name) const {
  const auto found = FindEntry(texts, name);
  return found == texts.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::int64_t> Provenance::Counter(std::string_view name) const {
  const auto found = FindEntry(counters, name);
  return found == counters.end() ? std::nullopt : std::optional(found->second);
}

const Signal* Trace::Find(std::string_view name) const {
  const auto found = std::find_if(signals.begin(), signals.end(), [&](const Signal& s) { return s.name == name; });
  return found == signals.end() ? nullptr : &*found;
}

Signal* Trace::Find(std::string_view name) { return const_cast<Signal*>(std::as_const(*this).Find(name)); }

std::span<const double> Trace::TimeOf(const Signal& signal) const {
  assert(signal.time_base <= other_times.size());
  return signal.time_base == 0 ? time : other_times[signal.time_base - 1];
}

std::vector<std::string> Validate(const Trace& trace) {
  std::vector<std::string> problems;
  CheckTime("/time", trace.time, problems);
  for (std::size_t k = 0; k < trace.other_times.size(); ++k) {
    CheckTime(fmt::format("/time_{}", k + 1), trace.other_times[k], problems);
  }
  std::set<std::string_view> names;
  for (const Signal& signal : trace.signals) {
    const std::string what = fmt::format("signal \"{}\"", signal.name);
    if (signal.name.empty() || signal.name == "." || signal.name == ".." ||
        signal.name.find_first_of(std::string_view("/\0", 2)) != std::string::npos) {
      problems.push_back(fmt::format("{}: not a name a file can hold (empty, \".\", \"..\" or with a \"/\")", what));
    }
    if (!names.insert(signal.name).second) problems.push_back(fmt::format("{}: there are two of this name", what));
    if (!(std::isfinite(signal.nominal) && signal.nominal > 0.0)) {
      problems.push_back(fmt::format("{}: nominal is {}, it must be finite and > 0", what, signal.nominal));
    }
    if (signal.time_base > trace.other_times.size()) {
      problems.push_back(fmt::format("{}: time base {} does not exist", what, signal.time_base));
      continue;
    }
    const std::span<const double> time = trace.TimeOf(signal);
    if (signal.values.size() != time.size()) {
      problems.push_back(fmt::format("{}: {} values for {} time stamps", what, signal.values.size(), time.size()));
    }
    CheckFinite(what, signal.values, time, problems);
  }
  return problems;
}

std::vector<std::string> ValidateProvenance(const Provenance& provenance) {
  static constexpr std::array<std::string_view, 10> kForbidden = {
      "clock", "date", "duration", "elapsed", "host", "hostname", "timestamp", "user", "wall", "walltime"};
  std::vector<std::string> problems;
  std::set<std::string_view> names;
  const auto check_name = [&](std::string_view name) {
    if (name.empty()) problems.push_back("provenance: an entry without a name");
    if (!names.insert(name).second)
      problems.push_back(fmt::format("provenance \"{}\": there are two of this name", name));
    ForEachWord(name, "_-. ", [&](std::string_view word) {
      if (std::find(kForbidden.begin(), kForbidden.end(), word) == kForbidden.end()) return;
      problems.push_back(fmt::format("provenance \"{}\": the same run must give the same bytes, so no {}", name, word));
    });
  };
  for (const auto& [name, text] : provenance.texts) {
    check_name(name);
    ForEachWord(text, " \t\n\"'=,;", [&, key = std::string_view(name)](std::string_view word) {
      if (!IsAbsolutePath(word)) return;
      problems.push_back(fmt::format("provenance \"{}\": holds the absolute path \"{}\"", key, word));
    });
  }
  for (const auto& entry : provenance.counters) check_name(entry.first);
  return problems;
}

}  // namespace dynoproof::trace
