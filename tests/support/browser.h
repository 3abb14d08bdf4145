// A headless Chromium, driven through its DevTools pipe: opens a page, asks it, presses its keys, and collects what it
// complains about.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/temp_dir.h"

namespace dynoproof::test {

class Browser {
 public:
  /// Debian's, or $DYNOPROOF_BROWSER.
  static std::string Program() {
    const char* const chosen = std::getenv("DYNOPROOF_BROWSER");
    return chosen != nullptr && *chosen != '\0' ? chosen : "/usr/bin/chromium";
  }
  /// Whether there is one to start.
  static bool Installed() { return ::access(Program().c_str(), X_OK) == 0; }
  /// Whether its absence is a failure: on a machine of CI nobody would read that tests were skipped.
  static bool Required() {
    const char* const ci = std::getenv("CI");
    return ci != nullptr && *ci != '\0';
  }

  Browser() {
    int to[2], from[2];
    if (::pipe(to) != 0 || ::pipe(from) != 0) throw std::runtime_error("no pipe");
    const std::string program = Program(), profile = "--user-data-dir=" + (profile_ / "profile").string();
    process_ = ::fork();
    if (process_ < 0) throw std::runtime_error("cannot fork");
    if (process_ == 0) {
      ::setpgid(0, 0);  // its helpers go with it
      const int in = ::fcntl(to[0], F_DUPFD, 10), out = ::fcntl(from[1], F_DUPFD, 10);
      ::dup2(in, 3);   // what the browser reads, and
      ::dup2(out, 4);  // where it answers
      const int null = ::open("/dev/null", O_RDWR);
      for (int i = 0; i < 3; ++i) ::dup2(null, i);
      // It must ask nobody for anything: no updates, no services of its maker.
      ::execl(program.c_str(), "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
              "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
              "--disable-sync", "--remote-debugging-pipe", profile.c_str(), "about:blank", nullptr);
      ::_exit(127);
    }
    ::close(to[0]);
    ::close(from[1]);
    write_ = to[1];
    read_ = from[0];
    const std::string target = Call("Target.createTarget", {{"url", "about:blank"}}).at("targetId");
    session_ = Call("Target.attachToTarget", {{"targetId", target}, {"flatten", true}}).at("sessionId");
    for (const char* domain : {"Runtime", "Log", "Page", "Network"}) Call(std::string(domain) + ".enable", {});
  }
  ~Browser() {
    ::kill(-process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    ::close(write_);
    ::close(read_);
  }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Errors, exceptions and messages of the console, and addresses that were asked for, as they came.
  std::vector<std::string> complaints, requests;

  void Size(int width, int height) {
    Call("Emulation.setDeviceMetricsOverride",
         {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
  }
  void Open(const std::string& url) {
    Call("Page.navigate", {{"url", url}});
    for (int i = 0; Ask("document.readyState") != "complete"; ++i) {
      if (i > 100) throw std::runtime_error("the page does not come");
      ::usleep(100'000);
    }
  }
  /// The value of an expression; promises are waited for.
  nlohmann::json Ask(const std::string& expression) {
    const nlohmann::json answer =
        Call("Runtime.evaluate", {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
    if (answer.contains("exceptionDetails")) throw std::runtime_error(answer.dump());
    return answer.at("result").value("value", nlohmann::json());
  }
  void Mouse(const char* type, double x, double y, int buttons, const nlohmann::json& more = {}) {
    nlohmann::json event = {{"type", type}, {"x", x}, {"y", y}, {"buttons", buttons}, {"clickCount", 1}};
    event["button"] = buttons != 0 || std::string(type) == "mouseReleased" ? "left" : "none";
    if (more.is_object()) event.update(more);
    Call("Input.dispatchMouseEvent", event);
  }
  void Key(const std::string& key) {
    for (const char* type : {"keyDown", "keyUp"}) {
      nlohmann::json event = {{"type", type}, {"key", key}};
      if (key == "Tab") event.update({{"windowsVirtualKeyCode", 9}, {"code", "Tab"}});
      Call("Input.dispatchKeyEvent", event);
    }
  }

  nlohmann::json Call(const std::string& method, const nlohmann::json& parameters) {
    nlohmann::json message = {
        {"id", ++last_}, {"method", method}, {"params", parameters.is_null() ? nlohmann::json::object() : parameters}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump() + '\0';
    if (::write(write_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      throw std::runtime_error("the browser does not listen");
    for (;;) {
      const nlohmann::json answer = Next();
      if (answer.value("id", 0) == last_) {
        if (answer.contains("error")) throw std::runtime_error(method + ": " + answer.at("error").dump());
        return answer.at("result");
      }
      const std::string event = answer.value("method", "");
      if (event == "Runtime.exceptionThrown" || event == "Log.entryAdded" || event == "Runtime.consoleAPICalled")
        complaints.push_back(answer.at("params").dump());
      if (event == "Network.requestWillBeSent") requests.push_back(answer.at("params").at("request").at("url"));
    }
  }

 private:
  nlohmann::json Next() {
    for (;;) {
      if (const std::size_t end = buffer_.find('\0'); end != std::string::npos) {
        const nlohmann::json message = nlohmann::json::parse(buffer_.substr(0, end));
        buffer_.erase(0, end + 1);
        return message;
      }
      pollfd ready{read_, POLLIN, 0};
      if (::poll(&ready, 1, 60'000) <= 0) throw std::runtime_error("the browser is silent");
      char piece[65536];
      const ssize_t n = ::read(read_, piece, sizeof piece);
      if (n <= 0) throw std::runtime_error("the browser has gone");
      buffer_.append(piece, static_cast<std::size_t>(n));
    }
  }

  TempDir profile_;
  pid_t process_ = -1;
  int write_ = -1, read_ = -1, last_ = 0;
  std::string session_, buffer_;
};

/// For SetUp() of a test that needs it: skipped with the reason on a machine that has none, failed where CI is set.
#define DYNOPROOF_NEEDS_BROWSER()                                                                          \
  if (!Browser::Installed()) {                                                                             \
    if (Browser::Required())                                                                               \
      FAIL() << Browser::Program() << " is missing, CI is set: the pages must be looked at (ci/setup.sh)"; \
    GTEST_SKIP() << "chromium is not installed: NO PAGE WAS LOOKED AT; ci/setup.sh installs it";           \
  }                                                                                                        \
  static_assert(true)

}  // namespace dynoproof::test
