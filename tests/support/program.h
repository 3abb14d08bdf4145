// Calls the program as a user does: a child process with its own folder, environment and, if asked for, terminal.
#pragma once

#include <fcntl.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/temp_dir.h"

#ifndef DYNOPROOF_PROGRAM
#error "the build must say where the program is"
#endif

namespace dynoproof::test {

/// How a call ended. `exit` is -1 when a signal ended it.
struct Outcome {
  int exit = -1;
  int signal = 0;
  std::string out, err;  // on a terminal both are in `out`

  /// For messages of a failing test.
  std::string Both() const { return "--- exit " + std::to_string(exit) + ", out\n" + out + "--- err\n" + err; }
};

struct CallOptions {
  std::filesystem::path folder = {};                    // where it runs
  std::map<std::string, std::string> environment = {};  // on top of a clean one
  bool terminal = false;                                // stdout and stderr are a terminal
  long largest_file = -1;                               // bytes; writing more fails as on a full disk
  std::string program = DYNOPROOF_PROGRAM;
  unsigned limit_s = 300;  // a hung program ends the test, not the day
};

namespace detail {

[[noreturn]] inline void Become(const std::vector<std::string>& arguments, const CallOptions& options) {
  // What the tests' own surroundings have set must not decide what is tested.
  for (const char* name :
       {"CI", "NO_COLOR", "DYNOPROOF_SCENARIOS", "DYNOPROOF_GOLDEN", "DYNOPROOF_PLUGIN_PATH", "DP_TOL_SCALE"})
    ::unsetenv(name);
  for (const auto& [name, value] : options.environment) ::setenv(name.c_str(), value.c_str(), 1);
  if (!options.folder.empty() && ::chdir(options.folder.c_str()) != 0) ::_exit(126);
  if (options.largest_file >= 0) {
    ::signal(SIGXFSZ, SIG_IGN);  // then write() fails with EFBIG
    const rlimit limit{static_cast<rlim_t>(options.largest_file), static_cast<rlim_t>(options.largest_file)};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ::alarm(options.limit_s);
  std::vector<char*> words = {const_cast<char*>(options.program.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  ::execvp(words[0], words.data());
  ::_exit(127);
}

inline void Wait(pid_t child, Outcome& outcome) {
  int status = 0;
  if (::waitpid(child, &status, 0) != child) throw std::runtime_error("lost the child process");
  if (WIFEXITED(status)) outcome.exit = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
}

}  // namespace detail

/// Runs the program to its end.
inline Outcome Call(const std::vector<std::string>& arguments, const CallOptions& options = {}) {
  Outcome outcome;
  if (options.terminal) {
    int terminal = -1;
    const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child < 0) throw std::runtime_error("no pseudo terminal");
    if (child == 0) detail::Become(arguments, options);
    char buffer[4096];
    for (ssize_t n = 0; (n = ::read(terminal, buffer, sizeof buffer)) > 0;) outcome.out.append(buffer, n);
    ::close(terminal);
    detail::Wait(child, outcome);
    return outcome;
  }
  const TempDir capture;  // files, not pipes: nothing to drain, nothing to dead-lock
  const std::string out = capture / "out", err = capture / "err";
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
    ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    detail::Become(arguments, options);
  }
  detail::Wait(child, outcome);
  outcome.out = ReadBytes(out);
  outcome.err = ReadBytes(err);
  return outcome;
}

/// A temporary folder in which the program is called, with a small scenario `line.toml` of 0.05 s whose checks pass.
class Bench {
 public:
  Bench() { folder_.Write("line.toml", kLine); }

  const std::filesystem::path& path() const { return folder_.path(); }
  std::filesystem::path operator/(std::string_view name) const { return folder_ / name; }
  const TempDir& folder() const { return folder_; }
  std::filesystem::path Write(std::string_view name, std::string_view text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    return folder_.Write(name, text);
  }
  Outcome Call(const std::vector<std::string>& arguments, CallOptions options = {}) const {
    if (options.folder.empty()) options.folder = folder_.path();
    return test::Call(arguments, options);
  }
  /// The document that a command writes to stdout with --json -.
  nlohmann::json Json(std::vector<std::string> arguments, const CallOptions& options = {}) const {
    arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = Call(arguments, options);
    nlohmann::json document = nlohmann::json::parse(outcome.out, nullptr, false);
    if (document.is_discarded()) throw std::runtime_error("no JSON\n" + outcome.Both());
    return document;
  }

  static constexpr const char* kLine = R"(title = "three masses"
source = "made up"

[run]
duration_s = 0.05

[plant]
type = "drive_line"

[plant.inertia]
I1 = 2.0
I2 = 0.3
I3 = 0.5

[plant.shaft.k1]
between = ["I1", "I2"]
stiffness_Nm_per_rad = 4.0e5
damping_Nms_per_rad = 8.0

[plant.shaft.k2]
between = ["I2", "I3"]
stiffness_Nm_per_rad = 2.5e5
damping_Nms_per_rad = 6.0

[plant.torque.T_airgap]
on = "I1"

[input.T_airgap]
to = "plant.T_airgap"
unit = "N m"
nominal = 100.0
source = { type = "chirp", amplitude = 100.0, end_Hz = 400.0, rate_Hz_per_s = 8000.0 }

[output.T_shaft]
of = "plant.k2.torque"
nominal = 100.0

[output.omega_1]
of = "plant.I1.speed"

[analysis]
input = "T_airgap"
output = "T_shaft"

[[check]]
kind = "solvers"
signal = "T_shaft"
nrmse = 1e-6
origin = "discretisation"

[[check]]
kind = "oracle"
oracle = "held_input_exponential"
signal = "T_shaft"
nrmse = 1e-9
origin = "round-off"
)";

 private:
  TempDir folder_;
};

}  // namespace dynoproof::test
