// A campaign on a cluster: pieces as tasks of Slurm job arrays. Slurm says where and when; this says what, watches the
// folder for rows, and submits again what got lost. Nothing but the folder is shared with the tasks.
#pragma once

#include <functional>
#include <string>

#include "campaign/campaign.h"
#include "campaign/rows.h"

namespace dynoproof::campaign {

struct ClusterTally {
  std::int64_t done = 0;                    // runs with rows
  int tasks = 0, running = 0, pending = 0;  // submitted; as the queue shows them now
  int lost = 0;                             // pieces that had to be submitted again
};

struct ClusterOptions {
  std::vector<std::string> command;  // the program and its arguments up to where the task file and number follow
  std::function<void(const ClusterTally&)> progress = [](const ClusterTally&) {};
  std::function<bool()> stopped = [] { return false; };
};

/// How many runs a task gets, for a run that costs `run_s`: `runs_per_task`, or as many as take task_s, but at least so
/// many that one array (1000 tasks, within Slurm's usual MaxArraySize of 1001) holds them all.
std::int64_t RunsPerTask(const SlurmSpec& spec, std::int64_t runs, double run_s);

/// Submits the pieces and returns when every run of the campaign has a row. Failure: sbatch refuses, the deadline has
/// passed, or three submissions in a row brought nothing. When it returns early, its own jobs are cancelled and what is
/// done stays.
Status MakeRunsOnCluster(const Campaign& campaign, const RowStore& store, std::vector<Range> pieces,
                         const ClusterOptions& options);

/// The pieces that a task file lists, one a line: BEGIN END.
Result<std::vector<Range>> ReadTaskFile(const std::string& file);

}  // namespace dynoproof::campaign
