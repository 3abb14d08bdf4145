// dynoproof new
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/templates.h"

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

int New(const Common& common, const std::string& what, const std::string& name) {
  const bool good = !name.empty() && std::islower(static_cast<unsigned char>(name[0])) != 0 &&
                    std::all_of(name.begin(), name.end(), [](unsigned char c) {
                      return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '_';
                    });
  if (!good) {
    Complain(fmt::format("\"{}\" is no name: lower-case letters, digits and underscores, a letter first\n", name));
    return kUsage;
  }
  std::vector<std::pair<std::string, std::string>> files;
  const auto fill = [&name](const char* text) {
    return Replace(Replace(text, "@NAME@", name), "@CLASS@", ClassName(name));
  };
  if (what == "scenario") {
    files.emplace_back(name + ".toml", fill(kScenarioTemplate));
  } else {
    files.emplace_back(name + "/CMakeLists.txt", fill(kPluginCmake));
    files.emplace_back(name + "/" + name + ".cc", fill(what == "law" ? kLawTemplate : kEffectTemplate));
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
  Print(common,
        what == "scenario"
            ? fmt::format("next: dynoproof validate {0}.toml; dynoproof modes {0}.toml; dynoproof run {0}.toml\n", name)
            : fmt::format(
                  "next: build it as {0}/CMakeLists.txt says, then: dynoproof describe {0} --plugin {0}/build/{0}.so\n",
                  name));
  nlohmann::json document = {{"files", nlohmann::json::array()}};
  for (const auto& [file, text] : files) document["files"].push_back(file);
  return WriteJson(common, document);
}

}  // namespace

void AddNew(CLI::App& program, int& exit) {
  struct Arguments {
    Common common;
    std::string what, name;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand("new", "a template that already passes validate, or builds and loads");
  command->add_option("what", arguments->what, "scenario, law or effect")
      ->required()
      ->check(CLI::IsMember({"scenario", "law", "effect"}));
  command->add_option("name", arguments->name, "its name")->required();
  AddCommon(*command, arguments->common);
  AddExamples(*command, "  dynoproof new scenario my_line\n  dynoproof new law soft_stop");
  command->callback([arguments, &exit] { exit = New(arguments->common, arguments->what, arguments->name); });
}

}  // namespace dynoproof::app
