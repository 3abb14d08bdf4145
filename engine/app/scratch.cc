#include "app/scratch.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <cerrno>
#include <system_error>

#include "app/answer.h"

namespace dynoproof::app {

namespace fs = std::filesystem;

Scratch::Scratch(const std::string& word) {
  std::string name = (fs::temp_directory_path() / fmt::format("dynoproof-{}-XXXXXX", word)).string();
  if (::mkdtemp(name.data()) != nullptr) {
    folder_ = name;
    return;
  }
  const int reason = errno;
  Complain(fmt::format("cannot make a folder in {}: {}\n", fs::temp_directory_path().string(),
                       std::generic_category().message(reason)));
}

Scratch::~Scratch() {
  std::error_code ignored;
  if (ok()) fs::remove_all(folder_, ignored);
}

}  // namespace dynoproof::app
