#include "campaign/slurm.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <thread>

#include "base/atomic_file.h"
#include "base/process.h"
#include "base/text.h"

namespace dynoproof::campaign {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::int64_t kMostTasks = 1000;  // of an array
constexpr int kMostBarren = 3;             // submissions in a row that bring no row
constexpr auto kPoll = std::chrono::milliseconds(500);

/// The end of the newest log, for messages.
std::string LastWords(const fs::path& logs) {
  fs::path newest;
  fs::file_time_type time = fs::file_time_type::min();
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(logs, error)) {
    if (entry.file_size(error) == 0 || entry.last_write_time(error) < time) continue;
    newest = entry.path();
    time = entry.last_write_time(error);
  }
  const std::string text = newest.empty() ? "" : ReadTextFile(newest.string()).value_or("");
  if (text.empty()) return "no task left a word";
  return newest.string() + " ends with: " + text.substr(text.size() - std::min<std::size_t>(text.size(), 500));
}

class Cluster {
 public:
  Cluster(const Campaign& campaign, const RowStore& store, const ClusterOptions& options)
      : campaign_(campaign), store_(store), options_(options), logs_(fs::path(store.folder()) / "slurm") {}

  Status Run(std::vector<Range> pieces) {
    const Status failed = Watch(std::move(pieces));
    for (const std::string& job : jobs_) RunProgram({"scancel", "--quiet", job});
    return failed;
  }

 private:
  Status Watch(std::vector<Range> pieces) {
    const auto deadline = Clock::now() + std::chrono::minutes(campaign_.slurm.deadline_minutes);
    std::int64_t left = CountRuns(store_.Missing());
    int barren = 0;
    std::size_t most = 0;
    for (const Range& piece : pieces) most = std::max(most, static_cast<std::size_t>(piece.size()));
    while (left > 0) {
      if (Status failed = Submit(pieces)) return failed;
      while (left > 0 && InQueue() > 0) {
        if (options_.stopped()) return {};
        if (Clock::now() > deadline) {
          return Failure{fmt::format("the deadline of {} minutes has passed with {} runs missing",
                                     campaign_.slurm.deadline_minutes, left),
                         "slurm"};
        }
        std::this_thread::sleep_for(kPoll);
        left = CountRuns(store_.Missing());
        tally_.done = store_.runs() - left;
        options_.progress(tally_);
      }
      // Files of the last tasks may take a moment to be seen through a shared file system.
      for (int i = 0; i < 10 && left > 0; ++i) {
        std::this_thread::sleep_for(kPoll / 2);
        left = CountRuns(store_.Missing());
      }
      if (left == 0) break;
      pieces = Cut(store_.Missing(), static_cast<std::int64_t>(most));
      tally_.lost += static_cast<int>(pieces.size());
      barren = left < at_submission_ ? 0 : barren + 1;
      if (barren == kMostBarren) {
        return Failure{fmt::format("{} submissions brought no run of the {} missing ones; {}", kMostBarren, left,
                                   LastWords(logs_)),
                       "slurm"};
      }
      jobs_.clear();
    }
    tally_.done = store_.runs();
    options_.progress(tally_);
    return {};
  }

  Status Submit(const std::vector<Range>& pieces) {
    at_submission_ = CountRuns(pieces);
    ++submissions_;
    for (std::size_t begin = 0; begin < pieces.size(); begin += kMostTasks) {
      const std::size_t count = std::min<std::size_t>(kMostTasks, pieces.size() - begin);
      std::string list;
      for (std::size_t i = begin; i < begin + count; ++i)
        list += fmt::format("{} {}\n", pieces[i].begin, pieces[i].end);
      const fs::path file = logs_ / fmt::format("tasks-{}-{}.txt", submissions_, begin);
      if (Status failed = WriteFileAtomically(file, list)) return failed;
      std::string line = "exec";
      for (const std::string& word : options_.command) line += " " + ShellQuoted(word);
      line += " --task " + ShellQuoted(file.string()) + " --number \"$SLURM_ARRAY_TASK_ID\"";
      std::vector<std::string> words = {"sbatch",
                                        "--parsable",
                                        "--requeue",
                                        "--open-mode=append",
                                        fmt::format("--array=0-{}", count - 1),
                                        "--job-name=dynoproof-" + campaign_.id,
                                        fmt::format("--time={}", campaign_.slurm.minutes),
                                        "--output=" + (logs_ / "%A_%a.log").string(),
                                        "--ntasks=1",
                                        "--cpus-per-task=1"};
      if (!campaign_.slurm.partition.empty()) words.push_back("--partition=" + campaign_.slurm.partition);
      words.push_back("--wrap=" + line);
      const ProgramEnd answer = RunProgram(words);
      const std::string job = answer.out.substr(0, answer.out.find_first_not_of("0123456789"));
      if (answer.exit != 0 || job.empty()) return Failure{"sbatch refused the tasks: " + answer.out, "slurm"};
      jobs_.push_back(job);
      tally_.tasks += static_cast<int>(count);
    }
    return {};
  }

  /// Tasks of ours that the queue still has. `sbatch --wait` and exit codes are no verdict; rows are.
  int InQueue() {
    const ProgramEnd answer = RunProgram(
        {"squeue", "--noheader", "--array", "--format=%i %T %r", fmt::format("--jobs={}", fmt::join(jobs_, ","))});
    if (answer.exit != 0) {
      if (answer.out.find("Invalid job id") != std::string::npos) return 0;  // all forgotten: all ended
      return std::max(1, tally_.running + tally_.pending);  // the controller is away: the deadline is the judge
    }
    tally_.running = tally_.pending = 0;
    std::istringstream lines(answer.out);
    std::string line;
    std::set<std::string> held;
    while (std::getline(lines, line)) {
      std::istringstream words(line);
      std::string id, state, reason;
      words >> id >> state;
      std::getline(words, reason);
      if (state == "RUNNING" || state == "COMPLETING" || state == "CONFIGURING") ++tally_.running;
      if (state == "PENDING" || state == "REQUEUED") ++tally_.pending;
      if (reason.find("held") != std::string::npos) held.insert(id);
    }
    // A node that failed to start a task leaves it held; it may run elsewhere.
    for (const std::string& id : held) RunProgram({"scontrol", "release", id});
    return tally_.running + tally_.pending;
  }

  const Campaign& campaign_;
  const RowStore& store_;
  const ClusterOptions& options_;
  const fs::path logs_;
  std::vector<std::string> jobs_;
  ClusterTally tally_;
  int submissions_ = 0;
  std::int64_t at_submission_ = 0;
};

}  // namespace

std::int64_t RunsPerTask(const SlurmSpec& spec, std::int64_t runs, double run_s) {
  if (spec.runs_per_task > 0) return spec.runs_per_task;
  const double by_time = spec.task_s / std::max(run_s, 1e-6);
  const std::int64_t least = (runs + kMostTasks - 1) / kMostTasks;
  return std::max({static_cast<std::int64_t>(std::min(by_time, 1e6)), least, std::int64_t{1}});
}

Status MakeRunsOnCluster(const Campaign& campaign, const RowStore& store, std::vector<Range> pieces,
                         const ClusterOptions& options) {
  return Cluster(campaign, store, options).Run(std::move(pieces));
}

Result<std::vector<Range>> ReadTaskFile(const std::string& file) {
  const std::optional<std::string> text = ReadTextFile(file);
  if (!text) return Failure{"cannot be read", file, {}, 2};
  std::istringstream lines(*text);
  std::vector<Range> ranges;
  for (Range range; lines >> range.begin >> range.end;) ranges.push_back(range);
  return ranges;
}

}  // namespace dynoproof::campaign
