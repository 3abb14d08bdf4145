// dynoproof new
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/map_proposal.h"
#include "app/templates.h"
#include "experiment/build_info.h"
#include "experiment/measured_record.h"
#include "experiment/prepare.h"
#include "scenario/find.h"

namespace dynoproof::app {
namespace {

namespace fs = std::filesystem;

std::string Replace(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
  }
  return text;
}

/// "soft_stop" -> "SoftStop".
std::string ClassName(const std::string& name) {
  std::string text;
  bool upper = true;
  for (const char c : name) {
    if (c == '_') {
      upper = true;
      continue;
    }
    text += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    upper = false;
  }
  return text;
}

/// The program as it was called, so that what it prints can be called as well.
std::string Called() {
  std::ifstream words("/proc/self/cmdline");
  std::string word;
  std::getline(words, word, '\0');
  return word.empty() ? "dynoproof" : word;
}

/// Where cmake finds the package that plugins are built against: the build folder that this program stands in, or the
/// prefix that it is installed under. Empty when it stands alone.
std::string PackagePrefix() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path(), prefix = folder.parent_path();
  if (fs::exists(folder / "dynoproofConfig.cmake", error)) return folder.string();
  for (const char* library : {"lib", "lib64"}) {
    const fs::path place = prefix / library;
    if (fs::exists(place / "cmake/dynoproof/dynoproofConfig.cmake", error)) return prefix.string();
    for (const fs::directory_entry& one : fs::directory_iterator(place, error)) {  // lib/x86_64-linux-gnu
      if (fs::exists(one.path() / "cmake/dynoproof/dynoproofConfig.cmake", error)) return prefix.string();
    }
  }
  return "";
}

/// The commit that this program was built from, without the mark of a changed tree.
std::string BuiltFrom() {
  std::string commit = build_info::Commit();
  if (commit.ends_with('+')) commit.pop_back();
  return commit;
}

using Files = std::vector<std::pair<std::string, std::string>>;

/// A library of one law, effect or kind of check, and a scenario that uses it.
Files PluginFolder(const std::string& what, const std::string& name) {
  std::string scenario = kScenarioTemplate;
  if (what == "law") {
    const std::string shaft = "stiffness_Nm_per_rad = 2.5e5\n";
    scenario = Replace(scenario, shaft, shaft + kLawUse);
  } else {
    scenario += what == "check" ? kCheckUse : kEffectUse;
  }
  const char* const source = what == "law" ? kLawTemplate : what == "check" ? kCheckTemplate : kEffectTemplate;
  Files files = {{name + "/CMakeLists.txt", Replace(kPluginCmake, "@LIBRARY@", what == "check" ? "score" : "model")},
                 {name + "/" + name + ".cc", source},
                 {name + "/" + name + ".toml", scenario}};
  if (what == "check") {
    files.insert(files.begin(), {name + "/README.md", kCheckReadme});
    files.emplace_back(name + "/" + name + ".h", kCheckHeader);
  }
  return files;
}

/// A folder to be put under git: a scenario with a golden trace, pipelines, a README.
Files ProjectFolder(const std::string& name) {
  const std::map<std::string, std::string> places = {{"README.md", "README.md"},
                                                     {"gitignore", ".gitignore"},
                                                     {"github-actions.yml", ".github/workflows/dynoproof.yml"},
                                                     {"gitlab-ci.yml", ".gitlab-ci.yml"}};
  Files files;
  for (const auto& [file, text] : ProjectFiles()) files.emplace_back(name + "/" + places.at(file), text);
  files.emplace_back(name + "/scenarios/line.toml",
                     Replace(std::string(kScenarioTemplate) + kGoldenUse, "@NAME@", "line"));
  return files;
}

/// The commands to go on with, as they can be typed here.
std::string Next(const std::string& what, const std::string& name, const std::string& prefix) {
  const std::string called = Called();
  if (what == "scenario")
    return fmt::format("next:\n  {0} validate {1}.toml\n  {0} modes {1}.toml\n  {0} run {1}.toml\n", called, name);
  if (what == "project") {
    return fmt::format(
        "next, in {1}/ (README.md there says more):\n  git init && git add . && git commit -m \"A first drive line\"\n"
        "  {0} bless scenarios/line.toml --reason TEXT\n  {0} run scenarios\n",
        fs::path(called).is_relative() && called.find('/') != std::string::npos ? "../" + called : called, name);
  }
  const std::string missing = prefix.empty() ? "this program stands alone: install dynoproof for the package that "
                                               "plugins are built against, and put its prefix for PREFIX\n"
                                             : "";
  return fmt::format(
      "{3}next:\n  cmake -S {1} -B {1}/build -DCMAKE_PREFIX_PATH=\"{2}\" && cmake --build {1}/build\n"
      "  {0} describe {1} --plugin {1}/build/{1}.so\n  {0} run {1}/{1}.toml --plugin {1}/build/{1}.so\n",
      called, name, prefix.empty() ? "PREFIX" : prefix, missing);
}

int New(const Common& common, const std::string& what, const std::string& name) {
  const bool good = !name.empty() && std::islower(static_cast<unsigned char>(name[0])) != 0 &&
                    std::all_of(name.begin(), name.end(), [](unsigned char c) {
                      return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '_';
                    });
  if (!good) {
    Complain(fmt::format("\"{}\" is no name: lower-case letters, digits and underscores, a letter first\n", name));
    return kUsage;
  }
  const std::string prefix = PackagePrefix();
  Files files = what == "scenario"  ? Files{{name + ".toml", kScenarioTemplate}}
                : what == "project" ? ProjectFolder(name)
                                    : PluginFolder(what, name);
  for (auto& [file, text] : files) {
    for (const auto& [mark, value] : {std::pair("@NAME@", name), std::pair("@CLASS@", ClassName(name)),
                                      std::pair("@COMMIT@", BuiltFrom()), std::pair("@PREFIX@", prefix)})
      text = Replace(text, mark, value);
  }
  for (const auto& [file, text] : files) {
    std::error_code error;
    if (fs::exists(file, error)) {
      Complain(fmt::format("\"{}\" is there already; nothing was written\n", file));
      return kUsage;
    }
  }
  for (const auto& [file, text] : files) {
    if (const int failed = WriteText(file, text)) return failed;
    Print(common, fmt::format("{}\n", file));
  }
  Print(common, Next(what, name, prefix));
  nlohmann::json document = {{"files", nlohmann::json::array()}};
  for (const auto& [file, text] : files) document["files"].push_back(file);
  KeepJson(std::move(document));
  return kGood;
}

/// A map that brings a record onto a scenario, as far as its columns tell.
int NewMap(const Common& common, const std::string& record_file, const std::string& scenario) {
  Diagnostics diagnostics;
  if (scenario.empty())
    diagnostics.Error({"--scenario"}, "a map says which column is which signal of a scenario", "add --scenario ID");
  const std::unique_ptr<Registry> registry = MakeRegistry(common, diagnostics);
  const std::vector<std::string> files =
      scenario.empty() ? std::vector<std::string>() : FindScenarios(scenario, diagnostics);
  if (files.size() > 1) diagnostics.Error({scenario}, "names several scenarios", "name one");
  std::unique_ptr<Prepared> prepared;
  if (files.size() == 1) prepared = Prepare(files[0], {}, *registry, diagnostics);
  const Result<trace::Record> record = ReadRecord(record_file);
  if (!record.ok()) diagnostics.Error({record_file}, record.failure().message);
  const std::string file = fs::path(record_file).stem().string() + ".map.toml";
  std::error_code error;
  if (fs::exists(file, error)) diagnostics.Error({file}, "is there already", "remove it, or go on with it");
  if (Report(diagnostics) != kGood || prepared == nullptr) return kUsage;
  if (const int failed =
          WriteText(file, ProposeMap(*record, InputNames(*prepared->rig), OutputNames(*prepared->rig), prepared->plan)))
    return failed;
  Print(
      common,
      fmt::format("{1}\nnext:\n  {0} check-data {2} --map {1} --scenario {3}\n  {0} identify {3} --data {2} --map {1} "
                  "--free KEY,...\n",
                  Called(), file, record_file, scenario));
  KeepJson({{"files", {file}}});
  return kGood;
}

}  // namespace

void AddNew(Command program) {
  struct Arguments {
    Common common;
    std::string what, name, scenario;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = program.Subcommand("new", "a template that already runs and passes, or builds and loads");
  command.Value("what", arguments->what, "scenario, law, effect, check, project or map")
      .Required()
      .OneOf({"scenario", "law", "effect", "check", "project", "map"});
  command.Value("name", arguments->name, "its name; of a map the record").Required();
  command.Value("--scenario", arguments->scenario, "of a map: whose signals the record holds");
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof new scenario my_line\n  dynoproof new law soft_stop\n  dynoproof new check calm\n"
      "  dynoproof new project pumps\n  dynoproof new map bench_17.csv --scenario my_line.toml");
  command.Runs([arguments] {
    return arguments->what == "map" ? NewMap(arguments->common, arguments->name, arguments->scenario)
                                    : New(arguments->common, arguments->what, arguments->name);
  });
}

}  // namespace dynoproof::app
