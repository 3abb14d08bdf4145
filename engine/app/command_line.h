// The command line as the commands declare it. The library that reads it (CLI11) stands behind this header: a
// file that includes CLI11's own headers takes some ten times as long to compile. The parser's start and its errors are in main.cc and usage.cc.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace dynoproof::app {

/// One option or positional argument of a command, with the conditions on its value. A value that breaks one is a usage error.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option Required() const;
  /// Each time it is named it takes one word; without, all that follow.
  Option OneWord() const;
  Option SplitAtCommas() const;
  /// The help says which value it has when nobody gives one.
  Option ShowsDefault() const;
  /// The help does not name it.
  Option Hidden() const;
  Option Needs(const Option& other) const;
  Option Excludes(const Option& other) const;

  Option Within(int least, int most) const;
  Option Within(double least, double most) const;
  Option Positive() const;
  Option NotNegative() const;
  Option OneOf(const std::vector<std::string>& words) const;
  /// A file to be written: "-" is none. Only --json may go to stdout, where tables are.
  Option NamesFile() const;
  /// `fault`: what is wrong with a word, or "". `kind`: what the help calls such a word.
  Option Checked(std::function<std::string(const std::string&)> fault, const std::string& kind) const;

 private:
  CLI::Option* option_;
};

/// The program, or one of its commands; copies refer to the same one. Names of options begin with "--", names of positional
/// arguments do not. The parser writes into the given variable, which outlives the parser.
class Command {
 public:
  /// `exit`: set by the command that runs.
  Command(CLI::App* command, int* exit) : command_(command), exit_(exit) {}

  Command Subcommand(const std::string& name, const std::string& summary) const;
  Option Value(const std::string& name, std::string& value, const std::string& help = "") const;
  Option Value(const std::string& name, std::vector<std::string>& value, const std::string& help) const;
  Option Value(const std::string& name, int& value, const std::string& help = "") const;
  Option Value(const std::string& name, std::int64_t& value, const std::string& help = "") const;
  Option Value(const std::string& name, std::size_t& value, const std::string& help) const;
  Option Value(const std::string& name, double& value, const std::string& help) const;
  Option Flag(const std::string& name, bool& value, const std::string& help) const;
  /// Sets the description at the top of the help; without, the help shows the summary there.
  void Describe(const std::string& text) const;
  void Examples(const std::string& text) const;
  /// The help does not name it.
  void Hide() const;
  /// One of the subcommands has to be called.
  void NeedsSubcommand() const;
  /// Sets the function that runs the command. The function returns the exit code.
  void Runs(std::function<int()> work) const;

 private:
  CLI::App* command_;
  int* exit_;
};

}  // namespace dynoproof::app
