// How far ahead a model predicts a record. A free run carries every error of the model along; a run that begins anew from
// the state that the record before it tells (prediction_windows.h) shows after which time the model is off. A model whose
// forces are wrong is off at once; one that only accumulates a small error is off late.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "diagnosis/terms.h"
#include "identification/estimation_problem.h"

namespace dynoproof::diagnosis {

struct PredictionLevel {
  std::optional<double> window_s;          // nothing: the free run
  std::map<std::string, double> nrmse;     // RMS error over the output's own spread, over all windows but the first
  std::map<std::string, double> by_noise;  // of records that the model itself made, with the same noise
  bool at_noise = false;                   // of every output
};

struct PredictionHorizon {
  std::vector<PredictionLevel> levels;  // windows from ten periods on, each sqrt(10) times as long, then the free run
  std::map<std::string, double> noise;  // of the outputs, over the same spread
  /// The longest window [s] up to which all errors are noise; the record's length where the free run's is, 0 where not even
  /// the shortest window's is.
  double horizon_s = 0.0;

  /// A table of a line per level, with what follows from it.
  std::string ToText() const;
};

/// `record`: mapped onto `plan`, which is the nominal model; no more than its first 20 000 periods are looked at.
/// Costs four observers and four runs per window. Nothing where no output moves, the record is shorter than five windows, or
/// the model has more than 40 states, as distributed rotors do; fails where a run breaks.
Result<std::optional<PredictionHorizon>> PredictionHorizonOf(const Plan& plan, MappedRecord record,
                                                             const Registry& registry);

}  // namespace dynoproof::diagnosis
