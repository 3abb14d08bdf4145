// One figure of one night, and how the JSON files of a night are taken apart into such figures.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"

namespace dynoproof::history {

/// How a change of a series is to be taken.
enum class Sense { kLessIsBetter, kMoreIsBetter, kNeither };

struct Reading {
  std::string series;           // "score/r2r/soft_rotor_setup_1/golden T_shaft"
  std::optional<double> value;  // nothing: not a finite number, or what was to be measured went wrong
  std::string unit;
  bool scatters = false;  // a time; else the figure repeats exactly on one build
  Sense sense = Sense::kNeither;
  /// A smaller change is nobody's business: relative for what scatters, else absolute.
  double relevant = 0.0;
};

/// The readings of one document: that of `run`, of `bench`, of ci/check_budgets.py, of bench/robustness, of
/// ci/coverage.sh (gcovr's summary), of a Google Benchmark program. Times come in ns, whatever unit a foreign program chose. Fails (exit code 2) on any other, naming
/// what was expected.
Result<std::vector<Reading>> Readings(const nlohmann::json& document);

/// The document of a text, null where it stands for no number: some programs, Google Benchmark among them, write NaN
/// and Infinity, which JSON has no words for. Discarded where the text is no JSON even so.
nlohmann::json ParseResult(std::string text);

}  // namespace dynoproof::history
