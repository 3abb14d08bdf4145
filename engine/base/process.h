// Another program, run to its end.
#pragma once

#include <string>
#include <vector>

namespace dynoproof {

struct ProgramEnd {
  int exit = -1;    // -1: it could not be started, or a signal ended it
  std::string out;  // what it wrote; the reason when it could not be started
};

/// What becomes of the lines that a program writes to stderr: they follow the others, or nobody reads them.
enum class ErrorLines { kKept, kDropped };

/// What became of a process, by the state that waitpid() gives: "crashed: signal 11 (Segmentation fault)", "ended the program with
/// exit code 3".
std::string HowItEnded(int state);

/// Runs words[0], found by PATH, with the other words as its arguments; its input is empty.
ProgramEnd RunProgram(std::vector<std::string> words, ErrorLines errors = ErrorLines::kKept);

}  // namespace dynoproof
