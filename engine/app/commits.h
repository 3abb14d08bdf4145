// The commits of the repository that the program is called in, and a work tree of its own for looking at them.
#pragma once

#include <string>
#include <vector>

#include "base/status.h"

namespace dynoproof::app {

struct Commit {
  std::string hash, when, subject;
};

class Commits {
 public:
  /// Reads from the repository around the present folder the commits that come after `good`, up to and with `bad`. Merges are
  /// followed along their first parent; the oldest commit comes first. Fails with exit code 2 where there is no repository, no such
  /// commit, or none between the two.
  static Result<Commits> Between(const std::string& good, const std::string& bad);

  const std::string& root() const { return root_; }  // of the repository
  const Commit& good() const { return good_; }
  const std::vector<Commit>& series() const { return series_; }

  /// The work tree at `folder`, as it is at that commit; made when it is not there.
  Status CheckOut(const std::string& commit, const std::string& folder) const;
  /// The values that differ between two commits in files of TOML, and after them the names of other files that differ. `apart`: a file
  /// that is left out. For instance
  /// "line.golden.toml: signal.T.relative_width = 1e-9 (was 0.02)", "line.golden.h5".
  std::vector<std::string> ChangesInFiles(const Commit& from, const Commit& to, const std::string& apart) const;
  /// The work tree goes, from the disk and from the repository's list.
  void Remove(const std::string& folder) const;

 private:
  std::string root_;
  Commit good_;
  std::vector<Commit> series_;
};

}  // namespace dynoproof::app
