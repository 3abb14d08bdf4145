#include "app/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <utility>

namespace dynoproof::app {
namespace {

/// The parser takes the next word for a value whatever it is: of `--json --explain` it would make a file named --explain.
Option Taking(CLI::Option* option) {
  if (option->get_positional()) return Option(option);
  return Option(option).Checked(
      [](const std::string& word) {
        return word.starts_with("--") ? fmt::format("a value is missing: {} is the next option", word) : "";
      },
      "");
}

}  // namespace

Option Option::Required() const { return Option(option_->required()); }

Option Option::OneWord() const { return Option(option_->allow_extra_args(false)); }

Option Option::SplitAtCommas() const { return Option(option_->delimiter(',')); }

Option Option::ShowsDefault() const { return Option(option_->capture_default_str()); }

Option Option::Hidden() const { return Option(option_->group("")); }

Option Option::Needs(const Option& other) const { return Option(option_->needs(other.option_)); }

Option Option::Excludes(const Option& other) const { return Option(option_->excludes(other.option_)); }

Option Option::Within(int least, int most) const { return Option(option_->check(CLI::Range(least, most))); }

Option Option::Within(double least, double most) const { return Option(option_->check(CLI::Range(least, most))); }

Option Option::Positive() const { return Option(option_->check(CLI::PositiveNumber)); }

Option Option::NotNegative() const { return Option(option_->check(CLI::NonNegativeNumber)); }

Option Option::OneOf(const std::vector<std::string>& words) const {
  return Option(option_->check(CLI::IsMember(words)));
}

Option Option::NamesFile() const {
  return Checked(
      [](const std::string& file) { return file == "-" ? "stdout is for tables, and for --json -; name a file" : ""; },
      "");
}

Option Option::Checked(std::function<std::string(const std::string&)> fault, const std::string& kind) const {
  return Option(option_->check(CLI::Validator(std::move(fault), kind)));
}

Command Command::Subcommand(const std::string& name, const std::string& summary) const {
  return {command_->add_subcommand(name, summary), exit_};
}

Option Command::Value(const std::string& name, std::string& value, const std::string& help) const {
  return Taking(command_->add_option(name, value, help));
}

Option Command::Value(const std::string& name, std::vector<std::string>& value, const std::string& help) const {
  return Taking(command_->add_option(name, value, help));
}

Option Command::Value(const std::string& name, int& value, const std::string& help) const {
  return Option(command_->add_option(name, value, help));
}

Option Command::Value(const std::string& name, std::int64_t& value, const std::string& help) const {
  return Option(command_->add_option(name, value, help));
}

Option Command::Value(const std::string& name, std::size_t& value, const std::string& help) const {
  return Option(command_->add_option(name, value, help));
}

Option Command::Value(const std::string& name, double& value, const std::string& help) const {
  return Option(command_->add_option(name, value, help));
}

Option Command::Flag(const std::string& name, bool& value, const std::string& help) const {
  return Option(command_->add_flag(name, value, help));
}

void Command::Describe(const std::string& text) const { command_->description(text); }

void Command::Examples(const std::string& text) const { command_->footer("Examples:\n" + text); }

void Command::Hide() const { command_->group(""); }

void Command::NeedsSubcommand() const { command_->require_subcommand(1); }

void Command::Runs(std::function<int()> work) const {
  command_->callback([work = std::move(work), exit = exit_] { *exit = work(); });
}

}  // namespace dynoproof::app
