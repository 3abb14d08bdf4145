// Ctrl-C in a command that may take long.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "app/app.h"

namespace dynoproof::app {

/// While one lives, SIGINT and SIGTERM end the program at once, not after the step that is on its way: files appear
/// whole or not at all at any time. `words` says what is done and what is not, and may keep a document for --json; the
/// exit code is kUndecided. Threads that are to be interrupted are begun afterwards.
class Interruption {
 public:
  Interruption(const Common& common, std::function<std::string()> words);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

 private:
  std::atomic<bool> over_ = false;
  std::thread watcher_;
};

}  // namespace dynoproof::app
