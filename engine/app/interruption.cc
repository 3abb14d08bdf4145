#include "app/interruption.h"

#include <pthread.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <utility>

namespace dynoproof::app {
namespace {

sigset_t Signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

}  // namespace

Interruption::Interruption(const Common& common, std::function<std::string()> words) {
  // A thread of its own waits for them: a handler may neither lock nor print.
  const sigset_t set = Signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  watcher_ = std::thread([this, file = common.json, words = std::move(words)] {
    const sigset_t signals = Signals();
    int signal = 0;
    sigwait(&signals, &signal);
    if (over_) return;
    ClearProgress();
    Complain(words());
    const int exit = FinishJson(file, kUndecided);
    std::fflush(nullptr);
    ::_exit(exit);
  });
}

Interruption::~Interruption() {
  over_ = true;
  pthread_kill(watcher_.native_handle(), SIGTERM);  // wakes it, and nothing else: the signal is blocked
  watcher_.join();
  const sigset_t set = Signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

}  // namespace dynoproof::app
