// A thin layer over the HDF5 C library: handles that close themselves, errors as values, and only the few kinds of
// object that traces and records need. Numbers are doubles here, whatever width or byte order the file has.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/status.h"

namespace dynoproof::trace::hdf5 {

/// Held around every use of the library, this layer's or another's (matio reads MAT 7.3 through HDF5): one thread at a
/// time, since not every build of HDF5 is thread-safe, and without its habit of printing errors. Not recursive.
class Session {
 public:
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  std::lock_guard<std::mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* print_data_ = nullptr;
};

/// Owns one reference to any HDF5 object.
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) H5Idec_ref(id_);
  }
  hid_t id() const { return id_; }
  bool valid() const { return id_ >= 0; }
  /// Gives the reference away.
  hid_t Release() { return std::exchange(id_, H5I_INVALID_HID); }

 private:
  hid_t id_ = H5I_INVALID_HID;
};

/// "`what`: " and the innermost message of HDF5's error stack, which names the cause (the outer ones only say which
/// call failed). Exit code 2.
Failure LastError(std::string_view what);

// --- reading. Failures carry the object's path in the message; the caller adds the file. ---

/// Opens a file for reading. Tells apart: not there, a folder, not HDF5 at all, HDF5 but damaged.
Result<Handle> OpenFile(const std::string& path);

/// From here on this process follows no link into another file. For processes that only read (hdf5_apart.h).
void StayInFile();
/// The file that the path leads into by a link, or "".
std::string LinkOut(hid_t location, const std::string& path);

enum class Kind { kMissing, kBroken, kGroup, kDataset, kOther };
/// What `path` is, seen from `location`; kBroken: the name is there, but nothing can be opened behind it.
Kind KindOf(hid_t location, const std::string& path);

Result<Handle> OpenGroup(hid_t location, const std::string& path);
/// `shown` is how messages name it, if not by `path`.
Result<Handle> OpenDataset(hid_t location, const std::string& path, const std::string& shown = {});

/// Names of the links in a group: as they were written if the file kept that order, else sorted. Failure: a name stands
/// there twice, or an object has more names than it counts itself: then some name leads to the numbers of another.
Result<std::vector<std::string>> LinkNames(hid_t group);
/// The links of a group and of all groups in it, with what the same failures mean there. `add`: called with the path,
/// without a slash in front, and the link.
Status VisitLinks(hid_t group, const std::function<void(const char* path, const H5L_info_t& link)>& add);
/// Names of the attributes of an object, in the manner of LinkNames().
Result<std::vector<std::string>> AttributeNames(hid_t object);

/// The dataspace of a dataset or an attribute.
struct Space {
  std::vector<std::size_t> shape;    // slowest first; empty for a single value, one extent of 0 where there is none
  std::size_t count = 1;             // of values
  bool may_grow_to_a_limit = false;  // some extent is below its maximum, which is not "unlimited"
};
/// Failure: the extents cannot be read, are above their own maximum, or give another number of values than the library
/// counts. Older files have no checksum over them.
Result<Space> SpaceOf(hid_t object, const std::string& name);

// --- writing: a file that lives in memory. Equal calls give equal bytes: no object times, fixed format version. ---

/// How datasets are stored.
struct Storage {
  int deflate_level = 0;  // 0: not compressed; 1 (fast) to 9 (small), after a byte shuffle
};

/// A new file in memory. (HDF5's own H5Fget_file_image() is of no use: in 1.10 it clears a flag in the superblock and
/// leaves the checksum over it as it was, so that nobody can open the result. Here the file is closed in earnest.)
class MemoryFile {
 public:
  /// `expected_bytes` sizes the steps in which the memory grows.
  static Result<std::unique_ptr<MemoryFile>> Create(std::size_t expected_bytes);
  hid_t id() const { return file_.id(); }
  /// Closes the file, once, and returns its bytes. Every other handle into it must be closed before.
  Result<std::vector<std::byte>> Finish();

 private:
  MemoryFile() = default;
  static void* Resize(void* memory, std::size_t bytes, H5FD_file_image_op_t op, void* self);

  std::vector<std::byte> bytes_;  // outlives file_, which writes into it when it closes
  Handle file_;
};

Result<Handle> CreateGroup(hid_t location, const std::string& name);
/// A float64 dataset with extent [values.size()], with a checksum over each chunk, so that reading detects damage.
Result<Handle> WriteDoubles(hid_t location, const std::string& name, std::span<const double> values,
                            const Storage& storage);
/// A scalar dataset with UTF-8 text.
Status WriteText(hid_t location, const std::string& name, std::string_view text);
Status WriteAttribute(hid_t object, const std::string& name, std::string_view text);
Status WriteAttribute(hid_t object, const std::string& name, double value);
Status WriteAttribute(hid_t object, const std::string& name, std::int64_t value);

}  // namespace dynoproof::trace::hdf5
