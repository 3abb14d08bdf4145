// Pieces of a campaign made by worker processes on this machine. A worker is a fork that has everything loaded, makes
// its piece, and hands rows over a pipe; so a run that crashes takes its worker with it and nothing else, becomes a row
// that says so, and the piece goes on behind it. Memory ends with each piece.
#pragma once

#include <functional>

#include "campaign/campaign.h"
#include "campaign/rows.h"

namespace dynoproof::campaign {

struct Tally {
  std::int64_t done = 0, failing = 0, broken = 0;  // in this session
  double run_s = 0.0;                              // wall time of all runs so far, summed over the workers
};

struct WorkOptions {
  int jobs = 1;
  std::int64_t piece = 0;  // runs a piece; 0: by their cost
  std::function<void(const Tally&)> progress = [](const Tally&) {};
  std::function<bool()> stopped = [] { return false; };  // asked often; true: keep what is done and return
};

/// Makes the runs and stores them. Must be called from a process with one thread. When stopped, finished rows of
/// unfinished pieces are stored too. Failure: what no run is to blame for; what was done is stored then, if possible.
Status MakeRuns(const Campaign& campaign, const RowStore& store, std::vector<Range> runs, const WorkOptions& options,
                Tally& tally);

}  // namespace dynoproof::campaign
