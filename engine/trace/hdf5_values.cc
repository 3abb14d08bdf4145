#include "trace/hdf5_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <new>
#include <system_error>
#include <utility>

#include "base/bad_input.h"

namespace dynoproof::trace::hdf5 {
namespace {

/// Notes that the bytes belong to a dataset, and says whether no other has them: two that share bytes are a damaged
/// address. `chunked`: addresses of pieces, which count from another place than those of whole datasets.
bool BelongsTo(hid_t dataset, bool chunked, hsize_t piece, haddr_t begin, hsize_t size) {
  struct Owner {
    haddr_t end, object;
    hsize_t piece;
    bool operator==(const Owner&) const = default;
  };
  static std::map<std::pair<unsigned long, bool>, std::map<haddr_t, Owner>> files;  // under the lock of Session
  H5O_info_t info;
  if (H5Oget_info2(dataset, &info, H5O_INFO_BASIC) < 0) return false;
  std::map<haddr_t, Owner>& owners = files[{info.fileno, chunked}];
  const Owner owner = {begin + size, info.addr, piece};
  const auto next = owners.lower_bound(begin);
  if (next != owners.end() && next->first == begin) return next->second == owner;  // the same one, read again
  if (next != owners.end() && next->first < owner.end) return false;
  if (next != owners.begin() && std::prev(next)->second.end > begin) return false;
  owners.emplace(begin, owner);
  return true;
}

/// What is wrong with the size of a piece whose numbers take `bytes`, where it says that it passed by the filters in the
/// bits of `skipped`; "" if nothing is. Nothing but the size tells a damaged word of a filter: packed bytes would be taken
/// for numbers.
std::string FaultOfSize(hid_t plist, unsigned skipped, hsize_t bytes, hsize_t size) {
  const int filters = H5Pget_nfilters(plist);
  bool packed = false, passes_shuffle = false;
  int used = 0;
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(plist, static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &config);
    if (i < 32 && (skipped >> i & 1U) != 0) {
      passes_shuffle |= filter == H5Z_FILTER_SHUFFLE;
      continue;
    }
    ++used;
    if (filter == H5Z_FILTER_FLETCHER32) {
      bytes += 4;
    } else if (filter != H5Z_FILTER_SHUFFLE) {
      packed = true;
    }
  }
  // A filter is passed by where it has no use for a piece, which is then stored as it is. Shuffling always succeeds.
  if (skipped != 0 && (packed || (passes_shuffle && (used > 0 || filters == 1))))
    return fmt::format("says that only some of its {} filters were applied", filters);
  if (!packed && size != bytes)
    return fmt::format("is of {} bytes where its numbers have {}, and nothing says that they are packed", size, bytes);
  return "";
}

/// What is wrong with one piece; "" if nothing is, or if there are too many to look. `bytes`: of its numbers.
std::string FaultOfPiece(hid_t dataset, hid_t plist, hsize_t number, const std::vector<hsize_t>& at, hsize_t bytes,
                         hsize_t count) {
  constexpr hsize_t kMostSearched = 4096;  // the library goes through all pieces for each
  if (count > kMostSearched) return "";
  hsize_t file_size = 0, size = 0;
  unsigned skipped = 0;
  haddr_t place = HADDR_UNDEF;
  const Handle file(H5Iget_file_id(dataset));
  H5Fget_filesize(file.id(), &file_size);
  if (H5Dget_chunk_info_by_coord(dataset, at.data(), &skipped, &place, &size) < 0 || place == HADDR_UNDEF || size == 0)
    return fmt::format("is incomplete: its piece at [{}] is not in the file", fmt::join(at, ", "));
  if (place > file_size || size > file_size - place)
    return fmt::format("has its piece at [{}] outside the file", fmt::join(at, ", "));
  if (const std::string fault = FaultOfSize(plist, skipped, bytes, size); !fault.empty())
    return fmt::format("has a piece at [{}] that {}", fmt::join(at, ", "), fault);
  if (!BelongsTo(dataset, true, number, place, size))
    return fmt::format("has a piece at [{}] in the bytes of another", fmt::join(at, ", "));
  return "";
}

/// What is wrong with the chunks of a dataset; "" if nothing is.
std::string FaultOfChunks(hid_t dataset, const std::vector<std::size_t>& shape, hid_t plist, std::size_t item) {
  const int rank = static_cast<int>(shape.size());
  std::vector<hsize_t> chunk(shape.size());
  if (rank == 0 || H5Pget_chunk(plist, rank, chunk.data()) != rank) return "has chunks of no size";
  hsize_t wanted = 1, bytes = item;
  for (int i = 0; i < rank; ++i) {
    if (chunk[i] == 0 || bytes > kMostBytes / chunk[i]) return "has chunks of an impossible size";
    bytes *= chunk[i];
    const hsize_t along = (shape[i] + chunk[i] - 1) / chunk[i];
    if (along != 0 && wanted > kMostBytes / along) return "has more chunks than a file can hold";
    wanted *= along;
  }
  hsize_t there = 0;
  const Handle space(H5Dget_space(dataset));
  if (H5Dget_num_chunks(dataset, space.id(), &there) < 0) return "has chunks that cannot be counted";
  if (there != wanted)
    return fmt::format("is incomplete: {} of its {} pieces are in the file, the others would be read as zeros", there,
                       wanted);
  // The library counts what the index lists, but reads what it finds by searching in it; in a damaged index that is not
  // the same, and what is not found is read as zeros. So each piece is searched as it is on reading.
  const bool filtered = H5Pget_nfilters(plist) > 0;
  std::vector<char> scratch(filtered ? 0 : bytes);
  std::vector<hsize_t> at(shape.size(), 0);
  for (hsize_t k = 0; k < wanted; ++k) {
    if (std::string fault = FaultOfPiece(dataset, plist, k, at, bytes, wanted); !fault.empty()) return fault;
    hsize_t size = 0;
    std::uint32_t skipped = 0;
    const bool found = filtered ? H5Dget_chunk_storage_size(dataset, at.data(), &size) >= 0 && size > 0
                                : H5Dread_chunk(dataset, H5P_DEFAULT, at.data(), &skipped, scratch.data()) >= 0;
    if (!found) return fmt::format("is incomplete: its piece at [{}] is not in the file", fmt::join(at, ", "));
    for (std::size_t i = at.size(); i-- > 0;) {
      at[i] += chunk[i];
      if (at[i] < shape[i]) break;
      at[i] = 0;
    }
  }
  return "";
}

/// What is wrong with the way in which a dataset is stored; "" if nothing is.
std::string FaultOfStorage(hid_t dataset, const Space& space, hid_t type) {
  const hsize_t count = space.count;
  const Handle plist(H5Dget_create_plist(dataset));
  if (!plist.valid()) return "has no readable description of its storage";
  const hsize_t stored = H5Dget_storage_size(dataset), item = H5Tget_size(type);
  const H5D_layout_t layout = H5Pget_layout(plist.id());
  if (const int others = H5Pget_external_count(plist.id()); others != 0) {
    char name[256] = "?";
    off_t offset = 0;
    hsize_t size = 0;
    if (others > 0) H5Pget_external(plist.id(), 0, sizeof name - 1, name, &offset, &size);
    return fmt::format("has its values in another file, \"{}\", which is not followed", name);
  }
  if (layout == H5D_VIRTUAL) return "is put together from other datasets (virtual), which is not followed";
  if (stored == 0) return fmt::format("promises {} values, but none are stored", count);
  if (layout == H5D_CHUNKED) return FaultOfChunks(dataset, space.shape, plist.id(), item);
  if (layout != H5D_CONTIGUOUS && layout != H5D_COMPACT) return "is stored in an unknown manner";
  if (stored != count * item)
    return fmt::format("has {} values of {} bytes, but {} bytes are stored", count, item, stored);
  if (layout == H5D_CONTIGUOUS && !BelongsTo(dataset, false, 0, H5Dget_offset(dataset), stored))
    return "has its values in the bytes of another dataset";
  return "";
}

}  // namespace

ApartLimits LimitsFor(const std::filesystem::path& path) {
  ApartLimits limits;
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::file_size(path, ignored);
  if (!ignored) limits.cpu_s += static_cast<double>(size) / 1e7;
  return limits;
}

bool IsUsual(hid_t type) {
  const std::size_t bits = 8 * H5Tget_size(type);
  const H5T_order_t order = H5Tget_order(type);
  if (order != H5T_ORDER_LE && order != H5T_ORDER_BE) return false;
  if (H5Tget_class(type) == H5T_INTEGER)
    return H5Tget_precision(type) == bits && H5Tget_offset(type) == 0 && bits <= 64;
  if (H5Tequal(type, H5T_NATIVE_LDOUBLE) > 0) return true;
  std::size_t sign = 0, exponent = 0, exponent_bits = 0, mantissa = 0, mantissa_bits = 0;
  if (H5Tget_fields(type, &sign, &exponent, &exponent_bits, &mantissa, &mantissa_bits) < 0) return false;
  const std::size_t wanted = bits == 64 ? 11 : bits == 32 ? 8 : bits == 16 ? 5 : 0;  // exponents of IEEE 754
  return wanted > 0 && H5Tget_precision(type) == bits && H5Tget_offset(type) == 0 && sign == bits - 1 &&
         exponent == sign - wanted && exponent_bits == wanted && mantissa == 0 && mantissa_bits == exponent &&
         H5Tget_ebias(type) == (std::size_t{1} << (wanted - 1)) - 1 && H5Tget_norm(type) == H5T_NORM_IMPLIED;
}

bool HoldsNumbers(hid_t dataset) {
  const Handle type(H5Dget_type(dataset));
  const H5T_class_t type_class = H5Tget_class(type.id());
  return type_class == H5T_FLOAT || type_class == H5T_INTEGER;
}

Result<std::vector<double>> ReadDoubles(hid_t dataset, const std::string& name) {
  if (!HoldsNumbers(dataset)) return BadInput(fmt::format("dataset \"{}\" does not hold numbers", name));
  const Handle type(H5Dget_type(dataset));
  if (!IsUsual(type.id())) return BadInput(fmt::format("dataset \"{}\" holds numbers of an unusual form", name));
  const Result<Space> space = SpaceOf(dataset, fmt::format("dataset \"{}\"", name));
  if (!space.ok()) return space.failure();
  const hsize_t count = space->count;
  if (count == 0) return std::vector<double>();
  // A damaged header may promise any extent. Deflate cannot shrink by more than about 1032.
  const hsize_t stored = H5Dget_storage_size(dataset);
  constexpr hsize_t kLargestRatio = 1100;
  if (count > kMostBytes / sizeof(double))
    return BadInput(fmt::format("dataset \"{}\" promises {} values, of which at most {} are read", name, count,
                                kMostBytes / sizeof(double)));
  if (stored > 0 && count * H5Tget_size(type.id()) / kLargestRatio > stored)
    return BadInput(
        fmt::format("dataset \"{}\" promises {} values, but only {} bytes are stored", name, count, stored));
  if (const std::string fault = FaultOfStorage(dataset, *space, type.id()); !fault.empty())
    return BadInput(fmt::format("dataset \"{}\" {}", name, fault));
  try {
    std::vector<double> values(static_cast<std::size_t>(count));
    if (H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
      return LastError(fmt::format("dataset \"{}\" cannot be read", name));
    }
    return values;
  } catch (const std::bad_alloc&) {
    return BadInput(fmt::format("dataset \"{}\" with {} values does not fit into memory", name, count));
  }
}

}  // namespace dynoproof::trace::hdf5
