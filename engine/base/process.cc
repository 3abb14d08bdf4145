#include "base/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

extern char** environ;

namespace dynoproof {

std::string HowItEnded(int state) {
  if (!WIFSIGNALED(state)) return fmt::format("ended the program with exit code {}", WEXITSTATUS(state));
  return fmt::format("crashed: signal {} ({})", WTERMSIG(state), strsignal(WTERMSIG(state)));
}

ProgramEnd RunProgram(std::vector<std::string> words, ErrorLines errors) {
  ProgramEnd end;
  int ends[2];
  if (pipe(ends) != 0) return end;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  if (errors == ErrorLines::kKept) {
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  } else {
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  }
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  posix_spawn_file_actions_addclose(&actions, ends[1]);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t process = -1;
  const int failed = posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failed != 0) {
    close(ends[0]);
    end.out = fmt::format("{}: {}", words[0], std::strerror(failed));
    return end;
  }
  char buffer[4096];
  for (ssize_t count; (count = read(ends[0], buffer, sizeof buffer)) > 0 || (count < 0 && errno == EINTR);) {
    if (count > 0) end.out.append(buffer, static_cast<std::size_t>(count));
  }
  close(ends[0]);
  int state = 0;
  while (waitpid(process, &state, 0) < 0 && errno == EINTR) {
  }
  end.exit = WIFEXITED(state) ? WEXITSTATUS(state) : -1;
  return end;
}

}  // namespace dynoproof
