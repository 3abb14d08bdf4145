#include "trace/hdf5.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <new>

#include "base/bad_input.h"

namespace dynoproof::trace::hdf5 {
namespace {

std::mutex& LibraryMutex() {
  static std::mutex mutex;
  return mutex;
}

/// A text's type: fixed length, so that the bytes do not wander into a heap of the file.
Handle TextType(std::string_view text) {
  Handle type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.id(), std::max<std::size_t>(1, text.size()));
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

Status WriteScalarAttribute(hid_t object, const std::string& name, hid_t file_type, hid_t memory_type,
                            const void* value) {
  const Handle space(H5Screate(H5S_SCALAR));
  const Handle attribute(H5Acreate2(object, name.c_str(), file_type, space.id(), H5P_DEFAULT, H5P_DEFAULT));
  if (!attribute.valid() || H5Awrite(attribute.id(), memory_type, value) < 0) {
    return LastError(fmt::format("attribute \"{}\" cannot be written", name));
  }
  return {};
}

}  // namespace

Session::Session() : lock_(LibraryMutex()) {
  // Damaged files can leave objects open inside the library, about which its own clean-up at exit complains on stderr.
  // Everything of ours closes itself before.
  static const herr_t kept_quiet = H5dont_atexit();
  (void)kept_quiet;
  H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Session::~Session() { H5Eset_auto2(H5E_DEFAULT, print_, print_data_); }

Failure LastError(std::string_view what) {
  std::string innermost;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
        *static_cast<std::string*>(out) = error->desc == nullptr ? "" : error->desc;
        return 1;  // the first is the innermost: enough
      },
      &innermost);
  return BadInput(innermost.empty() ? std::string(what) : fmt::format("{}: {}", what, innermost));
}

Result<Handle> OpenFile(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    return BadInput(status.type() == std::filesystem::file_type::not_found ? "there is no such file"
                                                                           : "cannot be read: " + error.message());
  }
  if (!std::filesystem::is_regular_file(status)) return BadInput("is not a file");
  if (H5Fis_hdf5(path.c_str()) == 0) return BadInput("is not an HDF5 file");
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  if (!file.valid()) return LastError("cannot be opened as an HDF5 file");
  return file;
}

void StayInFile() {
  // In place of the library's own kind of such links: one that is not followed, but still says where it leads.
  H5L_class_t stay = {};
  stay.version = H5L_LINK_CLASS_T_VERS;
  stay.id = H5L_TYPE_EXTERNAL;
  stay.comment = "external";
  stay.trav_func = [](const char*, hid_t, const void*, std::size_t, hid_t, hid_t) -> hid_t { return H5I_INVALID_HID; };
  stay.query_func = [](const char*, const void* data, std::size_t size, void* out, std::size_t room) -> ssize_t {
    if (out != nullptr) std::memcpy(out, data, std::min(size, room));
    return static_cast<ssize_t>(size);
  };
  H5Lregister(&stay);
}

std::string LinkOut(hid_t location, const std::string& path) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    H5L_info_t info = {};
    if (part.empty() || H5Lget_info(location, part.c_str(), &info, H5P_DEFAULT) < 0) return "";
    if (info.type == H5L_TYPE_EXTERNAL) {
      std::vector<char> value(info.u.val_size);
      unsigned flags = 0;
      const char* file = nullptr;
      const char* object = nullptr;
      if (value.empty() || H5Lget_val(location, part.c_str(), value.data(), value.size(), H5P_DEFAULT) < 0 ||
          H5Lunpack_elink_val(value.data(), value.size(), &flags, &file, &object) < 0)
        return "?";
      return file;
    }
    if (end == std::string::npos) return "";
  }
}

Kind KindOf(hid_t location, const std::string& path) {
  const Handle object(H5Oopen(location, path.c_str(), H5P_DEFAULT));
  if (!object.valid()) {
    return H5Lexists(location, path.c_str(), H5P_DEFAULT) > 0 ? Kind::kBroken : Kind::kMissing;
  }
  const H5I_type_t type = H5Iget_type(object.id());
  return type == H5I_GROUP ? Kind::kGroup : type == H5I_DATASET ? Kind::kDataset : Kind::kOther;
}

Result<Handle> OpenGroup(hid_t location, const std::string& path) {
  Handle group(H5Gopen2(location, path.c_str(), H5P_DEFAULT));
  if (!group.valid()) return LastError(fmt::format("there is no group \"{}\"", path));
  return group;
}

Result<Handle> OpenDataset(hid_t location, const std::string& path, const std::string& shown) {
  Handle dataset(H5Dopen2(location, path.c_str(), H5P_DEFAULT));
  if (!dataset.valid()) {
    Failure failure = LastError(fmt::format("there is no dataset \"{}\"", shown.empty() ? path : shown));
    if (const std::string other = LinkOut(location, path); !other.empty())
      return BadInput(fmt::format("\"{}\" is a link into another file, \"{}\", which is not followed",
                                  shown.empty() ? path : shown, other));
    return failure;
  }
  return dataset;
}

namespace {

/// Calls iterate(index) once, in the order of creation when the object tracks it, else by name.
template <class Iterate>
Result<std::vector<std::string>> Names(bool tracked, Iterate iterate) {
  std::vector<std::string> names;
  if (iterate(tracked ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME, &names) < 0) return LastError("the names cannot be listed");
  std::vector<std::string> sorted = names;
  std::ranges::sort(sorted);
  if (const auto twice = std::ranges::adjacent_find(sorted); twice != sorted.end())
    return BadInput(fmt::format("the name \"{}\" stands there twice: the file is damaged", *twice));
  return names;
}

/// How often each object is named.
class NamesOfObjects {
 public:
  void Count(const char* name, const H5L_info_t& link) {
    if (link.type == H5L_TYPE_HARD) names_[link.u.address].push_back(name);
  }
  /// An object counts its names. One that is found under more of them has got a name of another by a damaged address.
  Status Check(hid_t location) const {
    for (const auto& [address, names] : names_) {
      if (names.size() < 2) continue;
      const Handle object(H5Oopen_by_addr(location, address));
      H5O_info_t info = {};
      if (!object.valid() || H5Oget_info2(object.id(), &info, H5O_INFO_BASIC) < 0)
        return LastError(fmt::format("\"{}\" cannot be opened", names.front()));
      if (info.rc < names.size())
        return BadInput(fmt::format("\"{}\" are one object, which has {} name{}: the file is damaged",
                                    fmt::join(names, "\", \""), info.rc, info.rc == 1 ? "" : "s"));
    }
    return {};
  }

 private:
  std::map<haddr_t, std::vector<std::string>> names_;
};

}  // namespace

Result<std::vector<std::string>> LinkNames(hid_t group) {
  const Handle plist(H5Gget_create_plist(group));
  unsigned order = 0;
  H5Pget_link_creation_order(plist.id(), &order);
  std::pair<std::vector<std::string>*, NamesOfObjects> into;
  Result<std::vector<std::string>> listed =
      Names((order & H5P_CRT_ORDER_TRACKED) != 0, [&](H5_index_t index, std::vector<std::string>* names) {
        into.first = names;
        const auto add = [](hid_t, const char* name, const H5L_info_t* link, void* out) -> herr_t {
          auto& [listing, objects] = *static_cast<decltype(into)*>(out);
          listing->emplace_back(name);
          objects.Count(name, *link);
          return 0;
        };
        return H5Literate(group, index, H5_ITER_INC, nullptr, add, &into);
      });
  if (!listed.ok()) return listed;
  if (Status s = into.second.Check(group)) return *s;
  return listed;
}

Status VisitLinks(hid_t group, const std::function<void(const char* path, const H5L_info_t& link)>& add) {
  struct Into {
    const std::function<void(const char*, const H5L_info_t&)>& add;
    NamesOfObjects objects;
  } into{add, {}};
  const Result<std::vector<std::string>> listed = Names(false, [&](H5_index_t index, std::vector<std::string>* names) {
    std::pair<Into*, std::vector<std::string>*> both{&into, names};
    const auto each = [](hid_t, const char* path, const H5L_info_t* link, void* out) -> herr_t {
      const auto& [to, paths] = *static_cast<decltype(both)*>(out);
      paths->emplace_back(path);
      to->objects.Count(path, *link);
      to->add(path, *link);
      return 0;
    };
    return H5Lvisit(group, index, H5_ITER_INC, each, &both);
  });
  if (!listed.ok()) return listed.failure();
  return into.objects.Check(group);
}

Result<std::vector<std::string>> AttributeNames(hid_t object) {
  const H5I_type_t type = H5Iget_type(object);
  const Handle plist(type == H5I_DATASET ? H5Dget_create_plist(object) : H5Gget_create_plist(object));
  unsigned order = 0;
  H5Pget_attr_creation_order(plist.id(), &order);
  return Names((order & H5P_CRT_ORDER_TRACKED) != 0, [&](H5_index_t index, std::vector<std::string>* names) {
    const auto add = [](hid_t, const char* name, const H5A_info_t*, void* out) -> herr_t {
      static_cast<std::vector<std::string>*>(out)->emplace_back(name);
      return 0;
    };
    return H5Aiterate2(object, index, H5_ITER_INC, nullptr, add, names);
  });
}

Result<Space> SpaceOf(hid_t object, const std::string& name) {
  const Handle space(H5Iget_type(object) == H5I_ATTR ? H5Aget_space(object) : H5Dget_space(object));
  const int rank = H5Sget_simple_extent_ndims(space.id());
  const hssize_t points = H5Sget_simple_extent_npoints(space.id());
  if (!space.valid() || rank < 0 || points < 0) return LastError(fmt::format("{} has no readable extent", name));
  std::vector<hsize_t> extents(static_cast<std::size_t>(rank)), most(extents.size());
  if (rank > 0 && H5Sget_simple_extent_dims(space.id(), extents.data(), most.data()) != rank)
    return LastError(fmt::format("{} has no readable extent", name));
  Space read{.shape = {extents.begin(), extents.end()}};
  if (H5Sget_simple_extent_type(space.id()) == H5S_NULL) read.shape = {0};
  const bool empty = std::ranges::count(read.shape, 0U) > 0;
  for (std::size_t i = 0; i < extents.size(); ++i) {
    if (extents[i] > most[i])
      return BadInput(fmt::format("{} has extents {}, of which at most {} are possible: the file is damaged", name,
                                  fmt::join(extents, " x "), fmt::join(most, " x ")));
    read.may_grow_to_a_limit |= extents[i] < most[i] && most[i] != H5S_UNLIMITED;
  }
  for (const std::size_t extent : read.shape) {
    if (__builtin_mul_overflow(read.count, empty ? std::min<std::size_t>(extent, 1) : extent, &read.count))
      return BadInput(fmt::format("{} has extents {}, more than can be counted", name, fmt::join(read.shape, " x ")));
  }
  if (read.count != static_cast<std::size_t>(points))
    return BadInput(fmt::format("{} has extents {}, but {} values", name, fmt::join(read.shape, " x "), points));
  return read;
}

void* MemoryFile::Resize(void*, std::size_t bytes, H5FD_file_image_op_t, void* self) {
  try {
    auto& memory = static_cast<MemoryFile*>(self)->bytes_;
    memory.resize(bytes);
    return memory.data();
  } catch (const std::bad_alloc&) {
    return nullptr;  // HDF5 turns it into an error
  }
}

Result<std::unique_ptr<MemoryFile>> MemoryFile::Create(std::size_t expected_bytes) {
  std::unique_ptr<MemoryFile> memory(new MemoryFile);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS));
  const Handle creation(H5Pcreate(H5P_FILE_CREATE));
  H5Pset_fapl_core(access.id(), std::max<std::size_t>(expected_bytes, 1U << 16), /*backing_store=*/0);
  H5FD_file_image_callbacks_t callbacks = {};
  callbacks.image_malloc = [](std::size_t bytes, H5FD_file_image_op_t op, void* self) {
    return Resize(nullptr, bytes, op, self);
  };
  callbacks.image_realloc = Resize;
  callbacks.image_free = [](void*, H5FD_file_image_op_t, void*) -> herr_t { return 0; };  // the bytes are what we want
  callbacks.udata_copy = [](void* self) { return self; };
  callbacks.udata_free = [](void*) -> herr_t { return 0; };
  callbacks.udata = memory.get();
  H5Pset_file_image_callbacks(access.id(), &callbacks);
  // The format of HDF5 1.10 (2016): all its metadata carry checksums. The older chunk index has none: a changed byte in
  // it can make values come back as zeros.
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  // Closing fails while an object is still open, instead of leaving the bytes unfinished.
  H5Pset_fclose_degree(access.id(), H5F_CLOSE_SEMI);
  // No times on the root group. Non-default file properties (such as H5Pset_istore_k) would add a superblock extension,
  // which stores the clock whatever is said here.
  H5Pset_obj_track_times(creation.id(), false);
  memory->file_ = Handle(H5Fcreate("memory", H5F_ACC_TRUNC, creation.id(), access.id()));
  if (!memory->file_.valid()) return LastError("cannot build the file in memory");
  return memory;
}

Result<std::vector<std::byte>> MemoryFile::Finish() {
  // Flushing gives back what was set aside but not used; the memory beyond the size is never part of the file.
  const bool flushed = H5Fflush(file_.id(), H5F_SCOPE_GLOBAL) >= 0;
  const ssize_t size = flushed ? H5Fget_file_image(file_.id(), nullptr, 0) : -1;
  if (size <= 0 || H5Fclose(file_.Release()) < 0 || static_cast<std::size_t>(size) > bytes_.size()) {
    return LastError("cannot finish the file in memory");
  }
  bytes_.resize(static_cast<std::size_t>(size));
  return std::move(bytes_);
}

Result<Handle> CreateGroup(hid_t location, const std::string& name) {
  const Handle plist(H5Pcreate(H5P_GROUP_CREATE));
  H5Pset_obj_track_times(plist.id(), false);
  H5Pset_link_creation_order(plist.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  H5Pset_attr_creation_order(plist.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  Handle group(H5Gcreate2(location, name.c_str(), H5P_DEFAULT, plist.id(), H5P_DEFAULT));
  if (!group.valid()) return LastError(fmt::format("group \"{}\" cannot be written", name));
  return group;
}

Result<Handle> WriteDoubles(hid_t location, const std::string& name, std::span<const double> values,
                            const Storage& storage) {
  const Handle plist(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_obj_track_times(plist.id(), false);
  if (!values.empty()) {
    // Chunks of equal size up to 512 kB: the last one is padded by less than a value a chunk.
    constexpr std::size_t kLargestChunk = 1U << 16;
    const std::size_t chunks = (values.size() + kLargestChunk - 1) / kLargestChunk;
    const hsize_t rows = (values.size() + chunks - 1) / chunks;
    H5Pset_chunk(plist.id(), 1, &rows);
    if (storage.deflate_level > 0) {
      H5Pset_shuffle(plist.id());
      H5Pset_deflate(plist.id(), static_cast<unsigned>(std::min(storage.deflate_level, 9)));
    }
    H5Pset_fletcher32(plist.id());
  }
  const hsize_t extent = values.size();
  const Handle space(H5Screate_simple(1, &extent, nullptr));
  Handle dataset(H5Dcreate2(location, name.c_str(), H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, plist.id(), H5P_DEFAULT));
  if (!dataset.valid() ||
      (extent > 0 && H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)) {
    return LastError(fmt::format("dataset \"{}\" cannot be written", name));
  }
  return dataset;
}

Status WriteText(hid_t location, const std::string& name, std::string_view text) {
  const Handle type = TextType(text);
  const Handle space(H5Screate(H5S_SCALAR));
  const Handle plist(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_obj_track_times(plist.id(), false);
  // Inside the header, whose checksum then covers it; a header ends at 64 kB.
  constexpr std::size_t kLongestCompact = 60000;
  if (text.size() <= kLongestCompact) H5Pset_layout(plist.id(), H5D_COMPACT);
  const Handle dataset(H5Dcreate2(location, name.c_str(), type.id(), space.id(), H5P_DEFAULT, plist.id(), H5P_DEFAULT));
  const std::string padded(text.empty() ? std::string_view("\0", 1) : text);
  if (!dataset.valid() || H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0) {
    return LastError(fmt::format("dataset \"{}\" cannot be written", name));
  }
  return {};
}

Status WriteAttribute(hid_t object, const std::string& name, std::string_view text) {
  const Handle type = TextType(text);
  const std::string padded(text.empty() ? std::string_view("\0", 1) : text);
  return WriteScalarAttribute(object, name, type.id(), type.id(), padded.data());
}

Status WriteAttribute(hid_t object, const std::string& name, double value) {
  return WriteScalarAttribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

Status WriteAttribute(hid_t object, const std::string& name, std::int64_t value) {
  return WriteScalarAttribute(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

}  // namespace dynoproof::trace::hdf5
