// A campaign: one subject, many variations, one table. Read from a TOML file; README.md has the keys.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "campaign/axes.h"
#include "campaign/subject.h"
#include "model/plan.h"
#include "model/registry.h"

namespace dynoproof::campaign {

/// A share of what was counted over all runs: sum of figure `hits` over sum of figure `of`.
struct RateSpec {
  std::string hits, of = "runs", by;
  void Visit(auto& v) {
    v.Required("hits", hits, Any(), "a figure that counts, or \"fail\", \"broken\"");
    v.Optional("of", of, Any(), "the figure it is a share of, or \"runs\"");
    v.Optional("by", by, Any(), "an axis: one line for each of its values, besides the whole");
  }
};

/// How array tasks are cut and watched.
struct SlurmSpec {
  int runs_per_task = 0, minutes = 60, deadline_minutes = 1440;
  double task_s = 120.0;
  std::string partition;
  void Visit(auto& v) {
    v.Optional("runs_per_task", runs_per_task, Between(1, 1e6), "instead of what task_s gives");
    v.Optional("task_s", task_s, Positive(), "how long a task should work, by the cost of the first run");
    v.Optional("minutes", minutes, Between(1, 1e5), "limit of a task (sbatch --time)");
    v.Optional("deadline_minutes", deadline_minutes, Between(1, 1e6), "the campaign is given up after this");
    v.Optional("partition", partition, Any(), "sbatch --partition");
  }
};

struct Campaign {
  std::string id, title, file;
  Axes axes;
  std::unique_ptr<Subject> subject;
  std::string text;           // what decides the rows, as TOML: the campaign and the subject it names
  std::string fingerprint;    // of that text and of this build
  double most_failing = 0.0;  // share of runs
  double most_seconds = 0.0;  // a run that takes longer is broken; 0: no limit
  std::vector<std::pair<std::string, RateSpec>> rates;
  SlurmSpec slurm;
};

/// A study of a layer above as a campaign's subject (`study = "NAME"`). `parameters`: what is the same in all runs; the
/// axes name the others. Null with the faults in the diagnostics.
using StudyMaker = std::unique_ptr<Subject> (*)(const std::vector<std::pair<std::string, Value>>& parameters,
                                                const Value& root, const Axes& axes, Diagnostics& diagnostics);
void AddStudy(const std::string& name, StudyMaker maker);

/// Reads the file and tries the campaign's corners: every fault of file, axes and scenario is found before anything
/// runs. Null when there was any. `folder` is where the results will be.
std::unique_ptr<Campaign> LoadCampaign(const std::string& file, const std::string& folder, const Registry& registry,
                                       Diagnostics& diagnostics);

}  // namespace dynoproof::campaign
