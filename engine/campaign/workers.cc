#include "campaign/workers.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <limits>
#include <new>

#include "base/process.h"
#include "base/within.h"

namespace dynoproof::campaign {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPieceSeconds = 5.0;  // a kill loses no more than this of each worker
constexpr int kMostKills = 2;          // a run whose worker is killed from outside so often is broken
constexpr char kFault = '!';           // begins a line that is no row

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

bool WriteAll(int pipe, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(pipe, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// The worker's life. A line a run: wall seconds, CPU seconds, memory in MB, row.
[[noreturn]] void Work(const Subject& subject, Range runs, bool one_by_one, int pipe) {
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C reaches all: the parent decides
  std::signal(SIGTERM, SIG_DFL);
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // elsewhere the broken pipe ends it with its next row
#endif
  const auto usage = [] {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    return used;
  };
  const auto cpu = [](const rusage& used) {
    return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
  };
  Clock::time_point start = Clock::now();
  double cpu_before = cpu(usage());
  const auto done = [&](const Row& row) {
    const rusage now = usage();
    const std::string line = fmt::format("{} {} {} {}\n", SecondsSince(start), cpu(now) - cpu_before,
                                         static_cast<double>(now.ru_maxrss) / 1024.0, ToLine(row));
    if (!WriteAll(pipe, line)) _exit(1);
    start = Clock::now();
    cpu_before = cpu(now);
  };
  std::string fault;
  for (Range left = runs; left.begin < left.end;) {
    try {
      const Status failed = subject.Run(left, one_by_one, [&](Row row) {
        left.begin = row.run + 1;
        done(row);
      });
      if (failed) {
        WriteAll(pipe, fmt::format("{}{}\n", kFault, failed->ToString()));
        _exit(1);
      }
      break;
    } catch (const std::exception& error) {  // that run's row
      if (subject.batch() > 1 && !one_by_one) {
        one_by_one = true;
        continue;
      }
      const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
      Row row{left.begin,
              score::Verdict::kBroken,
              {},
              memory ? "out of memory" : fmt::format("unexpected: {}", error.what())};
      row.figures.assign(subject.figures().size(), std::numeric_limits<double>::quiet_NaN());
      ++left.begin;
      done(row);
    }
  }
  _exit(0);
}

struct Worker {
  pid_t process = -1;
  int pipe = -1;
  Range piece;
  std::vector<Row> rows;
  std::vector<Cost> costs;
  std::string text;  // received, not yet a line
  std::string fault;
  bool one_by_one = false, too_long = false;
  int kills = 0;
  Clock::time_point last = {};  // when the last row came

  std::int64_t next() const { return piece.begin + std::ssize(rows); }
};

class Workers {
 public:
  Workers(const Campaign& campaign, const RowStore& store, std::vector<Range> runs, const WorkOptions& options,
          Tally& tally)
      : campaign_(campaign), store_(store), left_(runs.begin(), runs.end()), options_(options), tally_(tally) {}

  Status Run() {
    for (;;) {
      while (!ending_ && std::ssize(workers_) < options_.jobs && !left_.empty()) Begin(NextPiece());
      if (workers_.empty()) return failure_;
      Wait();
      if (!ending_ && options_.stopped()) End();
      if (!ending_) LookForStuck();
      options_.progress(tally_);
    }
  }

 private:
  Range NextPiece() {
    std::int64_t size = options_.piece;
    if (size == 0) {
      std::int64_t all = 0;
      for (const Range& range : left_) all += range.size();
      const double each_s = tally_.done > 0 ? tally_.run_s / static_cast<double>(tally_.done) : kPieceSeconds;
      size = static_cast<std::int64_t>(std::min(kPieceSeconds / std::max(each_s, 1e-6), 1e5));
      // Towards the end smaller, so that all workers end together.
      size = std::min(size, std::max(all / (2 * options_.jobs), size / 16));
      const std::int64_t batch = campaign_.subject->batch();
      size = std::max(size / batch, std::int64_t{1}) * batch;
    }
    Range& first = left_.front();
    const Range piece{first.begin, std::min(first.begin + size, first.end)};
    first.begin = piece.end;
    if (first.size() == 0) left_.pop_front();
    return piece;
  }

  void Begin(Range piece) {
    Worker& worker = workers_.emplace_back();
    worker.piece = piece;
    Fork(worker);
    if (worker.pipe < 0) workers_.pop_back();
  }

  void Fork(Worker& worker) {
    int ends[2];
    if (pipe(ends) != 0) return Fail({fmt::format("no pipe to a worker: {}", std::strerror(errno))});
    const pid_t process = fork();
    if (process == 0) {
      close(ends[0]);
      // Else a worker would keep the others' pipes open when this process is gone.
      for (const Worker& other : workers_) {
        if (other.pipe >= 0) close(other.pipe);
      }
      Work(*campaign_.subject, {worker.next(), worker.piece.end}, worker.one_by_one, ends[1]);
    }
    close(ends[1]);
    if (process < 0) {
      close(ends[0]);
      return Fail({fmt::format("no process for a worker: {}", std::strerror(errno))});
    }
    worker.process = process;
    worker.pipe = ends[0];
    worker.last = Clock::now();
  }

  void Wait() {
    std::vector<pollfd> waiting;
    for (const Worker& worker : workers_) waiting.push_back({worker.pipe, POLLIN, 0});
    poll(waiting.data(), waiting.size(), 200);
    for (std::size_t i = waiting.size(); i-- > 0;) {
      if (waiting[i].revents == 0) continue;
      Worker& worker = workers_[i];
      char buffer[65536];
      const ssize_t count = read(worker.pipe, buffer, sizeof buffer);
      if (count < 0 && errno == EINTR) continue;
      if (count > 0) {
        Take(worker, {buffer, static_cast<std::size_t>(count)});
      } else if (Ended(worker)) {
        workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(i));
      }
    }
  }

  void Take(Worker& worker, std::string_view text) {
    worker.text += text;
    std::size_t begin = 0;
    for (std::size_t end; (end = worker.text.find('\n', begin)) != std::string::npos; begin = end + 1) {
      const std::string line = worker.text.substr(begin, end - begin);
      if (line.front() == kFault) {
        worker.fault = line.substr(1);
        continue;
      }
      Cost cost;
      int read = 0;
      std::optional<Row> row;
      if (std::sscanf(line.c_str(), "%lf %lf %lf %n", &cost.wall_s, &cost.cpu_s, &cost.peak_MB, &read) == 3)
        row = ParseRow(std::string_view(line).substr(static_cast<std::size_t>(read)));
      if (!row || row->run != worker.next()) {
        worker.fault = "a worker sent what is no row: " + line.substr(0, 200);
        continue;
      }
      Add(worker, *std::move(row), cost);
    }
    worker.text.erase(0, begin);
  }

  void Add(Worker& worker, Row row, const Cost& cost) {
    ++tally_.done;
    tally_.run_s += cost.wall_s;
    tally_.failing += row.verdict == score::Verdict::kFail ? 1 : 0;
    tally_.broken += row.verdict == score::Verdict::kBroken ? 1 : 0;
    worker.rows.push_back(std::move(row));
    worker.costs.push_back(cost);
    worker.last = Clock::now();
    worker.kills = 0;
  }

  /// The pipe is closed: the worker is done or dead. True when its piece is over.
  bool Ended(Worker& worker) {
    close(worker.pipe);
    worker.pipe = -1;
    int state = 0;
    while (waitpid(worker.process, &state, 0) < 0 && errno == EINTR) {
    }
    worker.text.clear();
    if (ending_ || worker.next() == worker.piece.end) return Store(worker);
    if (!worker.fault.empty()) {
      Fail({worker.fault});
      return Store(worker);
    }
    const int signal = WIFSIGNALED(state) ? WTERMSIG(state) : 0;
    const bool from_outside = signal == SIGKILL || signal == SIGTERM || signal == SIGHUP;
    if (campaign_.subject->batch() > 1 && !worker.one_by_one) {
      worker.one_by_one = true;  // find out which run of the batch it was
      worker.too_long = false;
    } else if (worker.too_long || !from_outside || ++worker.kills > kMostKills) {
      Row row{worker.next(), score::Verdict::kBroken, {}, ""};
      row.figures.assign(campaign_.subject->figures().size(), std::numeric_limits<double>::quiet_NaN());
      row.why = worker.too_long ? fmt::format("took longer than {} s", campaign_.most_seconds) : HowItEnded(state);
      worker.too_long = false;
      Add(worker, std::move(row), {SecondsSince(worker.last), 0.0, 0.0});
      if (worker.next() == worker.piece.end) return Store(worker);
    }
    Fork(worker);
    return worker.pipe < 0;
  }

  bool Store(Worker& worker) {
    if (Status failed = store_.Write(worker.rows, worker.costs)) Fail(*failed);
    return true;
  }

  void LookForStuck() {
    if (campaign_.most_seconds <= 0.0) return;
    for (Worker& worker : workers_) {
      const int together = worker.one_by_one ? 1 : campaign_.subject->batch();
      if (worker.too_long || Within(SecondsSince(worker.last), together * campaign_.most_seconds)) continue;
      worker.too_long = true;
      kill(worker.process, SIGKILL);
    }
  }

  void Fail(Failure failure) {
    if (!failure_) failure_ = std::move(failure);
    if (!ending_) End();
  }

  /// No further pieces; the workers' rows so far are stored as their pipes close.
  void End() {
    ending_ = true;
    for (const Worker& worker : workers_) {
      if (worker.pipe >= 0) kill(worker.process, SIGKILL);
    }
  }

  const Campaign& campaign_;
  const RowStore& store_;
  std::deque<Range> left_;
  const WorkOptions& options_;
  Tally& tally_;
  std::vector<Worker> workers_;
  bool ending_ = false;
  Status failure_;
};

}  // namespace

Status MakeRuns(const Campaign& campaign, const RowStore& store, std::vector<Range> runs, const WorkOptions& options,
                Tally& tally) {
  return Workers(campaign, store, std::move(runs), options, tally).Run();
}

}  // namespace dynoproof::campaign
