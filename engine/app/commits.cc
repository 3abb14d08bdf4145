#include "app/commits.h"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "base/process.h"
#include "scenario/changes.h"
#include "scenario/load.h"

namespace dynoproof::app {
namespace {

constexpr const char* kFormat = "--format=%H%x09%cI%x09%s";

Failure Usage(std::string message, std::string of) { return {std::move(message), std::move(of), {}, 2}; }

std::vector<Commit> Parse(const std::string& text) {
  std::vector<Commit> commits;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find('\t'), second = line.find('\t', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    commits.push_back({line.substr(0, first), line.substr(first + 1, second - first - 1), line.substr(second + 1)});
  }
  return commits;
}

}  // namespace

Result<Commits> Commits::Between(const std::string& good, const std::string& bad) {
  Commits commits;
  const ProgramEnd root = RunProgram({"git", "rev-parse", "--show-toplevel"}, ErrorLines::kDropped);
  if (root.exit != 0) return Usage("no git repository is here", std::filesystem::current_path().string());
  commits.root_ = root.out.substr(0, root.out.find('\n'));
  for (const std::string& name : {good, bad}) {
    const ProgramEnd log =
        RunProgram({"git", "log", "-1", kFormat, "--end-of-options", name + "^{commit}", "--"}, ErrorLines::kDropped);
    const std::vector<Commit> found = log.exit == 0 ? Parse(log.out) : std::vector<Commit>();
    if (found.size() != 1) return Usage("is no commit of this repository", name);
    if (name == good) commits.good_ = found.front();
  }
  const ProgramEnd log = RunProgram(
      {"git", "log", "--reverse", "--first-parent", kFormat, "--end-of-options", commits.good_.hash + ".." + bad, "--"},
      ErrorLines::kDropped);
  commits.series_ = Parse(log.out);
  if (commits.series_.empty()) return Usage(fmt::format("no commit comes after {} up to {}", good, bad), bad);
  return commits;
}

Status Commits::CheckOut(const std::string& commit, const std::string& folder) const {
  std::error_code error;
  if (!std::filesystem::exists(std::filesystem::path(folder) / ".git", error)) {
    RunProgram({"git", "-C", root_, "worktree", "prune"});
    const ProgramEnd added =
        RunProgram({"git", "-C", root_, "worktree", "add", "-q", "--detach", "--force", folder, commit});
    return added.exit == 0 ? Status() : Failure{"git makes no work tree: " + added.out, folder};
  }
  const ProgramEnd moved = RunProgram({"git", "-C", folder, "checkout", "-q", "--detach", "--force", commit});
  return moved.exit == 0 ? Status() : Failure{"git does not check it out: " + moved.out, commit};
}

std::vector<std::string> Commits::ChangesInFiles(const Commit& from, const Commit& to, const std::string& apart) const {
  const ProgramEnd names =
      RunProgram({"git", "-C", root_, "diff", "--name-only", from.hash, to.hash}, ErrorLines::kDropped);
  const auto tree_of = [&](const Commit& commit, const std::string& file) {
    const ProgramEnd shown = RunProgram({"git", "-C", root_, "show", commit.hash + ":" + file}, ErrorLines::kDropped);
    return FromToml(shown.exit == 0 ? shown.out : "");
  };
  std::vector<std::string> changes, others;
  std::istringstream lines(names.out);
  for (std::string file; std::getline(lines, file);) {
    if (file == apart) continue;
    const bool toml = file.ends_with(".toml");
    const auto was = toml ? tree_of(from, file) : std::nullopt, is = toml ? tree_of(to, file) : std::nullopt;
    if (!was || !is) {
      others.push_back(file);
      continue;
    }
    for (const std::string& change : ChangesBetween(*was, *is)) changes.push_back(fmt::format("{}: {}", file, change));
  }
  changes.insert(changes.end(), others.begin(), others.end());
  return changes;
}

void Commits::Remove(const std::string& folder) const {
  RunProgram({"git", "-C", root_, "worktree", "remove", "--force", folder});
}

}  // namespace dynoproof::app
