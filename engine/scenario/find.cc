// Where scenarios live and how a user's word for one is understood.
#include "scenario/find.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "base/text.h"
#include "scenario/load.h"

namespace dynoproof {
namespace {

namespace fs = std::filesystem;

/// Scenario files below a folder, sorted. Files that start with "_" are shared parts for `include`, those that end in
/// ".golden.toml" say how a scenario is compared.
std::vector<std::string> FilesBelow(const fs::path& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    if (path.extension() != ".toml" || path.stem().string().starts_with("_")) continue;
    if (path.stem().extension() == ".golden") continue;  // tolerances, beside the scenario that they belong to
    files.push_back(path.string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The path of a file below the scenario folder; nothing when it lies elsewhere.
std::optional<fs::path> BelowScenarioFolder(const std::string& file) {
  std::error_code error;
  const fs::path path = fs::weakly_canonical(file, error);
  const fs::path folder = fs::weakly_canonical(ScenarioFolder(), error);
  fs::path relative = path.lexically_relative(folder);
  if (relative.empty() || *relative.begin() == "..") return std::nullopt;
  return relative;
}

/// The folder `name` of what belongs to this program: share/dynoproof beside the program or beside one of the two
/// folders around it. An installation has it beside bin/; a build folder has one with links into the source tree
/// (CMakeLists.txt). Where there is none, it is named as it should be.
fs::path OwnFolder(const std::string& name) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  fs::path around = program.parent_path();
  for (int i = 0; i < 3; ++i, around = around.parent_path()) {
    if (const fs::path found = fs::canonical(around / "share/dynoproof" / name, error); !error) return found;
  }
  return (program.parent_path().parent_path() / "share/dynoproof" / name).lexically_normal();
}

}  // namespace

std::string ScenarioFolder() {
  if (const char* folder = std::getenv("DYNOPROOF_SCENARIOS"); folder != nullptr && *folder != '\0') return folder;
  const fs::path own = OwnFolder("scenarios");
  // Within the tree that holds them, messages and hints name them as a person there would.
  std::error_code error;
  const fs::path near = fs::relative(own, error);
  const fs::path from_tree = fs::current_path(error).lexically_relative(own.parent_path());
  return !near.empty() && !from_tree.empty() && *from_tree.begin() != ".." ? near.string() : own.string();
}

std::string ScenarioId(const std::string& file) {
  return BelowScenarioFolder(file).value_or(fs::path(file).filename()).replace_extension().generic_string();
}

bool IsOwnScenario(const std::string& file) { return !file.empty() && !BelowScenarioFolder(file); }

std::string CallName(const std::string& file) {
  std::error_code error;
  const std::string id = ScenarioId(file);
  return IsOwnScenario(file) || fs::is_regular_file(id, error) ? file : id;  // a file of that name would come first
}

std::vector<std::string> FindScenarios(const std::string& name, Diagnostics& diagnostics) {
  std::error_code error;
  if (fs::is_regular_file(name, error)) return {name};
  const fs::path folder = ScenarioFolder();
  if (const fs::path file = folder / (name + ".toml"); fs::is_regular_file(file, error)) return {file.string()};
  // "./x" and "/x" can only be folders of the file system; other names are a family first.
  const bool literal = name.starts_with('.') || name.starts_with('/');
  for (const fs::path& place : {literal ? fs::path(name) : folder / name, fs::path(name)}) {
    if (!name.empty() && fs::is_directory(place, error)) {
      std::vector<std::string> files = FilesBelow(place);
      if (files.empty())
        diagnostics.Error({place.string()}, "there is no scenario in this folder", "files end in .toml");
      return files;
    }
  }
  const std::vector<std::string> all = FilesBelow(folder);
  if (name.empty()) {
    if (all.empty()) diagnostics.Error({folder.string()}, "there is no scenario", "set DYNOPROOF_SCENARIOS");
    return all;
  }
  std::vector<std::string> ids;
  for (const std::string& file : all) ids.push_back(ScenarioId(file));
  const std::optional<std::string> near = Closest(name, ids);
  const std::string file = name + ".toml";
  diagnostics.Error({name}, "there is no such scenario, file or folder",
                    fs::is_regular_file(file, error) ? fmt::format("did you mean \"{}\"?", file)
                    : near                           ? fmt::format("did you mean \"{}\"?", *near)
                                                     : "see: dynoproof list");
  return {};
}

}  // namespace dynoproof
