// Another program, run to its end.
#pragma once

#include <string>
#include <vector>

namespace dynoproof::campaign {

struct Answer {
  int exit = -1;    // -1: it could not be started, or a signal ended it
  std::string out;  // with what went to stderr
};

/// Runs words[0], found by PATH, with the other words as its arguments; its input is empty.
Answer Ask(std::vector<std::string> words);

}  // namespace dynoproof::campaign
