#include "model/plugin_loader.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <sstream>

namespace dynoproof {

namespace fs = std::filesystem;

Status LoadPlugin(const std::string& file, Registry& registry) {
  const auto refuse = [&file](std::string why) {
    return Failure{.message = std::move(why), .signal = file, .exit_code = 2};
  };
  // dlopen searches the system's folders for a bare name; a plugin is a file that the user named.
  std::error_code error;
  const std::string path = fs::absolute(file, error).string();
  for (const std::string& loaded : registry.libraries()) {
    if (fs::equivalent(loaded, path, error)) return {};  // named twice, or by --plugin and the path of plugins
  }
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return refuse(fmt::format("cannot be loaded: {}", dlerror()));
  const auto* entry = static_cast<const PluginEntry*>(dlsym(library, "dynoproof_plugin"));
  if (entry == nullptr) {
    dlclose(library);
    return refuse("is no dynoproof plugin: it exports no dynoproof_plugin (use the macro DYNOPROOF_PLUGIN)");
  }
  if (entry->stamp == nullptr || entry->register_all == nullptr) {
    dlclose(library);
    return refuse("is no dynoproof plugin: its dynoproof_plugin is empty (use the macro DYNOPROOF_PLUGIN)");
  }
  if (std::string_view(entry->stamp) != DYNOPROOF_ABI_STAMP) {
    const std::string theirs = entry->stamp;
    dlclose(library);
    return refuse(
        fmt::format("was built against another dynoproof or compiler; build it again\n  plugin:  {}\n  program: {}",
                    theirs, DYNOPROOF_ABI_STAMP));
  }
  registry.BeginLibrary(path);
  try {
    entry->register_all(registry);
  } catch (const std::exception& thrown) {
    return refuse(fmt::format("fails while it registers: {}", thrown.what()));
  } catch (...) {
    return refuse("fails while it registers, by an exception that is none of the standard library's");
  }
  if (!registry.clashes().empty())
    return refuse(fmt::format("{}; give it a name of its own", fmt::join(registry.clashes(), "; ")));
  return {};
}

std::vector<std::string> PluginFiles(const std::vector<std::string>& given, Diagnostics& diagnostics) {
  std::vector<std::string> files = given;
  std::error_code error;
  for (const std::string& file : given) {
    if (!fs::exists(file, error)) diagnostics.Error({file}, "there is no such plugin file", "--plugin FILE");
  }
  std::erase_if(files, [&error](const std::string& file) { return !fs::exists(file, error); });
  const char* path = std::getenv("DYNOPROOF_PLUGIN_PATH");
  std::istringstream stream(path != nullptr ? path : "");
  for (std::string place; std::getline(stream, place, ':');) {
    if (place.empty()) continue;
    if (!fs::is_directory(place, error)) {
      if (fs::exists(place, error)) {
        files.push_back(place);
      } else {
        diagnostics.Error({place}, "there is no such file or folder", "see $DYNOPROOF_PLUGIN_PATH");
      }
      continue;
    }
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(place, error)) {
      if (entry.path().extension() == ".so") found.push_back(entry.path().string());
    }
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

}  // namespace dynoproof
