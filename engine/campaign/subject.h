// What a campaign runs: a scenario, a study, or another program. A subject is made once and then used by many workers,
// each in a process of its own.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/status.h"
#include "score/verdict.h"

namespace dynoproof::campaign {

/// What a run found out: one line of the table.
struct Row {
  std::int64_t run = 0;
  score::Verdict verdict = score::Verdict::kFail;
  std::vector<double> figures;                             // in the order of Subject::figures(); NaN: it has none
  std::string why;                                         // one line, unless the verdict is a pass
  double used = std::numeric_limits<double>::quiet_NaN();  // largest share of a limit that a check or figure takes
  std::string nearest = {};                                // which one, with its numbers; empty where none has a share

  /// Keeps what takes more of its limit than anything before.
  void Takes(double share, const std::string& what) {
    if (!std::isfinite(share) || share <= used) return;
    used = share;
    nearest = what;
  }
};

struct FigureInfo {
  std::string name, unit;
  /// What a run may have; not finite: no limit.
  double at_least = -std::numeric_limits<double>::infinity(), at_most = std::numeric_limits<double>::infinity();
};

/// Runs, in the order of their numbers.
struct Range {
  std::int64_t begin = 0, end = 0;
  std::int64_t size() const { return end - begin; }
  friend bool operator==(const Range&, const Range&) = default;
};

class Subject {
 public:
  virtual ~Subject() = default;

  virtual const std::vector<FigureInfo>& figures() const = 0;
  /// How many runs it takes on together where that pays; a row does not depend on its neighbours.
  virtual int batch() const { return 1; }
  /// Makes the runs and hands over a row each, in order. A run that breaks is a row; a failure is what no run is to
  /// blame for (a full disk). `one_by_one`: no batches, so that a crash is the fault of the run whose row is missing.
  virtual Status Run(Range runs, bool one_by_one, const std::function<void(Row)>& done) const = 0;
  /// The command that makes one run again, without a campaign; empty where there is none.
  virtual std::string Command(std::int64_t run) const = 0;
};

}  // namespace dynoproof::campaign
