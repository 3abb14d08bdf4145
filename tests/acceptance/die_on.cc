// Preloaded into the program by damage_test.cc: kills it in the middle of writing a file, at the call that
// $DYNOPROOF_DIE_ON names: "fsync" (the bytes are there, the file has its temporary name) or "rename".
#include <dlfcn.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

namespace {

void DieOn(const char* call) {
  const char* wanted = getenv("DYNOPROOF_DIE_ON");
  if (wanted != nullptr && strcmp(wanted, call) == 0) kill(getpid(), SIGKILL);
}

}  // namespace

extern "C" {

int fsync(int descriptor) {
  DieOn("fsync");
  return reinterpret_cast<int (*)(int)>(dlsym(RTLD_NEXT, "fsync"))(descriptor);
}

int rename(const char* from, const char* to) noexcept {
  DieOn("rename");
  return reinterpret_cast<int (*)(const char*, const char*)>(dlsym(RTLD_NEXT, "rename"))(from, to);
}
}
