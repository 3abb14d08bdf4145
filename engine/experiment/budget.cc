#include "experiment/budget.h"

#include <fmt/format.h>
#include <malloc.h>
#include <sched.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "base/subnormals.h"
#include "base/within.h"
#include "model/section.h"
#include "sim/simulate.h"
#include "sim/solver.h"

namespace dynoproof {
namespace {

constexpr std::int64_t kNano = 1'000'000'000;

std::int64_t Now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * kNano + time.tv_nsec;
}

void SleepUntil(std::int64_t at) {
  const timespec time{at / kNano, at % kNano};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

/// Jiffies that the hypervisor took, and all of them, since the machine started.
std::pair<double, double> Stolen() {
  std::ifstream file("/proc/stat");
  std::string line, word;
  std::getline(file, line);
  std::istringstream words(line);
  words >> word;
  double value = 0.0, all = 0.0, steal = 0.0;
  for (int i = 0; i < 8 && words >> value; ++i) {
    all += value;
    if (i == 7) steal = value;
  }
  return {steal, all};
}

/// Time of a fixed piece of work.
double Work() {
  const std::int64_t begin = Now();
  volatile double x = 1.0;
  for (int i = 0; i < 200'000; ++i) x = x * 1.0000001;
  return static_cast<double>(Now() - begin);
}

double Pick(std::vector<double>& values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

}  // namespace

std::optional<Budget> ReadBudget(const Plan& plan, Diagnostics& diagnostics) {
  const Value* table = SectionTable(plan, "budget", "write [budget]", diagnostics);
  Budget budget;
  if (table == nullptr || !ReadParams(*table, budget, diagnostics, "budget")) return std::nullopt;
  return budget;
}

std::string Fitness::Text() const {
  return fmt::format(
      "{}: wakes {:.0f} us late (p99, limit 50), {:.1f} % stolen (limit 1), equal work differs by {:.0f} % (limit 20)",
      fit() ? "fit" : "not fit, tails do not bind", wake_p99_us, 100.0 * stolen_share, 100.0 * work_spread);
}

double Timing::Quantile(double q) const {
  return sorted_us.empty() ? std::nan("")
                           : sorted_us[static_cast<std::size_t>(q * static_cast<double>(sorted_us.size() - 1))];
}

Result<Timing> Measure(const Rig& rig, const BenchOptions& options) {
  Timing timing;
  timing.paced = options.paced;
  if (options.realtime_priority) {
    const sched_param parameters{80};
    if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) {
      timing.notes.push_back(fmt::format("no realtime priority: {}", std::strerror(errno)));
    }
  }
  const Result<std::unique_ptr<Solver>> solver = MakeRealtimeSolver(rig);
  if (!solver.ok()) return solver.failure();
  const FlushSubnormals flush;
  Simulation simulation(rig, **solver);
  if (Status failed = simulation.Start()) return *failed;
  const auto most = static_cast<std::int64_t>(options.most_s * 1e9 / static_cast<double>(rig.period));
  const std::int64_t steps = std::min(rig.steps, most), warm = std::min<std::int64_t>(steps / 10, 200);
  if (steps < 100) return Failure{"fewer than 100 periods: nothing to measure", rig.id, {}, 2};
  std::vector<double> late;
  timing.sorted_us.reserve(static_cast<std::size_t>(steps));
  late.reserve(static_cast<std::size_t>(steps));
  const auto stolen_before = Stolen();
  std::vector<double> work;
  for (int i = 0; i < 20; ++i) work.push_back(Work());
  std::int64_t due = Now() + rig.period;
  auto heap = mallinfo2().uordblks;
  double busy_ns = 0.0;
  for (std::int64_t step = 0; step < steps; ++step) {
    if (step == warm) heap = mallinfo2().uordblks;
    if (options.paced) SleepUntil(due);
    const std::int64_t begin = Now();
    if (Status failed = simulation.Tick()) return *failed;
    if (Status failed = simulation.Integrate()) return *failed;
    const std::int64_t end = Now();
    if (step < warm) {
      due = Now() + rig.period;
      continue;
    }
    timing.sorted_us.push_back(1e-3 * static_cast<double>(end - begin));
    busy_ns += static_cast<double>(end - begin);
    if (options.paced) {
      late.push_back(1e-3 * static_cast<double>(begin - due));
      due += rig.period;
      if (end > due) ++timing.overruns;
    }
  }
  timing.heap_growth_bytes = static_cast<double>(mallinfo2().uordblks) - static_cast<double>(heap);
  timing.simulated_s_per_s =
      static_cast<double>(timing.sorted_us.size()) * static_cast<double>(rig.period) / std::max(busy_ns, 1.0);
  std::sort(timing.sorted_us.begin(), timing.sorted_us.end());
  if (!late.empty()) timing.wake_p999_us = Pick(late, 0.999);
  // Fitness, of the same run: sleeps of 1 ms, what was stolen meanwhile, the fixed work before and after.
  std::vector<double> waking;
  for (int i = 0; i < 300; ++i) {
    const std::int64_t at = Now() + 1'000'000;
    SleepUntil(at);
    waking.push_back(1e-3 * static_cast<double>(Now() - at));
  }
  for (int i = 0; i < 20; ++i) work.push_back(Work());
  const auto stolen_after = Stolen();
  timing.fitness.wake_p99_us = Pick(waking, 0.99);
  timing.fitness.stolen_share =
      (stolen_after.first - stolen_before.first) / std::max(1.0, stolen_after.second - stolen_before.second);
  timing.fitness.work_spread = Pick(work, 0.9) / Pick(work, 0.1) - 1.0;
  return timing;
}

std::vector<score::Check> JudgeBudget(const Budget& budget, const Timing& timing) {
  std::vector<score::Check> checks;
  const auto judge = [&](const char* name, double value, double limit, const char* unit, bool at_least, bool tail) {
    if (limit == 0.0) return;
    score::Check check;
    check.name = name;
    check.kind = "budget";
    check.value = value;
    check.limit = limit;
    check.at_least = at_least;
    check.unit = unit;
    check.origin = "[budget] of the scenario";
    const bool held = at_least ? Reaches(value, limit) : Within(value, limit);
    check.verdict = tail && !timing.fitness.fit() ? score::Verdict::kInconclusive
                    : held                        ? score::Verdict::kPass
                                                  : score::Verdict::kFail;
    if (check.verdict != score::Verdict::kPass) check.explanation = timing.fitness.Text();
    checks.push_back(std::move(check));
  };
  judge("step, median", timing.Quantile(0.5), budget.step_p50_us, "us", false, false);
  judge("step, 99.9 %", timing.Quantile(0.999), budget.step_p999_us, "us", false, true);
  judge("step, longest", timing.Quantile(1.0), budget.step_max_us, "us", false, true);
  judge("simulated seconds per second", timing.simulated_s_per_s, budget.simulated_s_per_s, "1", true, true);
  if (budget.no_heap) {
    score::Check check;
    check.name = "growth of the heap";
    check.kind = "budget";
    check.value = timing.heap_growth_bytes;
    check.limit = 0.0;
    check.unit = "B";
    check.origin = "[budget] of the scenario";
    check.verdict = timing.heap_growth_bytes <= 0.0 ? score::Verdict::kPass : score::Verdict::kFail;
    checks.push_back(std::move(check));
  }
  return checks;
}

}  // namespace dynoproof
