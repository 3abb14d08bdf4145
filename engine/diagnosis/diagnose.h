// From records to a cause: what the simulation gets wrong, which effect accounts for it, what it gains on data that
// took no part in the choice - or that nothing accounts for it. METHOD.md has the stages, README.md the limits.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/status.h"
#include "diagnosis/conclusion.h"
#include "diagnosis/gain.h"
#include "diagnosis/journal.h"
#include "diagnosis/localisation.h"
#include "identification/residual_tests.h"

namespace dynoproof::diagnosis {

struct FoundParameter {
  std::string name, unit;
  double value = 0.0, lower = 0.0, upper = 0.0;  // 95 % interval
  /// The value fitted at each level, with the level's name. A cause has the same value at all of them.
  std::vector<std::pair<std::string, double>> by_level = {};

  /// One of the three, with two digits of what the interval leaves open.
  std::string Text(double number) const;
};
struct FoundEffect {
  std::string name, at;
  std::string description, law;      // "the nominal stiffness is off", "stiffness = nominal (1 + delta)"
  std::optional<double> confidence;  // ConfidenceOf(): of the verdict, the same for all effects that it shows
  std::vector<FoundParameter> parameters;
};
struct Seen {
  std::string name, at, unit;
  double smallest = 0.0;
};
/// An effect at a place that the records cannot show, and why.
struct NotTestable {
  std::string name, at, reason;
};
/// A line in the spectrum of what is left: hum, or a speed that nobody modelled.
struct LineLeft {
  std::string signal;
  double hz = 0.0, share = 0.0;  // of the whitened variance
};
/// What a main cause leaves of a signal.
struct Left {
  double nrmse = 0.0;
  WhereWrong where;
};
/// A candidate that was followed.
struct Considered {
  std::string name, at, why_not;  // why_not: empty of a cause
  std::string on_top_of = {};     // "backlash@shaft:k3": the effects that its model has beside
  double validation_nrmse = 0.0;  // RMS over the signals of what it leaves
  /// By level, the share that it removes of what the nominal model leaves beyond noise of the data that were fitted.
  std::vector<std::pair<std::string, double>> shares = {};
};
/// A nominal value that was fitted along.
struct Refitted {
  std::string path;
  double nominal = 0.0, value = 0.0, deviation = 0.0;  // deviation in spreads of the prior
  bool start = false;                                  // of the record, not of the model
};

struct Diagnosis {
  Conclusion verdict = Conclusion::kUnexplained;
  std::vector<FoundEffect> effects;
  std::vector<std::vector<std::string>> ambiguous_with;  // each a set of candidates that look alike
  std::vector<std::vector<FoundEffect>> instead;  // of such a set, the effects of every other cause than `effects`
  std::string experiment_text, experiment_scenario, extended_scenario;
  WhereWrong where;
  double noise_floor = 0.0;  // NRMSE that noise alone would leave; RMS over the signals
  bool at_noise_floor = false;
  ResidualTests tests;
  std::map<std::string, double> floor_by_signal, residual_by_signal;  // unit of the signal
  std::map<std::string, SignalGain> train, holdout;
  std::optional<Share> explained;  // on the hold-out
  std::map<std::string, double> given, released,
      with_cause;                    // NRMSE there, by signal; released: where it was asked for
  std::map<std::string, Left> left;  // by signal, of a main cause
  std::optional<double> horizon_s;   // how far ahead the model as given predicts to the noise
  /// Share of the driving forces that the model told of does not account for; 0: its free run is the likeliest.
  std::optional<double> unknown_forces;
  std::vector<LineLeft> lines;
  std::vector<NotTestable> not_testable;
  bool own_holdout = false;  // --holdout was given
  std::vector<Seen> would_have_seen;
  std::vector<Considered> considered;
  std::vector<Refitted> refitted;
  std::vector<std::string> notes;
  std::string reason;           // one sentence: why this verdict
  Journal journal;              // what was compared to decide it
  double simulations = 0.0;     // of all the data; parts count by their share
  bool search_complete = true;  // false: it ended where its budget did
};

struct DiagnoseOptions {
  std::string out = "out";                  // folder of extended.toml, separate.toml and the saved fits
  std::string scenario_file;                // what extended.toml includes
  std::vector<std::string> overrides = {};  // --set: KEY=VALUE that the plan has beyond that file
  bool resume = false;
  /// The search ends there with the best it has; the CPU time is that of the process, and unlimited where it is not stated.
  double most_simulations = 25000.0, most_cpu_s = std::numeric_limits<double>::infinity();
  std::function<void(const std::string& what, double fraction)> progress = [](const std::string&, double) {};
};

/// Samples of all outputs of all records together that a diagnosis looks at: 450 bytes each stay in memory, and 200 s
/// of two signals at 10 kHz tell a line's behaviour.
inline constexpr std::size_t kMostSamples = 4'000'000;
/// Cuts records that hold more, all to the same share; what to say about it, empty if there is nothing.
std::string KeepTo(std::size_t most, std::vector<MappedRecord>& records);

/// `plan`: nominal, its own effects applied. Fails where the nominal run breaks or a file cannot be written.
Result<Diagnosis> Diagnose(const Plan& plan, const std::vector<MappedRecord>& data,
                           const std::vector<MappedRecord>& holdout, const Registry& registry,
                           const DiagnoseOptions& options);

}  // namespace dynoproof::diagnosis
