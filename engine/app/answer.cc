#include "app/answer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string_view>

#include "app/app.h"
#include "base/json_text.h"
#include "reports/run_report.h"

namespace dynoproof::app {
namespace {

struct Answer {
  std::mutex lock;  // Ctrl-C is answered by a thread of its own
  nlohmann::json document = nlohmann::json::object();
  nlohmann::json diagnostics = nlohmann::json::array();
};

Answer& TheAnswer() {
  static Answer answer;
  return answer;
}

void Say(const char* severity, const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::string message = text;
  message.erase(message.find_last_not_of('\n') + 1);
  message.erase(0, message.find_first_not_of('\n'));
  const std::lock_guard<std::mutex> lock(TheAnswer().lock);
  TheAnswer().diagnostics.push_back({{"severity", severity}, {"message", std::move(message)}});
}

}  // namespace

void Complain(const std::string& text) { Say("error", text); }

void Note(const std::string& text) { Say("note", text); }

int Report(const Diagnostics& diagnostics) {
  ClearProgress();
  std::string text = diagnostics.Format(ColourOn(STDERR_FILENO));
  if (const int count = diagnostics.error_count(); count > 0)
    text += fmt::format("{} error{}\n", count, count == 1 ? "" : "s");
  std::fputs(text.c_str(), stderr);
  const std::lock_guard<std::mutex> lock(TheAnswer().lock);
  for (const Diagnostic& item : diagnostics.items()) TheAnswer().diagnostics.push_back(AsJson(item));
  return diagnostics.has_errors() ? kUsage : kGood;
}

nlohmann::json AsJson(const Diagnostic& diagnostic) {
  return {{"severity", diagnostic.severity == Diagnostic::Severity::kError ? "error" : "warning"},
          {"message", diagnostic.message},
          {"hint", diagnostic.hint},
          {"file", diagnostic.where.file},
          {"line", diagnostic.where.line},
          {"column", diagnostic.where.column}};
}

void KeepJson(nlohmann::json document) {
  const std::lock_guard<std::mutex> lock(TheAnswer().lock);
  TheAnswer().document = std::move(document);
}

std::string JsonFile(int argc, const char* const* argv) {
  constexpr std::string_view kOption = "--json", kJoined = "--json=";
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--") break;
    if (word == kOption) return i + 1 < argc && !std::string_view(argv[i + 1]).starts_with("--") ? argv[i + 1] : "";
    if (word.starts_with(kJoined)) return std::string(word.substr(kJoined.size()));
  }
  return "";
}

int FinishJson(const std::string& file, int exit) {
  if (file.empty()) return exit;
  std::string text;
  {
    const std::lock_guard<std::mutex> lock(TheAnswer().lock);
    nlohmann::json document = TheAnswer().document;
    document["exit"] = exit;
    document["diagnostics"] = TheAnswer().diagnostics;
    text = JsonText(document, 2) + "\n";
  }
  if (file != "-") return reports::WorseExit(exit, WriteText(file, text));
  const bool written = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  return written ? exit : reports::WorseExit(exit, kBroken);
}

}  // namespace dynoproof::app
