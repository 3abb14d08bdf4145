#include "base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <string>
#include <system_error>
#include <utility>

namespace dynoproof {
namespace {

namespace fs = std::filesystem;

Failure Broken(const fs::path& path, const std::string& what, int error) {
  std::string hint;
  if (error == ENOSPC || error == EDQUOT) hint = "; nothing was changed: free some space or choose another folder";
  if (error == EACCES || error == EROFS || error == EPERM) hint = "; choose a folder that may be written to";
  if (error == ENOTDIR) hint = "; a part of the path is a file";
  return {.message = fmt::format("{}: {}{}", what, std::generic_category().message(error), hint),
          .signal = path.string(),
          .time_s = {},
          .exit_code = 3};
}

/// A file descriptor that is closed with its scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }
  /// Closes now, since a network file system may report a full disk only here. Returns 0 or errno.
  int Close() { return ::close(std::exchange(fd_, -1)) == 0 ? 0 : errno; }

 private:
  int fd_;
};

/// Removes the file it guards unless told that it has moved on.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!path_.empty()) ::unlink(path_.c_str());
  }
  const fs::path& path() const { return path_; }
  void Release() { path_.clear(); }

 private:
  fs::path path_;
};

/// Writes everything; returns 0 or errno. A disk that fills up shows as a short write first, as ENOSPC next.
int WriteAll(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

Status SynchroniseFolder(const fs::path& folder, const fs::path& path) {
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() < 0) return {};  // a folder may be writable and not readable; the file itself is safe already
  // Some file systems do not know how to synchronise a folder and say so; there is nothing more to do on those.
  if (::fsync(fd.get()) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EBADF) {
    return Broken(path, "written, but the folder cannot be synchronised with the disk", errno);
  }
  return {};
}

Status WriteToDevice(const fs::path& path, std::span<const std::byte> bytes) {
  Descriptor fd(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
  if (fd.get() < 0) return Broken(path, "cannot open", errno);
  if (const int error = WriteAll(fd.get(), bytes)) return Broken(path, "cannot write", error);
  if (const int error = fd.Close()) return Broken(path, "cannot write", error);
  return {};
}

/// Removes temporary files of this target whose writer is gone: a killed one lets go of its lock. Those of the last minute stay,
/// for a writer makes its file before it locks it.
void SweepLeftBehind(const fs::path& folder, const std::string& before) {
  constexpr time_t kYoung_s = 60;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!name.starts_with(before) || !name.ends_with(".part")) continue;
    const Descriptor fd(::open(it->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    struct stat status {};
    if (fd.get() < 0 || ::fstat(fd.get(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    if (::time(nullptr) - status.st_mtime < kYoung_s || ::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) continue;
    ::unlink(it->path().c_str());
  }
}

enum class Existing { kReplaced, kStays };

Status WriteWhole(const fs::path& path, std::span<const std::byte> bytes, Existing existing) {
  std::error_code error;
  if (!path.has_filename()) return Broken(path, "cannot write", EISDIR);
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) return Broken(path, "cannot write", EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) return WriteToDevice(path, bytes);

  fs::path target = path;
  if (fs::is_symlink(fs::symlink_status(path, error))) {
    target = fs::weakly_canonical(path, error);
    if (error) return Broken(path, "cannot follow the link", error.value());
  }
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  fs::create_directories(folder, error);
  if (error && !fs::is_directory(folder)) {
    return Broken(path, fmt::format("cannot create the folder \"{}\"", folder.string()), error.value());
  }

  // The name is random, so that nobody can put another file there; O_EXCL refuses one that is there.
  const std::string before = fmt::format(".{}.", target.filename().string().substr(0, 200));
  SweepLeftBehind(folder, before);
  std::string name;
  int fd = -1;
  for (int attempt = 0; attempt < 100 && fd < 0; ++attempt) {
    std::uint64_t random = 0;
    if (::getentropy(&random, sizeof random) != 0) return Broken(path, "cannot draw a random name", errno);
    name = fmt::format("{}{:016x}.part", before, random);
    fd = ::open((folder / name).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno != EEXIST) {
      return Broken(path, fmt::format("cannot create a file in \"{}\"", folder.string()), errno);
    }
  }
  if (fd < 0) return Broken(path, "cannot find a free name for a temporary file", EEXIST);

  TemporaryFile temporary(folder / name);
  Descriptor file(fd);
  ::flock(fd, LOCK_EX | LOCK_NB);  // held while its writer lives; a file system without locks has none swept
  const std::string what = fmt::format("cannot write {} bytes", bytes.size());
  if (const int failed = WriteAll(file.get(), bytes)) return Broken(path, what, failed);
  if (::fsync(file.get()) != 0) return Broken(path, what, errno);
  ::futimens(file.get(), nullptr);  // young once more, for who sweeps between the lock and the rename
  // Not by closing it: a process that was forked meanwhile has the file open, too, and no reader may find it locked.
  ::flock(file.get(), LOCK_UN);
  if (const int failed = file.Close()) return Broken(path, what, failed);
  if (existing == Existing::kStays) {
    if (::link(temporary.path().c_str(), target.c_str()) != 0 && errno != EEXIST)
      return Broken(path, "cannot link to", errno);
    return SynchroniseFolder(folder, path);
  }
  if (::rename(temporary.path().c_str(), target.c_str()) != 0) return Broken(path, "cannot rename to", errno);
  temporary.Release();
  return SynchroniseFolder(folder, path);
}

}  // namespace

Status WriteFileAtomically(const fs::path& path, std::span<const std::byte> bytes) {
  return WriteWhole(path, bytes, Existing::kReplaced);
}

Status CreateFileAtomically(const fs::path& path, std::span<const std::byte> bytes) {
  return WriteWhole(path, bytes, Existing::kStays);
}

Status WriteFileAtomically(const fs::path& path, std::string_view text) {
  return WriteFileAtomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace dynoproof
