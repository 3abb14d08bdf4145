// A folder for what nobody else is to see, and that goes with its owner.
#pragma once

#include <filesystem>
#include <string>

namespace dynoproof::app {

class Scratch {
 public:
  /// Below the folder for temporary files; `word` is part of its name. Complains where none can be made.
  explicit Scratch(const std::string& word);
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  bool ok() const { return !folder_.empty(); }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace dynoproof::app
