// Fits numbers of a scenario to records: values, intervals, and which of them the data cannot tell apart.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identification/multi_start.h"

namespace dynoproof::identification {

struct IdentifyOptions {
  std::vector<FreeKey> keys;
  std::string method = "free_run";  // one of Methods()
  int starts = 4;
  std::function<void(double)> progress = [](double) {};
};

/// How a model was run beside the record where its numbers were taken.
struct CorrectedLevel {
  std::optional<double> memory_s;  // nothing: the free run
  double share = 0.0;              // of the driving forces, that the model is taken not to know
  double nrmse_before = 0.0, nrmse_after = 0.0;
  bool at_noise = false;         // nothing else is left
  std::int64_t simulations = 0;  // of all levels
};

struct IdentifiedValue {
  std::string key;
  double nominal = 0.0, value = 0.0;
  std::optional<std::pair<double, double>>
      interval;  // 95 %; none on a bound, not told apart, as wide as the bounds, and by methods that know none
  bool on_bound = false;
};
/// A number in one record, where [prior] says that it differs from record to record.
struct ValueOfRecord {
  std::size_t record = 0;
  std::string file, key;
  double factor = 1.0;                 // on the common value
  std::pair<double, double> interval;  // 95 %, of the factor
};
/// Features of the records that a method has read off them before its fit, as resonances.
struct Sighting {
  std::string name;                                    // as the JSON has it
  std::map<std::string, std::vector<double>> numbers;  // by their names, which carry the units
  std::string line;                                    // of the table, with its end
};
struct Identified {
  std::vector<IdentifiedValue> values;
  std::vector<ValueOfRecord> of_records;
  Eigen::MatrixXd covariance;  // of the values, corrected for the colour of the residual (sandwich); empty: none, NaN:
                               // not told apart
  std::vector<double> singular;                 // of the Jacobian in the search's own numbers, largest first; by stage
  std::vector<std::vector<std::string>> alike;  // keys that only a combination of is seen
  int starts = 0, converged = 0;        // starts that reached the best cost within 0.1 %; of several stages the fewest
  std::optional<CorrectedLevel> level;  // at which a corrected fit is judged
  std::optional<Sighting> sighting;     // by methods that tell of one
  double nrmse_before = 0.0, nrmse_after = 0.0;  // of the free run, by any method
  std::vector<std::string> notes;                // what a reader should know
  std::vector<std::string> doubts;  // why the numbers are worth nothing: on a bound, worse than before, ...
};

/// A way from records to numbers. `fit` fills what it finds of the axes' numbers into `result`: values, covariance, singular,
/// alike, converged, level, sighting. `axes` stand in the order of `options.keys`.
struct Method {
  std::string help;  // what is made small, for `identify --help`
  Status (*fit)(const EstimationProblem& problem, const std::vector<Axis>& axes, const IdentifyOptions& options,
                Identified& result);
};
/// By name: corrected, free_run, response, spectrum, and what layers above brought along.
const std::map<std::string, Method>& Methods();
/// How a layer above brings a method along, before the program's commands are made. Calling it again changes nothing.
void AddMethod(const std::string& name, Method method);

/// Adds what an optimum tells of the axes' numbers to `result`: values, singular values, keys that are not told apart, the
/// starts that reached it. (J'J)^-1 of the axes' own numbers, p x p.
Eigen::MatrixXd Take(const Optimum& at, const std::vector<Axis>& axes, Identified& result);

/// Fails as the method does: by runs as Minimise, by response as MeasuredResponse, too.
Result<Identified> Identify(const Plan& plan, const std::vector<MappedRecord>& data, const Registry& registry,
                            const IdentifyOptions& options);

/// The same; where nobody says what inputs do between their samples, and the fit leaves something, with all that they may
/// do, of which the best fit stands.
Result<Identified> IdentifyBetween(const Plan& plan, const std::vector<MappedRecord>& data, const Registry& registry,
                                   const IdentifyOptions& options);

/// What records may be of which a fit accounts for nothing, each tried by a fit of its own: in another unit, with another
/// sign, with two signals exchanged, or of another machine. Empty where the fit accounts for them.
std::vector<std::string> WhatItMayBe(const Plan& plan, const std::vector<MappedRecord>& data, const Registry& registry,
                                     const IdentifyOptions& options, const Identified& identified);

nlohmann::json ToJson(const Identified& identified);
std::string ToTable(const Identified& identified);
/// How such a file begins.
inline constexpr std::string_view kIdentified = "# With numbers that were identified.\n";
/// A scenario file that includes another: with these values, and with what `overrides` (KEY=VALUE) changed in it.
/// `included` is that file as it stands there, `written` the same with the overrides, `plan` that with its effects applied. Where one of them
/// has changed a number that is written here, it would act on that once more: the file then has all sections that
/// effects have changed as they are, and no effect.
std::string ToScenario(const Identified& identified, const Plan& plan, const Plan& written, const Plan& included,
                       const std::string& include, const std::vector<std::string>& overrides);

}  // namespace dynoproof::identification
