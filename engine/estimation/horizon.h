// How far ahead a model predicts a record. A run that the record corrects with a short memory shows what its forces get
// wrong; the longer the memory, the more of what only adds up. The longest one up to which nothing is left but noise is the
// horizon.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "experiment/records.h"
#include "model/registry.h"

namespace dynoproof::estimation {

struct HorizonLevel {
  std::optional<double> memory_s;          // nothing: the free run
  double share = 0.0;                      // of the driving forces, that the model is taken not to know
  std::map<std::string, double> nrmse;     // RMS of the innovations over the output's own spread
  std::map<std::string, double> by_noise;  // what measurement noise alone would cause
  bool at_noise = false;                   // of every output

  /// The geometric mean of the outputs' NRMSE.
  double GeometricMean() const;
};

struct Horizon {
  std::vector<HorizonLevel> levels;     // memories from ten samples on, each sqrt(10) times as long, then the free run
  std::map<std::string, double> noise;  // of the outputs, over the same spread
  /// The longest memory [s] up to which nothing is left but noise; the record's length where that is true of the free run, 0
  /// where not even the shortest level's errors are noise.
  double horizon_s = 0.0;
  bool in_motion = false;               // the record began otherwise than the scenario does
  double seen_s = 0.0, record_s = 0.0;  // the first part, that was looked at, of the whole

  /// A table of a line per level, with what follows from it.
  std::string ToText() const;
};

/// `record`: mapped onto `plan`, which is the nominal model; no more than its first 20 000 periods are looked at. One run for
/// each level. Nothing where no output moves, or the record is shorter than fifty samples; fails where the plan cannot be
/// built or its free run breaks.
Result<std::optional<Horizon>> HorizonOf(Plan plan, MappedRecord record, const Registry& registry);

/// The shortest of these levels alone, where a run shows the forces of its inputs; the free run of a plant that nothing corrects.
Result<std::optional<HorizonLevel>> ShortestLevelOf(Plan plan, MappedRecord record, const Registry& registry);

/// "horizon_s", "noise" and "levels", to be added to a document.
void AddTo(nlohmann::json& document, const Horizon& horizon);

}  // namespace dynoproof::estimation
