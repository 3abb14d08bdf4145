// The program `dynoproof`: what its commands share. Each command stands in a file of its own.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/answer.h"
#include "app/command_line.h"
#include "base/diagnostics.h"
#include "model/registry.h"

namespace dynoproof::app {

/// Exit codes of the contract.
enum Exit { kGood = 0, kShort = 1, kUsage = 2, kBroken = 3, kUndecided = 4, kBudget = 5 };

/// What every command has.
struct Common {
  std::string json;                  // --json FILE; "-": stdout, tables then go to stderr
  std::vector<std::string> plugins;  // --plugin FILE
};

/// Text to the table stream: stdout, or stderr when the JSON goes to stdout.
void Print(const Common& common, const std::string& text);
/// Writes a file atomically and complains when that fails; kGood or kBroken.
int WriteText(const std::string& file, const std::string& text);
/// The same for a report page; says on stderr when its pictures are drawn without uPlot.
int WriteHtml(const std::string& file, const std::string& page);
/// Whether files can be made in the folder (made if missing), and in the folder of a file: found out before hours of
/// work. An empty file name asks for nothing and is fine; complaints go to stderr.
bool Writable(const std::string& folder);
bool CanWrite(const std::vector<std::string>& files);
/// Colours: only on a terminal, and not with NO_COLOR.
bool ColourOn(int descriptor);
/// True when the user sees this stream on a terminal.
bool IsTerminal(int descriptor);
/// True in a CI run ($CI is set), which may neither decide what is right nor take over what an earlier run found.
bool UnderCi();

/// Built-in plugins and those of --plugin and DYNOPROOF_PLUGIN_PATH; faults become diagnostics.
std::unique_ptr<Registry> MakeRegistry(const Common& common, Diagnostics& diagnostics);

/// A progress line on stderr that is redrawn in place; where stderr is no terminal, a line of its own every ten seconds.
/// `fraction` 0 ... 1.
void ShowProgress(const std::string& what, double fraction);
void ClearProgress();

/// Adds --json and --plugin.
void AddCommon(Command command, Common& common);

/// Each adds its subcommand.
void AddRun(Command program);
void AddModes(Command program);
void AddList(Command program);
void AddDescribe(Command program);
void AddValidate(Command program);
void AddNew(Command program);
void AddExport(Command program);
void AddFmuServer(Command program);
void AddCompare(Command program);
void AddBench(Command program);
void AddSweep(Command program);
void AddProbe(Command program);
void AddReduce(Command program);
void AddBisect(Command program);
void AddDiagnose(Command program);
void AddHistory(Command program);
void AddBless(Command program);

}  // namespace dynoproof::app
