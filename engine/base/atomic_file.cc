#include "base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
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

}  // namespace

Status WriteFileAtomically(const fs::path& path, std::span<const std::byte> bytes) {
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

  // The process id keeps programs apart, the counter threads; O_EXCL settles what is left, such as two containers that
  // share a folder and count their processes alike.
  static std::atomic<unsigned> counter{0};
  std::string name;
  int fd = -1;
  for (int attempt = 0; attempt < 1000 && fd < 0; ++attempt) {
    name = fmt::format(".{}.{}-{}.part", target.filename().string().substr(0, 200), ::getpid(), counter.fetch_add(1));
    fd = ::open((folder / name).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno != EEXIST) {
      return Broken(path, fmt::format("cannot create a file in \"{}\"", folder.string()), errno);
    }
  }
  if (fd < 0) return Broken(path, "cannot find a free name for a temporary file", EEXIST);

  TemporaryFile temporary(folder / name);
  Descriptor file(fd);
  const std::string what = fmt::format("cannot write {} bytes", bytes.size());
  if (const int failed = WriteAll(file.get(), bytes)) return Broken(path, what, failed);
  if (::fsync(file.get()) != 0) return Broken(path, what, errno);
  if (const int failed = file.Close()) return Broken(path, what, failed);
  if (::rename(temporary.path().c_str(), target.c_str()) != 0) return Broken(path, "cannot rename to", errno);
  temporary.Release();
  return SynchroniseFolder(folder, path);
}

Status WriteFileAtomically(const fs::path& path, std::string_view text) {
  return WriteFileAtomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace dynoproof
