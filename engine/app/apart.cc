#include "app/apart.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/app.h"
#include "base/process.h"
#include "base/within.h"
#include "score/evidence.h"

namespace dynoproof::app {
namespace {

using Clock = std::chrono::steady_clock;

// Exit codes of a process that could not even say what went wrong, and of one that something ended by exit().
constexpr int kNoMemory = 100, kEnded = 101;

nlohmann::json Packed(const ScenarioResult& result, const std::optional<reports::RunPage::Part>& part) {
  nlohmann::json checks = nlohmann::json::array();
  for (const score::Check& c : result.checks)
    checks.push_back({c.name, c.kind, static_cast<int>(c.verdict), c.value, c.limit, c.unit, c.origin, c.explanation,
                      c.at_least, c.stated, c.shown, c.evidence != nullptr, c.cause});
  nlohmann::json figures = nlohmann::json::object();
  for (const auto& [name, figure] : result.figures) figures[name] = {figure.value, figure.unit};
  nlohmann::json packed = {{"id", result.id},
                           {"title", result.title},
                           {"verdict", static_cast<int>(result.verdict)},
                           {"trace_file", result.trace_file},
                           {"checks", std::move(checks)},
                           {"figures", std::move(figures)},
                           {"counters", result.counters},
                           {"broken", result.broken},
                           {"exit_code", result.exit_code},
                           {"notes", result.notes},
                           {"changes", result.changes}};
  if (part) packed["part"] = {part->source, part->pictures, part->settings, part->counters};
  return packed;
}

ScenarioResult Unpacked(const nlohmann::json& packed) {
  ScenarioResult result;
  packed.at("id").get_to(result.id);
  packed.at("title").get_to(result.title);
  result.verdict = static_cast<score::Verdict>(packed.at("verdict").get<int>());
  packed.at("trace_file").get_to(result.trace_file);
  for (const nlohmann::json& one : packed.at("checks")) {
    score::Check c;
    one.at(0).get_to(c.name);
    one.at(1).get_to(c.kind);
    c.verdict = static_cast<score::Verdict>(one.at(2).get<int>());
    one.at(3).get_to(c.value);
    one.at(4).get_to(c.limit);
    one.at(5).get_to(c.unit);
    one.at(6).get_to(c.origin);
    one.at(7).get_to(c.explanation);
    one.at(8).get_to(c.at_least);
    one.at(9).get_to(c.stated);
    one.at(10).get_to(c.shown);
    // Its courses were drawn where it was made; here it counts that there were some.
    if (one.at(11).get<bool>()) c.evidence = std::make_shared<const score::Evidence>();
    one.at(12).get_to(c.cause);
    result.checks.push_back(std::move(c));
  }
  for (const auto& [name, figure] : packed.at("figures").items())
    result.figures[name] = {figure.at(0).get<double>(), figure.at(1).get<std::string>()};
  packed.at("counters").get_to(result.counters);
  packed.at("broken").get_to(result.broken);
  packed.at("exit_code").get_to(result.exit_code);
  packed.at("notes").get_to(result.notes);
  packed.at("changes").get_to(result.changes);
  return result;
}

/// A scenario on its way.
struct Child {
  std::size_t index;
  pid_t process;
  int pipe;
  Clock::time_point begun;
  std::vector<std::uint8_t> bytes = {};
  bool too_long = false;
};

[[noreturn]] void Work(int pipe, const RunLimits& limits, const std::function<nlohmann::json()>& make) {
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C reaches all: the parent decides
  std::signal(SIGTERM, SIG_DFL);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::atexit([] { _exit(kEnded); });  // before the destructors of what the parent still has
  if (limits.most_memory_MB > 0.0) {
    long pages = 0;  // what the parent had is no scenario's
    if (std::FILE* file = std::fopen("/proc/self/statm", "r"); file != nullptr) {
      if (std::fscanf(file, "%ld", &pages) != 1) pages = 0;
      std::fclose(file);
    }
    const auto bytes =
        static_cast<rlim_t>(pages * sysconf(_SC_PAGESIZE) + static_cast<long>(limits.most_memory_MB * 1e6));
    const rlimit limit = {bytes, bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  std::vector<std::uint8_t> bytes;
  try {
    bytes = nlohmann::json::to_msgpack(make());
  } catch (...) {  // what a scenario's own result could not tell any more
    _exit(kNoMemory);
  }
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = write(pipe, bytes.data() + sent, bytes.size() - sent);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) _exit(kBroken);
    sent += static_cast<std::size_t>(count);
  }
  _exit(kGood);
}

}  // namespace

ScenarioResult BrokenResult(std::string id, std::string why) {
  ScenarioResult result;
  result.id = std::move(id);
  result.verdict = score::Verdict::kBroken;
  result.broken = std::move(why);
  return result;
}

std::vector<ScenarioResult> RunApart(std::size_t count, int jobs, const RunLimits& limits, reports::RunPage& page,
                                     const std::function<std::string(std::size_t)>& id,
                                     const std::function<ScenarioResult(std::size_t)>& make,
                                     const std::function<void(std::size_t, const ScenarioResult&)>& took) {
  std::vector<ScenarioResult> results(count);
  std::vector<Child> children;
  const auto take = [&](std::size_t i, ScenarioResult result) {
    results[i] = std::move(result);
    took(i, results[i]);
  };
  const auto begin = [&](std::size_t i) {
    std::fflush(nullptr);  // or a child that ends by exit() would write it once more
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
      return take(i, BrokenResult(id(i), fmt::format("no pipe to its process: {}", std::strerror(errno))));
    const pid_t process = fork();
    if (process == 0) {
      close(ends[0]);
      for (const Child& other : children) close(other.pipe);
      Work(ends[1], limits, [&] {
        const ScenarioResult result = make(i);
        return Packed(result, page.PartOf(result.id));
      });
    }
    close(ends[1]);
    if (process > 0) {
      children.push_back({i, process, ends[0], Clock::now()});
      return;
    }
    close(ends[0]);
    take(i, BrokenResult(id(i), fmt::format("no process for it: {}", std::strerror(errno))));
  };
  const auto end = [&](const Child& child) {
    close(child.pipe);
    int state = 0;
    while (waitpid(child.process, &state, 0) < 0 && errno == EINTR) {
    }
    const nlohmann::json packed = nlohmann::json::from_msgpack(child.bytes, true, false);
    if (!child.too_long && WIFEXITED(state) && WEXITSTATUS(state) == kGood && packed.is_object()) {
      ScenarioResult result = Unpacked(packed);
      if (const auto part = packed.find("part"); part != packed.end())
        page.Put(result.id, {part->at(0), part->at(1), part->at(2), part->at(3)});
      return take(child.index, std::move(result));
    }
    const int exit = WIFEXITED(state) ? WEXITSTATUS(state) : -1;
    take(child.index,
         BrokenResult(id(child.index), child.too_long      ? fmt::format("took longer than {:g} s", limits.most_seconds)
                                       : exit == kNoMemory ? "ran out of memory"
                                       : exit == kEnded    ? "ended the program before it had a result"
                                                           : HowItEnded(state)));
  };
  for (std::size_t next = 0; next < count || !children.empty();) {
    while (next < count && std::ssize(children) < std::max(1, jobs)) begin(next++);
    std::vector<pollfd> waiting;
    for (const Child& child : children) waiting.push_back({child.pipe, POLLIN, 0});
    poll(waiting.data(), waiting.size(), 100);
    for (std::size_t k = waiting.size(); k-- > 0;) {
      Child& child = children[k];
      const double seconds = std::chrono::duration<double>(Clock::now() - child.begun).count();
      if (limits.most_seconds > 0.0 && !child.too_long && !Within(seconds, limits.most_seconds)) {
        child.too_long = true;
        kill(child.process, SIGKILL);
      }
      if (waiting[k].revents == 0) continue;
      std::uint8_t buffer[65536];
      const ssize_t read_now = read(child.pipe, buffer, sizeof buffer);
      if (read_now < 0 && errno == EINTR) continue;
      if (read_now > 0) {
        child.bytes.insert(child.bytes.end(), buffer, buffer + read_now);
        continue;
      }
      const Child ended = std::move(child);
      children.erase(children.begin() + static_cast<std::ptrdiff_t>(k));
      end(ended);
    }
  }
  return results;
}

}  // namespace dynoproof::app
