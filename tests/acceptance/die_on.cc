// Preloaded into the program by tests: ends it, or fails it, at one of the calls that change files.
//
//   DYNOPROOF_DIE_ON=rename          SIGKILL at the first call of that name
//   DYNOPROOF_POINT=7                at the seventh of all calls that change files: SIGKILL, or
//   DYNOPROOF_POINT_ERROR=28         that call fails with this errno
//   DYNOPROOF_ALLOCATION=7           the seventh allocation by malloc() fails
//   DYNOPROOF_POINT_COUNT=FILE       how many such calls and allocations a process has made, appended as it ends
//
// Other programs that inherit the library, as git, are left alone; so are the standard streams.
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

namespace {

int calls = 0;
long allocations = 0;  // of the process and what it was forked from: all threads count, and a lost count does no harm
pid_t counts = 0;      // the process whose calls these are

bool Ours() {
  static const bool ours = [] {
    char name[32] = "";
    const int file = static_cast<int>(syscall(SYS_openat, AT_FDCWD, "/proc/self/comm", O_RDONLY));
    const long count = syscall(SYS_read, file, name, sizeof name - 1);
    syscall(SYS_close, file);
    return count > 0 && strncmp(name, "dynoproof", 9) == 0;
  }();
  return ours;
}

/// Whether this call is to fail, which is then what errno says.
bool Fails(const char* call) {
  if (!Ours()) return false;
  const char* named = getenv("DYNOPROOF_DIE_ON");
  if (named != nullptr && strcmp(named, call) == 0) kill(getpid(), SIGKILL);
  if (counts != getpid()) counts = getpid(), calls = 0;
  const char* point = getenv("DYNOPROOF_POINT");
  if (++calls != (point != nullptr ? atoi(point) : 0)) return false;
  const char* error = getenv("DYNOPROOF_POINT_ERROR");
  if (error == nullptr) kill(getpid(), SIGKILL);
  errno = atoi(error);
  return true;
}

__attribute__((destructor)) void Tell() {
  const char* file = getenv("DYNOPROOF_POINT_COUNT");
  if (file == nullptr || !Ours() || counts != getpid()) return;
  char text[64];
  const int length = snprintf(text, sizeof text, "%d %ld\n", calls, allocations);
  const int to = static_cast<int>(syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_APPEND, 0600));
  syscall(SYS_write, to, text, length);
  syscall(SYS_close, to);
}

template <class Function>
Function* Next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

constexpr int kChanges = O_CREAT | O_TRUNC | O_WRONLY | O_RDWR | O_APPEND;

}  // namespace

extern "C" {

void* __libc_malloc(size_t size);  // what malloc() is in glibc; dlsym() would allocate

void* malloc(size_t size) {
  static const long fails = [] {
    const char* text = getenv("DYNOPROOF_ALLOCATION");
    return text != nullptr ? atol(text) : 0;
  }();
  if (++allocations == fails && Ours()) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_malloc(size);
}

#define DYNOPROOF_OPEN(name)                                               \
  int name(const char* path, int flags, ...) {                             \
    va_list more;                                                          \
    va_start(more, flags);                                                 \
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(more, mode_t) : 0; \
    va_end(more);                                                          \
    if ((flags & kChanges) != 0 && Fails("open")) return -1;               \
    return Next<int(const char*, int, ...)>(#name)(path, flags, mode);     \
  }
DYNOPROOF_OPEN(open)
DYNOPROOF_OPEN(open64)

ssize_t write(int file, const void* bytes, size_t count) {
  if (file > 2 && Fails("write")) return -1;
  return Next<ssize_t(int, const void*, size_t)>("write")(file, bytes, count);
}
ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
  if (Fails("pwrite")) return -1;
  return Next<ssize_t(int, const void*, size_t, off_t)>("pwrite")(file, bytes, count, at);
}
ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t at) {
  if (Fails("pwrite")) return -1;
  return Next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64")(file, bytes, count, at);
}
int ftruncate(int file, off_t length) noexcept {
  return Fails("ftruncate") ? -1 : Next<int(int, off_t)>("ftruncate")(file, length);
}
int ftruncate64(int file, off64_t length) noexcept {
  return Fails("ftruncate") ? -1 : Next<int(int, off64_t)>("ftruncate64")(file, length);
}
int fsync(int file) { return Fails("fsync") ? -1 : Next<int(int)>("fsync")(file); }
int fdatasync(int file) { return Fails("fsync") ? -1 : Next<int(int)>("fdatasync")(file); }
int rename(const char* from, const char* to) noexcept {
  return Fails("rename") ? -1 : Next<int(const char*, const char*)>("rename")(from, to);
}
int link(const char* from, const char* to) noexcept {
  return Fails("link") ? -1 : Next<int(const char*, const char*)>("link")(from, to);
}
int unlink(const char* path) noexcept { return Fails("unlink") ? -1 : Next<int(const char*)>("unlink")(path); }
int mkdir(const char* path, mode_t mode) noexcept {
  return Fails("mkdir") ? -1 : Next<int(const char*, mode_t)>("mkdir")(path, mode);
}
}
