// The shared library of an exported unit: starts the program for each instance and asks it for each communication step. It allocates in
// its own name, and no exception leaves it.
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "base/fmi2.h"
#include "fmu/frames.h"

#define FMU_EXPORT extern "C" __attribute__((visibility("default")))

extern "C" char** environ;

namespace {

using dynoproof::fmu::Message;

std::string TextOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text;
}

/// The folder that a file: URI names; other text as it is.
std::string FolderOf(std::string uri) {
  const std::string scheme = "file:";
  if (uri.starts_with(scheme)) {
    uri.erase(0, scheme.size());
    if (uri.starts_with("//")) {
      uri.erase(0, 2);
      uri.erase(0, uri.find('/'));  // the host
    }
  }
  std::string folder;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size()) {
      folder += static_cast<char>(std::strtol(uri.substr(i + 1, 2).c_str(), nullptr, 16));
      i += 2;
    } else {
      folder += uri[i];
    }
  }
  return folder;
}

/// The program that computes: the one that the environment names, the one that exported the unit, or the one on the path.
std::string ProgramOf(const std::string& resources) {
  if (const char* named = std::getenv("DYNOPROOF_PROGRAM"); named != nullptr && *named != '\0') return named;
  const std::string exporter = TextOf(resources + "/program.txt");
  return !exporter.empty() && ::access(exporter.c_str(), X_OK) == 0 ? exporter : "dynoproof";
}

enum class Phase { kInstantiated, kInitializing, kStepping, kTerminated, kBroken };

class Instance {
 public:
  Instance(fmi2String name, const fmi2CallbackFunctions& functions) : name_(name), functions_(functions) {}
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  ~Instance() { Stop(); }

  fmi2Status Tell(fmi2Status status, const std::string& message) const {
    if (functions_.logger != nullptr)
      functions_.logger(functions_.componentEnvironment, name_.c_str(), status,
                        status == fmi2Warning ? "logStatusWarning" : "logStatusError", "%s", message.c_str());
    return status;
  }

  bool Open(const std::string& resources, const std::string& guid) {
    resources_ = resources;
    if (const std::string own = TextOf(resources + "/guid.txt"); own != guid)
      return Tell(fmi2Error, "the description is that of another unit: its guid is " + guid + ", this one's " + own),
             false;
    return Start();
  }

  fmi2Status Reset() {
    Stop();
    return Start() ? fmi2OK : Tell(fmi2Error, "the program does not start again");
  }

  fmi2Status Setup(double start_s) {
    if (start_s != 0.0) return Tell(fmi2Error, "a run begins at 0 s");
    return fmi2OK;
  }

  fmi2Status EnterInitialization() {
    if (phase_ != Phase::kInstantiated) return Tell(fmi2Error, "initialization begins once");
    phase_ = Phase::kInitializing;
    return fmi2OK;
  }

  fmi2Status ExitInitialization() {
    if (phase_ != Phase::kInitializing) return Tell(fmi2Error, "no initialization to leave");
    const fmi2Status status = begun_ ? fmi2OK : Begin();
    if (status == fmi2OK) phase_ = Phase::kStepping;
    return status;
  }

  fmi2Status Terminate() {
    Stop();
    phase_ = Phase::kTerminated;
    return fmi2OK;
  }

  fmi2Status Step(double from_s, double step_s) {
    if (phase_ != Phase::kStepping)
      return Tell(fmi2Error, "a step before the initialization is left, or after the end");
    constexpr double kSlack = 1e-6;  // of a period: times of an importer are sums of steps
    const double periods = step_s / period_s_, now = from_s / period_s_;
    if (std::abs(now - static_cast<double>(done_)) > kSlack * std::max(1.0, now))
      return Tell(fmi2Error, "a step from " + std::to_string(from_s) + " s, but the unit is at " +
                                 std::to_string(static_cast<double>(done_) * period_s_) + " s");
    const double whole = std::round(periods);
    if (!(whole >= 1.0) || std::abs(periods - whole) > kSlack * whole)
      return Tell(fmi2Error, "a step of " + std::to_string(step_s) + " s is no whole number of periods of " +
                                 std::to_string(period_s_) + " s");
    std::vector<double> question = {whole};
    question.insert(question.end(), values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(inputs_));
    if (!Ask(dynoproof::fmu::kStep, question)) return fmi2Error;
    done_ += static_cast<long long>(whole);
    return fmi2OK;
  }

  fmi2Status Get(const fmi2ValueReference* references, std::size_t count, double* values) {
    // Outputs at the beginning are there once the parameters are final.
    if (phase_ == Phase::kInitializing && !begun_ && AsksForOutputs(references, count)) {
      if (const fmi2Status status = Begin(); status != fmi2OK) return status;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (references[i] >= values_.size())
        return Tell(fmi2Error, "there is no variable " + std::to_string(references[i]));
      values[i] = values_[references[i]];
    }
    return fmi2OK;
  }

  fmi2Status Set(const fmi2ValueReference* references, std::size_t count, const double* values) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = references[i];
      if (k >= values_.size()) return Tell(fmi2Error, "there is no variable " + std::to_string(k));
      if (k >= inputs_ && k < inputs_ + outputs_) return Tell(fmi2Error, "an output cannot be set");
      if (k >= inputs_ + outputs_ && (begun_ || phase_ == Phase::kStepping))
        return Tell(fmi2Error, "a parameter is set before the initialization ends");
      values_[k] = values[i];
    }
    return fmi2OK;
  }

  double now_s() const { return static_cast<double>(done_) * period_s_; }
  bool terminated() const { return phase_ == Phase::kTerminated || phase_ == Phase::kBroken; }

 private:
  bool AsksForOutputs(const fmi2ValueReference* references, std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) {
      if (references[i] >= inputs_ && references[i] < inputs_ + outputs_) return true;
    }
    return false;
  }

  bool Start() {
    int pair[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
      return Tell(fmi2Error, std::string("no socket: ") + std::strerror(errno)), false;
    const std::string program = ProgramOf(resources_), scenario = resources_ + "/scenario.toml";
    std::string words[] = {program, "fmu-server", scenario};
    char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    // The other end may have that number already; then a copy of the same number would keep it closed for the program.
    const int other = pair[1] == dynoproof::fmu::kSocket ? ::fcntl(pair[1], F_DUPFD_CLOEXEC, 10) : pair[1];
    posix_spawn_file_actions_adddup2(&actions, other, dynoproof::fmu::kSocket);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, 2, 1);  // the importer's stdout is its own
    const int failed = ::posix_spawnp(&program_, words[0].c_str(), &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (other != pair[1]) ::close(other);
    ::close(pair[1]);
    socket_ = pair[0];
    if (failed != 0) {
      program_ = -1;
      Stop();
      return Tell(fmi2Error, program + " does not start: " + std::strerror(failed) +
                                 ". Install dynoproof, or name it in the environment variable DYNOPROOF_PROGRAM"),
             false;
    }
    begun_ = false;
    done_ = 0;
    phase_ = Phase::kInstantiated;
    std::vector<double> numbers;
    if (!Talk(dynoproof::fmu::kDescribe, {}, numbers)) return false;
    if (numbers.size() < 4) return Tell(fmi2Error, "the program is of another version"), false;
    period_s_ = numbers[0];
    inputs_ = static_cast<std::size_t>(numbers[1]);
    outputs_ = static_cast<std::size_t>(numbers[2]);
    // Then what all variables begin with.
    values_.assign(numbers.begin() + 4, numbers.end());
    return values_.size() == inputs_ + outputs_ + static_cast<std::size_t>(numbers[3]) ||
           (Tell(fmi2Error, "the program is of another version"), false);
  }

  void Stop() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    if (program_ > 0) {
      int status = 0;
      while (::waitpid(program_, &status, 0) < 0 && errno == EINTR) {
      }
    }
    program_ = -1;
  }

  fmi2Status Begin() {
    std::vector<double> question(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(inputs_));
    question.insert(question.end(), values_.begin() + static_cast<std::ptrdiff_t>(inputs_ + outputs_), values_.end());
    if (!Ask(dynoproof::fmu::kBegin, question)) return fmi2Error;
    begun_ = true;
    return fmi2OK;
  }

  /// A question whose answer is the outputs.
  bool Ask(dynoproof::fmu::Kind kind, const std::vector<double>& numbers) {
    std::vector<double> answer;
    if (!Talk(kind, numbers, answer)) return false;
    if (answer.size() != outputs_) return Tell(fmi2Error, "another number of outputs"), false;
    std::copy(answer.begin(), answer.end(), values_.begin() + static_cast<std::ptrdiff_t>(inputs_));
    return true;
  }

  bool Talk(dynoproof::fmu::Kind kind, const std::vector<double>& numbers, std::vector<double>& answer) {
    Message message;
    if (!dynoproof::fmu::Send(socket_, kind, std::span<const double>(numbers)) ||
        !dynoproof::fmu::Receive(socket_, message)) {
      phase_ = Phase::kBroken;
      return Tell(fmi2Error, "the program has ended"), false;
    }
    if (message.kind == dynoproof::fmu::kFault) {
      phase_ = Phase::kBroken;
      return Tell(fmi2Error, message.Text()), false;
    }
    answer = message.Numbers();
    return true;
  }

  std::string name_, resources_;
  fmi2CallbackFunctions functions_;
  int socket_ = -1;
  pid_t program_ = -1;
  Phase phase_ = Phase::kInstantiated;
  bool begun_ = false;
  double period_s_ = 0.0;
  std::size_t inputs_ = 0, outputs_ = 0;
  long long done_ = 0;          // periods
  std::vector<double> values_;  // by reference: inputs, outputs, parameters
};

Instance& Of(fmi2Component component) { return *static_cast<Instance*>(component); }

/// No exception leaves the library.
template <class Work>
fmi2Status Guarded(fmi2Component component, const Work& work) {
  if (component == nullptr) return fmi2Error;
  try {
    return work(Of(component));
  } catch (const std::exception& error) {
    return Of(component).Tell(fmi2Error, error.what());
  } catch (...) {
    return Of(component).Tell(fmi2Error, "unexpected");
  }
}

fmi2Status NotThere(fmi2Component component, const char* what) {
  return Guarded(component,
                 [&](Instance& one) { return one.Tell(fmi2Error, std::string(what) + ": the unit has none"); });
}

}  // namespace

FMU_EXPORT const char* fmi2GetTypesPlatform() { return "default"; }
FMU_EXPORT const char* fmi2GetVersion() { return "2.0"; }
FMU_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component, fmi2Boolean, std::size_t, const fmi2String[]) {
  return fmi2OK;
}

FMU_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                         const fmi2CallbackFunctions* functions, fmi2Boolean, fmi2Boolean) {
  if (functions == nullptr || name == nullptr || guid == nullptr) return nullptr;
  try {
    auto* made = new Instance(name, *functions);
    const bool opened = type == fmi2CoSimulation ? resources != nullptr && made->Open(FolderOf(resources), guid)
                                                 : (made->Tell(fmi2Error, "a unit for co-simulation alone"), false);
    if (opened) return made;
    delete made;
  } catch (...) {
    // There is nothing to say it with.
  }
  return nullptr;
}

FMU_EXPORT void fmi2FreeInstance(fmi2Component component) { delete static_cast<Instance*>(component); }

FMU_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean, fmi2Real, fmi2Real start, fmi2Boolean,
                                          fmi2Real) {
  return Guarded(component, [&](Instance& one) { return one.Setup(start); });
}
FMU_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return Guarded(component, [](Instance& one) { return one.EnterInitialization(); });
}
FMU_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  return Guarded(component, [](Instance& one) { return one.ExitInitialization(); });
}
FMU_EXPORT fmi2Status fmi2Terminate(fmi2Component component) {
  return Guarded(component, [](Instance& one) { return one.Terminate(); });
}
FMU_EXPORT fmi2Status fmi2Reset(fmi2Component component) {
  return Guarded(component, [](Instance& one) { return one.Reset(); });
}

FMU_EXPORT fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                                  fmi2Real values[]) {
  return Guarded(component, [&](Instance& one) { return one.Get(references, count, values); });
}
FMU_EXPORT fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                                  const fmi2Real values[]) {
  return Guarded(component, [&](Instance& one) { return one.Set(references, count, values); });
}

// Variables of other types there are none: to ask for none of them is fine.
FMU_EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference[], std::size_t count, fmi2Integer[]) {
  return count == 0 ? fmi2OK : NotThere(c, "integers");
}
FMU_EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference[], std::size_t count, fmi2Boolean[]) {
  return count == 0 ? fmi2OK : NotThere(c, "booleans");
}
FMU_EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference[], std::size_t count, fmi2String[]) {
  return count == 0 ? fmi2OK : NotThere(c, "strings");
}
FMU_EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference[], std::size_t count,
                                     const fmi2Integer[]) {
  return count == 0 ? fmi2OK : NotThere(c, "integers");
}
FMU_EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference[], std::size_t count,
                                     const fmi2Boolean[]) {
  return count == 0 ? fmi2OK : NotThere(c, "booleans");
}
FMU_EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference[], std::size_t count,
                                    const fmi2String[]) {
  return count == 0 ? fmi2OK : NotThere(c, "strings");
}

// Functions of capabilities that the description does not declare.
FMU_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate*) { return NotThere(c, "states to keep"); }
FMU_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate) { return NotThere(c, "states to keep"); }
FMU_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate*) { return NotThere(c, "states to keep"); }
FMU_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate, std::size_t*) {
  return NotThere(c, "states to keep");
}
FMU_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate, fmi2Byte[], std::size_t) {
  return NotThere(c, "states to keep");
}
FMU_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte[], std::size_t, fmi2FMUstate*) {
  return NotThere(c, "states to keep");
}
FMU_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference[], std::size_t,
                                                   const fmi2ValueReference[], std::size_t, const fmi2Real[],
                                                   fmi2Real[]) {
  return NotThere(c, "directional derivatives");
}
FMU_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference[], std::size_t,
                                                  const fmi2Integer[], const fmi2Real[]) {
  return NotThere(c, "derivatives of inputs");
}
FMU_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference[], std::size_t,
                                                   const fmi2Integer[], fmi2Real[]) {
  return NotThere(c, "derivatives of outputs");
}

FMU_EXPORT fmi2Status fmi2DoStep(fmi2Component component, fmi2Real now, fmi2Real step, fmi2Boolean) {
  return Guarded(component, [&](Instance& one) { return one.Step(now, step); });
}
FMU_EXPORT fmi2Status fmi2CancelStep(fmi2Component c) { return NotThere(c, "steps that go on"); }
FMU_EXPORT fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind, fmi2Status*) {
  return NotThere(c, "steps that go on");
}
FMU_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real* value) {
  return Guarded(component, [&](Instance& one) {
    if (kind != fmi2LastSuccessfulTime) return one.Tell(fmi2Discard, "of that kind nothing is kept");
    *value = one.now_s();
    return fmi2OK;
  });
}
FMU_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind, fmi2Integer*) {
  return NotThere(c, "integers");
}
FMU_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean* value) {
  return Guarded(component, [&](Instance& one) {
    if (kind != fmi2Terminated) return one.Tell(fmi2Discard, "of that kind nothing is kept");
    *value = one.terminated() ? 1 : 0;
    return fmi2OK;
  });
}
FMU_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind, fmi2String*) {
  return NotThere(c, "steps that go on");
}
