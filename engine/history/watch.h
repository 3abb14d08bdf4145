// What a history says: which figures changed, when, and whether for the worse.
#pragma once

#include "history/store.h"
#include "score/change_points.h"

namespace dynoproof::history {

struct WatchOptions {
  std::size_t recent = 10;  // nights: older changes are shown, but are no finding any more
  double alpha = 0.01;      // chance of one false finding among all series that scatter (Bonferroni)
};

struct Finding {
  enum class Kind { kWorse, kBetter, kChanged, kMissing } kind;
  std::size_t series = 0;  // place among History::series
  std::size_t night = 0;   // the first of the new level; of kMissing the first without a reading
  double before = 0.0, after = 0.0, p = 0.0;
  bool recent = false;
};

/// A reading is missing in the newest night where its series goes on there without a value, however long, or where it
/// is left out and that began among the recent nights: what was given up for good is history some day.
struct Watch {
  std::vector<Finding> findings;  // recent ones first, the worse before the others
  std::size_t compared = 0;       // series with enough nights
  std::size_t too_short = 0;      // series that cannot show anything yet
  /// Of the contract: 5 a time or an instruction count has become worse, 1 a score has, or a reading is missing; 4
  /// nothing could be compared.
  int exit_code = 4;
};

Watch Look(const History& history, const WatchOptions& options);

std::string ToString(Finding::Kind kind);

}  // namespace dynoproof::history
