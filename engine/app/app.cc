#include "app/app.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "base/atomic_file.h"
#include "model/plugin_loader.h"
#include "reports/html.h"
#ifdef DYNOPROOF_THESIS
#include "thesis/register.h"
#endif

namespace dynoproof::app {

void Print(const Common& common, const std::string& text) {
  std::fputs(text.c_str(), common.json == "-" ? stderr : stdout);
}

int WriteText(const std::string& file, const std::string& text) {
  const Status failed = WriteFileAtomically(file, text);
  if (!failed) return kGood;
  Complain(failed->ToString() + "\n");
  return kBroken;
}

int WriteHtml(const std::string& file, const std::string& page) {
  if (!reports::HasPlotLibrary())
    Note("uPlot could not be fetched when this program was built: the page draws its pictures plainly\n");
  return WriteText(file, page);
}

bool UnderCi() {
  const char* const ci = std::getenv("CI");
  return ci != nullptr && *ci != '\0';
}

bool Writable(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && access(folder.c_str(), W_OK) == 0) return true;
  Complain(fmt::format("cannot write to the folder \"{}\"\n", folder));
  return false;
}

bool CanWrite(const std::vector<std::string>& files) {
  bool good = true;
  for (const std::string& file : files) {
    if (file.empty() || file == "-") continue;
    if (std::error_code error; std::filesystem::is_directory(file, error)) {
      Complain(fmt::format("cannot write the file \"{}\": it is a folder\n", file));
      good = false;
      continue;
    }
    const std::string folder = std::filesystem::path(file).parent_path().string();
    good = Writable(folder.empty() ? "." : folder) && good;
  }
  return good;
}

bool IsTerminal(int descriptor) { return isatty(descriptor) == 1; }

bool ColourOn(int descriptor) {
  const char* off = std::getenv("NO_COLOR");
  return IsTerminal(descriptor) && (off == nullptr || *off == '\0');
}

std::unique_ptr<Registry> MakeRegistry(const Common& common, Diagnostics& diagnostics) {
  auto registry = std::make_unique<Registry>();
  RegisterBuiltIns(*registry);
  RegisterChecks(*registry);
#ifdef DYNOPROOF_THESIS
  RegisterThesis(*registry);
#endif
  for (const std::string& file : PluginFiles(common.plugins, diagnostics)) {
    if (const Status failed = LoadPlugin(file, *registry)) diagnostics.Error({failed->signal}, failed->message);
  }
  return registry;
}

void ShowProgress(const std::string& what, double fraction) {
  if (!IsTerminal(STDERR_FILENO)) {
    // A log takes a line now and then, and none of what is over soon. The callers call one at a time.
    constexpr std::chrono::seconds kBetween(10);
    static auto last = std::chrono::steady_clock::now();
    const auto now = std::chrono::steady_clock::now();
    if (now - last < kBetween) return;
    last = now;
    fmt::print(stderr, "{:.0f} %  {}\n", 100.0 * fraction, what);
    return;
  }
  fmt::print(stderr, "\r\033[K{:>3.0f} %  {}", 100.0 * fraction, what);
  std::fflush(stderr);
}

void ClearProgress() {
  if (IsTerminal(STDERR_FILENO)) std::fputs("\r\033[K", stderr);
}

void AddCommon(Command command, Common& common) {
  command.Value("--json", common.json, "write the result as JSON; - is stdout (tables then go to stderr)");
  command.Value("--plugin", common.plugins, "shared library with plugins; also $DYNOPROOF_PLUGIN_PATH");
}

}  // namespace dynoproof::app
