#include "app/usage.h"

#include <fmt/format.h>

#include "base/text.h"

namespace dynoproof::app {
namespace {

std::vector<std::string> CommandsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

/// "--json" and all others of a command that its help names.
std::vector<std::string> OptionsOf(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::string Meant(const std::string& word, const std::vector<std::string>& known) {
  const std::optional<std::string> near = Closest(word, known);
  return near ? fmt::format("did you mean \"{}\"?", *near) : "";
}

}  // namespace

Diagnostics UsageFaults(const CLI::App& program, const CLI::ParseError& error) {
  Diagnostics diagnostics;
  // The command that was called: of `history add` the inner one.
  const CLI::App* command = &program;
  std::string called = "dynoproof";
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    called += " " + command->get_name();
  }
  const std::string more = called + " --help";
  const std::vector<std::string> commands = CommandsOf(*command), options = OptionsOf(*command);
  // Words that nothing took. The parser's own message would list them all, with the values behind unknown options.
  for (const std::string& word : program.remaining(true)) {
    if (word.size() > 1 && word.starts_with('-')) {
      const std::string name = word.substr(0, word.find('='));
      diagnostics.Error({name}, fmt::format("{} has no such option", called), Meant(name, options), more);
    } else if (!commands.empty()) {
      const std::string known = fmt::format("commands: {}", fmt::join(commands, ", "));
      const std::string near = Meant(word, commands);
      diagnostics.Error({word}, fmt::format("{} has no such command", called), near.empty() ? known : near, more);
      break;  // what follows belongs to the command that was meant
    }
  }
  if (!diagnostics.has_errors()) diagnostics.Error({called}, error.what(), "", more);
  return diagnostics;
}

}  // namespace dynoproof::app
