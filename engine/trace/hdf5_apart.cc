#include "trace/hdf5_apart.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

namespace dynoproof::trace {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif
#else
constexpr bool kSanitized = false;
#endif

constexpr std::size_t kBuffer = std::size_t{1} << 16;
constexpr std::uint64_t kEnd = 0x656e64206f6b2121;  // the last word: everything came
constexpr int kSilence_ms = 600'000;            // whoever computes is bound by the limit of CPU time: this one waits
constexpr int kNoMemory = 97, kException = 98;  // exit codes between the two processes

/// The address space that this process has now [bytes]; 0: unknown.
std::uint64_t AddressSpace() {
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr) return 0;
  unsigned long pages = 0;
  const bool read = std::fscanf(file, "%lu", &pages) == 1;
  std::fclose(file);
  return read ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

template <class Resource>  // an enumeration here, a number elsewhere
void Limit(Resource resource, std::uint64_t most) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, most);
  setrlimit(resource, &limit);
}

[[noreturn]] void Work(const ApartLimits& limits, std::uint64_t memory, const std::function<void(Sender&)>& work,
                       int pipe) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGPIPE}) {
    if (!kSanitized) std::signal(number, SIG_DFL);
  }
  std::signal(SIGPROF, SIG_DFL);
  std::signal(SIGXCPU, SIG_DFL);
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  Limit(RLIMIT_CORE, 0);
  // The timer is finer than the limit of resources, which counts whole seconds.
  const double cpu_s = limits.cpu_s * (kSanitized ? 3.0 : 1.0);
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(cpu_s);
  timer.it_value.tv_usec = static_cast<suseconds_t>(1e6 * (cpu_s - std::floor(cpu_s)));
  setitimer(ITIMER_PROF, &timer, nullptr);
  Limit(RLIMIT_CPU, static_cast<std::uint64_t>(cpu_s) + 2);
  if (!kSanitized) {
    if (memory > 0) Limit(RLIMIT_AS, memory + limits.memory_bytes);
    // What the C library says of a heap that the HDF5 library has damaged is no business of the user's.
    const int nowhere = open("/dev/null", O_WRONLY);
    if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  }
  try {
    Sender sender(pipe);
    work(sender);
    std::uint64_t end = kEnd;
    Pass(sender, end);
    _exit(sender.Flush() ? 0 : 1);
  } catch (const std::bad_alloc&) {
    _exit(kNoMemory);
  } catch (...) {
    _exit(kException);
  }
}

/// Waits for a process, and says how it ended; "" if well.
std::string EndOf(pid_t process, const ApartLimits& limits, int& exit_code) {
  int state = 0;
  while (waitpid(process, &state, 0) < 0 && errno == EINTR) {
  }
  exit_code = 2;
  if (WIFEXITED(state)) {
    const int code = WEXITSTATUS(state);
    if (code == 0) return "";
    if (code == kNoMemory) return fmt::format("reading it takes more than {} MB of memory", limits.memory_bytes >> 20);
    return fmt::format("{} ended with exit code {} while reading it: the file is damaged", limits.reader, code);
  }
  const int number = WTERMSIG(state);
  if (number == SIGXCPU || number == SIGPROF)
    return fmt::format("{} was still reading after {} s of computing: the file is damaged", limits.reader,
                       limits.cpu_s);
  if (number == SIGKILL || number == SIGTERM || number == SIGINT || number == SIGHUP) {
    exit_code = 3;  // somebody ended it, or the system was out of memory: no fault of the file
    return fmt::format("the process that read it was ended from outside (signal {})", number);
  }
  return fmt::format("{} died of signal {} ({}) while reading it: the file is damaged", limits.reader, number,
                     strsignal(number));
}

}  // namespace

bool ReadsHere() {
#if defined(DYNOPROOF_FUZZ)
  static const bool here = std::getenv("DYNOPROOF_READ_APART") == nullptr;
  return here;
#else
  return false;
#endif
}

void Sender::Bytes(const void* data, std::size_t count) {
  const auto* bytes = static_cast<const char*>(data);
  if (count < kBuffer) {
    waiting_.insert(waiting_.end(), bytes, bytes + count);
    if (waiting_.size() >= kBuffer) Flush();
    return;
  }
  Flush();
  while (ok_ && count > 0) {
    const ssize_t written = write(pipe_, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      ok_ = false;
      return;
    }
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
}

bool Sender::Flush() {
  std::size_t done = 0;
  while (ok_ && done < waiting_.size()) {
    const ssize_t written = write(pipe_, waiting_.data() + done, waiting_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    ok_ = written > 0;
    if (ok_) done += static_cast<std::size_t>(written);
  }
  waiting_.clear();
  return ok_;
}

void Receiver::Bytes(void* data, std::size_t count) {
  auto* bytes = static_cast<char*>(data);
  while (ok_ && count > 0) {
    if (next_ < buffer_.size()) {
      const std::size_t some = std::min(count, buffer_.size() - next_);
      std::memcpy(bytes, buffer_.data() + next_, some);
      next_ += some;
      bytes += some;
      count -= some;
      continue;
    }
    pollfd waiting = {pipe_, POLLIN, 0};
    const int ready = poll(&waiting, 1, kSilence_ms);
    if (ready < 0 && errno == EINTR) continue;
    // Much goes straight to its place.
    const bool straight = count >= kBuffer;
    if (!straight) buffer_.resize(kBuffer);
    next_ = 0;
    const ssize_t got = ready <= 0 ? -1 : read(pipe_, straight ? bytes : buffer_.data(), straight ? count : kBuffer);
    if (got < 0 && ready > 0 && errno == EINTR) {
      buffer_.clear();
      continue;
    }
    if (got <= 0) {
      ok_ = false;
      silent_ = ready == 0;
      buffer_.clear();
      std::memset(bytes, 0, count);
      return;
    }
    if (straight) {
      buffer_.clear();
      bytes += got;
      count -= static_cast<std::size_t>(got);
    } else {
      buffer_.resize(static_cast<std::size_t>(got));
    }
  }
  if (!ok_ && count > 0) std::memset(bytes, 0, count);
}

std::size_t Receiver::Count(std::size_t size) {
  std::uint64_t number = 0;
  Bytes(&number, sizeof number);
  constexpr std::uint64_t kMost = std::uint64_t{8} << 30;  // the other process may have lost its senses
  if (!ok_ || number > kMost / std::max<std::size_t>(size, 1)) {
    ok_ = false;
    return 0;
  }
  return static_cast<std::size_t>(number);
}

Status RunApart(const ApartLimits& limits, const std::function<void(Sender&)>& work,
                const std::function<void(Receiver&)>& take) {
  const auto impossible = [](const char* what) {
    return Failure{.message = fmt::format("no process to read it in: {}: {}", what, std::strerror(errno))};
  };
  int ends[2];
  if (pipe(ends) != 0) return impossible("pipe");
  for (const int end : ends) fcntl(end, F_SETFD, FD_CLOEXEC);
#ifdef F_SETPIPE_SZ
  fcntl(ends[1], F_SETPIPE_SZ, 1 << 20);  // fewer turns between the two; no matter if it may not be
#endif
  const std::uint64_t memory = AddressSpace();
  const pid_t process = fork();
  if (process == 0) {
    close(ends[0]);
    Work(limits, memory, work, ends[1]);
  }
  close(ends[1]);
  if (process < 0) {
    const Failure failure = impossible("fork");
    close(ends[0]);
    return failure;
  }
  Receiver receiver(ends[0]);
  std::uint64_t end = 0;
  bool no_memory = false;
  try {
    take(receiver);
    Pass(receiver, end);
  } catch (const std::bad_alloc&) {
    no_memory = true;
  }
  const bool whole = receiver.ok() && end == kEnd;
  if (!whole) kill(process, SIGKILL);
  close(ends[0]);
  int exit_code = 2;
  std::string how = EndOf(process, limits, exit_code);
  if (no_memory) return Failure{.message = "does not fit into memory", .signal = {}, .time_s = {}, .exit_code = 2};
  if (receiver.silent())
    return Failure{.message = fmt::format("{} was silent for {} s", limits.reader, kSilence_ms / 1000),
                   .signal = {},
                   .time_s = {},
                   .exit_code = 2};
  if (!how.empty()) return Failure{.message = std::move(how), .signal = {}, .time_s = {}, .exit_code = exit_code};
  if (!whole)
    return Failure{
        .message = "the process that read it sent something else", .signal = {}, .time_s = {}, .exit_code = 2};
  return {};
}

}  // namespace dynoproof::trace
