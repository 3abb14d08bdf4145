// A trace: everything one run leaves behind, as values. How it looks on disk is said in trace_io.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dynoproof::trace {

/// What a signal does between two samples.
enum class Interpolation { kLinear, kHold };

/// "linear" or "hold", as files have it.
std::string_view ToText(Interpolation interpolation);
/// The inverse of ToText; nothing for any other word.
std::optional<Interpolation> ParseInterpolation(std::string_view text);

/// One recorded quantity.
struct Signal {
  std::string name;
  std::string unit = {};
  std::string description = {};
  double nominal = 1.0;  // a typical magnitude in `unit`, > 0: what a deviation is small or large against
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<double> values = {};
  std::size_t time_base = 0;  // 0: Trace::time; k > 0: Trace::other_times[k - 1]
  bool nominal_known = true;  // false: the file that it was read from states none, and `nominal` says nothing

  bool operator==(const Signal&) const = default;
};

/// Where a trace comes from: texts (version, commit, compiler, solver, CPU feature class) and counters (seed, steps,
/// failed steps, events), each in the order of their first mention. The same run on the same build must give the same
/// bytes, hence no clock, no duration, no absolute path; ValidateProvenance() looks out for them.
struct Provenance {
  std::vector<std::pair<std::string, std::string>> texts;
  std::vector<std::pair<std::string, std::int64_t>> counters;

  /// Adds an entry, or replaces the value of the entry with this name.
  void Set(std::string_view name, std::string_view value);
  void SetCounter(std::string_view name, std::int64_t value);
  /// The value, or nothing.
  std::optional<std::string> Text(std::string_view name) const;
  std::optional<std::int64_t> Counter(std::string_view name) const;

  bool operator==(const Provenance&) const = default;
};

/// Samples of one run. Signals of another rate have their own time base, shared by all of that rate; nothing is ever
/// resampled on the way to or from a file.
struct Trace {
  std::vector<double> time;                      // seconds, strictly rising
  std::vector<std::vector<double>> other_times;  // seconds, strictly rising; see Signal::time_base
  std::vector<Signal> signals;
  std::string scenario;  // the resolved TOML
  Provenance provenance;

  /// The signal of this name, or nullptr.
  const Signal* Find(std::string_view name) const;
  Signal* Find(std::string_view name);
  /// The time stamps of a signal of this trace [s].
  std::span<const double> TimeOf(const Signal& signal) const;

  bool operator==(const Trace&) const = default;
};

/// What is wrong with the data, one sentence each; empty if nothing is. Checked: at least one sample, time finite and
/// strictly rising, every signal with a known time base, of the same length as it and finite, nominal finite and > 0,
/// names unique and fit for a file (not empty, no "/", not "." or "..").
std::vector<std::string> Validate(const Trace& trace);

/// What a provenance must not hold: entries named after a clock, a duration, a host or a user, absolute paths, and
/// names used twice. One sentence each.
std::vector<std::string> ValidateProvenance(const Provenance& provenance);

}  // namespace dynoproof::trace
