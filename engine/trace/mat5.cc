#include "trace/mat5.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <utility>

#include "base/text_safety.h"

namespace dynoproof::trace::mat {
namespace {

constexpr std::uint64_t kFileHeader = 128, kTag = 8;

/// Types of elements that have a part here, by the numbers that the format gives them.
enum Type : std::uint32_t {
  kInt8 = 1,
  kUInt8 = 2,
  kUInt16 = 4,
  kInt32 = 5,
  kUInt32 = 6,
  kMatrix = 14,
  kCompressed = 15,
  kUtf8 = 16,
  kUtf16 = 17,
  kUtf32 = 18,
};

/// Classes of variables.
enum Class : std::uint32_t {
  kCell = 1,
  kStruct = 2,
  kObject = 3,
  kChar = 4,
  kSparse = 5,
  kDoubleClass = 6,
  kSingleClass = 7,
  kInt8Class = 8,
  kUInt64Class = 15,
  kFunction = 16,
  kOpaque = 17,
};

std::optional<Number> NumberOf(std::uint32_t type) {
  constexpr Number kInOrder[] = {Number::kInt8,   Number::kUInt8, Number::kInt16,
                                 Number::kUInt16, Number::kInt32, Number::kUInt32};
  if (type >= 1 && type <= 6) return kInOrder[type - 1];
  if (type == 7) return Number::kSingle;
  if (type == 9) return Number::kDouble;
  if (type == 12) return Number::kInt64;
  if (type == 13) return Number::kUInt64;
  return {};
}

/// Whether numbers of a class are ever stored as `number`: as themselves or in fewer bytes.
bool MayStore(std::uint32_t class_type, Number number) {
  const bool whole = number < Number::kSingle;
  if (class_type == kDoubleClass) return number == Number::kDouble || SizeOf(number) < 8;
  if (class_type == kSingleClass) return number == Number::kSingle || (whole && SizeOf(number) < 8);
  return whole && SizeOf(number) <= std::size_t{1} << (class_type - kInt8Class) / 2;
}

struct Element {
  std::uint32_t type = 0;
  std::span<const char> bytes;
};

/// The parts of a variable, one after the other.
class Parts {
 public:
  Parts(std::span<const char> bytes, bool swapped) : bytes_(bytes), swapped_(swapped) {}

  bool done() const { return at_ >= bytes_.size(); }
  bool swapped() const { return swapped_; }
  const std::string& fault() const { return fault_; }
  bool Fail(std::string fault) {
    if (fault_.empty()) fault_ = std::move(fault);
    return false;
  }

  /// The next part, which must be of one of the types; `what` names it in a fault.
  std::optional<Element> Next(std::string_view what, std::initializer_list<std::uint32_t> types) {
    const std::optional<Element> element = Any(what);
    if (element && std::ranges::find(types, element->type) == types.end()) {
      Fail(fmt::format("its {} is of type {}, which cannot be", what, element->type));
      return {};
    }
    return element;
  }

  std::optional<Element> Any(std::string_view what) {
    const std::size_t there = bytes_.size() - std::min(at_, bytes_.size());
    if (there < kTag) return Cut(what);
    const char* const tag = bytes_.data() + at_;
    const std::uint32_t word = Word(tag, swapped_);
    Element element;
    if (const std::uint32_t few = word >> 16; few != 0) {  // length and type share a word, the bytes follow in the tag
      if (few > 4) return Cut(what);
      element = {word & 0xffff, {tag + 4, few}};
      at_ += kTag;
      return element;
    }
    const std::uint64_t length = Word(tag + 4, swapped_);
    if (length > there - kTag) {
      Fail(fmt::format("its {} has {} bytes, of which {} are there", what, length, there - kTag));
      return {};
    }
    element = {word, {tag + kTag, length}};
    at_ += kTag + (length + 7) / 8 * 8;  // of the last part some writers leave the filling out
    return element;
  }

 private:
  std::optional<Element> Cut(std::string_view what) {
    Fail(fmt::format("its {} is not whole", what));
    return {};
  }

  std::span<const char> bytes_;
  bool swapped_;
  std::size_t at_ = 0;
  std::string fault_;
};

/// The rest of a variable that is no column: whole parts, of the types that such a variable has.
bool PassBy(Parts& parts, std::initializer_list<std::uint32_t> types) {
  while (!parts.done()) {
    if (!(types.size() == 0 ? parts.Any("content") : parts.Next("content", types))) return false;
  }
  return true;
}

bool ReadNumbers(Parts& parts, std::uint32_t class_type, bool complex, Matrix& matrix) {
  const std::optional<std::size_t> count = Count(matrix.extents);
  for (const std::string_view what : {"real part", "imaginary part"}) {
    if (what == "imaginary part" && !complex) break;
    if (count == 0U && parts.done()) break;  // nothing to store
    const std::optional<Element> data = parts.Any(what);
    if (!data) return false;
    const std::optional<Number> number = NumberOf(data->type);
    if (!number || !MayStore(class_type, *number))
      return parts.Fail(
          fmt::format("its {} is of type {}, which class {} does not have", what, data->type, class_type));
    const std::size_t held = data->bytes.size() / SizeOf(*number);
    if (data->bytes.size() % SizeOf(*number) != 0 || held != count)
      return parts.Fail(fmt::format("its {} has {} bytes, which do not make {} values", what, data->bytes.size(),
                                    fmt::join(matrix.extents, " x ")));
    if (!complex) matrix.values = ToDoubles(*number, data->bytes, parts.swapped());
  }
  if (complex) matrix.why_not = kIsComplex;
  return parts.done() || parts.Fail("something stands behind its values");
}

bool ReadExtents(Parts& parts, Matrix& matrix) {
  const std::optional<Element> extents = parts.Next("list of extents", {kInt32});
  if (!extents) return false;
  const std::size_t rank = extents->bytes.size() / 4;
  if (extents->bytes.size() % 4 != 0 || rank < 2) return parts.Fail("its list of extents is not whole");
  for (std::size_t i = 0; i < rank; ++i) {
    const std::uint32_t extent = Word(extents->bytes.data() + 4 * i, parts.swapped());
    if (extent > 0x7fffffff) return parts.Fail("it has a negative extent");
    matrix.extents.push_back(extent);
  }
  return Count(matrix.extents).has_value() || parts.Fail("its extents are beyond all bounds");
}

bool ReadName(Parts& parts, Matrix& matrix) {
  const std::optional<Element> name = parts.Next("name", {kInt8, kUInt8, kUtf8});
  if (!name) return false;
  matrix.name.assign(name->bytes.begin(), name->bytes.end());
  matrix.name.erase(matrix.name.find_last_not_of('\0') + 1);  // some writers count what fills it up
  matrix.name = ToUtf8(matrix.name);
  return std::ranges::none_of(matrix.name, [](char c) { return static_cast<unsigned char>(c) < ' '; }) ||
         parts.Fail("its name is no text");
}

bool ReadVariable(Parts& parts, Matrix& matrix) {
  if (parts.done()) {  // what stands for an empty variable
    matrix.extents = {0, 0};
    return true;
  }
  const std::optional<Element> flags = parts.Next("class", {kUInt32});
  if (!flags) return false;
  if (flags->bytes.size() != 8) return parts.Fail("its class is not whole");
  const std::uint32_t word = Word(flags->bytes.data(), parts.swapped()), class_type = word & 0xff;
  const bool complex = (word & 0x800) != 0;
  if (class_type == kOpaque) {
    matrix.why_not = kIsObject;
    return PassBy(parts, {});
  }
  if (class_type < kCell || class_type > kOpaque) return parts.Fail(fmt::format("its class {} is unknown", class_type));
  if (!ReadExtents(parts, matrix) || !ReadName(parts, matrix)) return false;
  switch (class_type) {
    case kCell:
      matrix.why_not = kIsCell;
      return PassBy(parts, {kMatrix});
    case kStruct:
      matrix.why_not = kIsStruct;
      return PassBy(parts, {kInt32, kInt8, kMatrix});
    case kObject:
    case kFunction:
      matrix.why_not = kIsObject;
      return PassBy(parts, {kInt32, kInt8, kMatrix});
    case kChar:
      matrix.why_not = kIsText;
      return PassBy(parts, {kInt8, kUInt8, kUInt16, kUtf8, kUtf16, kUtf32});
    case kSparse:
      matrix.why_not = kIsSparse;
      return PassBy(parts, {});
    default:
      return ReadNumbers(parts, class_type, complex, matrix);
  }
}

/// Unpacks one compressed element; `budget` is what may still be unpacked. Sets `fault` where it is not whole.
std::vector<char> Inflate(std::span<const char> packed, bool swapped, std::uint64_t& budget, std::string& fault) {
  z_stream stream = {};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // zlib's interface knows no const
  stream.avail_in = static_cast<uInt>(packed.size());
  if (inflateInit(&stream) != Z_OK) {
    fault = "cannot be unpacked: out of memory";
    return {};
  }
  std::vector<char> bytes(kTag);
  const auto fail = [&](std::string what) {
    fault = std::move(what);
    inflateEnd(&stream);
    return std::vector<char>();
  };
  const auto damaged = [&] {
    return fail(fmt::format("cannot be unpacked ({})", stream.msg != nullptr ? stream.msg : "it ends too early"));
  };
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = kTag;
  if (inflate(&stream, Z_SYNC_FLUSH) != Z_OK || stream.avail_out != 0) return damaged();
  const std::uint64_t length = Word(bytes.data() + 4, swapped);
  if (Word(bytes.data(), swapped) != kMatrix) return fail("holds something else than a variable");
  // Deflate shrinks by 1032 at most: what promises more is not there, and nothing is set aside for it.
  if (length / 1032 > packed.size())
    return fail(fmt::format("promises {} bytes, which {} packed ones cannot hold", length, packed.size()));
  if (kTag + length > budget)
    return fail(
        fmt::format("unpacks to {} bytes; all variables of a file together may to {}", length, kMostUnpackedBytes));
  budget -= kTag + length;
  bytes.resize(kTag + length + 1);  // one byte more, to see when there is too much
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data() + kTag);
  stream.avail_out = static_cast<uInt>(length + 1);
  const int end = inflate(&stream, Z_FINISH);
  if (stream.avail_out == 0) return fail(fmt::format("unpacks to more than its {} bytes", length));
  if (end != Z_STREAM_END) return damaged();
  if (stream.avail_out != 1)
    return fail(fmt::format("unpacks to {} bytes less than the {} that it should", stream.avail_out - 1, length));
  if (stream.avail_in != 0) return fail(fmt::format("has {} bytes behind its end", stream.avail_in));
  inflateEnd(&stream);
  bytes.pop_back();
  return bytes;
}

}  // namespace

bool LooksLike5(const char* header) {
  const std::string_view end(header + 124, 4);
  return end == std::string_view("\x00\x01IM", 4) || end == std::string_view("\x01\x00MI", 4);
}

Content ReadMat5(std::istream& file, std::uint64_t size) {
  Content content;
  std::uint64_t at = kFileHeader, budget = kMostUnpackedBytes;
  const auto fault = [&](const std::string& what) {
    content.fault = fmt::format("the element at byte {} {}", at, what);
    return std::move(content);
  };
  char header[kFileHeader];
  file.seekg(0);
  if (!file.read(header, kFileHeader)) {
    content.fault = "its header is not whole";
    return content;
  }
  const bool swapped = (header[126] == 'I') != (std::endian::native == std::endian::little);
  while (at < size) {
    char tag[kTag];
    file.seekg(static_cast<std::streamoff>(at));
    if (size - at < kTag || !file.read(tag, kTag)) return fault("has no whole tag");
    const std::uint32_t type = Word(tag, swapped);
    const std::uint64_t length = Word(tag + 4, swapped);
    if (length > size - at - kTag)
      return fault(fmt::format("has {} bytes, of which {} are there", length, size - at - kTag));
    if (type != kMatrix && type != kCompressed) return fault(fmt::format("is of type {}, no variable", type));
    std::vector<char> bytes(length);
    if (!file.read(bytes.data(), static_cast<std::streamsize>(length))) return fault("cannot be read");
    std::span<const char> inside = bytes;
    std::vector<char> unpacked;
    if (type == kCompressed) {
      std::string broken;
      unpacked = Inflate(bytes, swapped, budget, broken);
      if (!broken.empty()) return fault(broken);
      inside = std::span<const char>(unpacked).subspan(kTag);
    }
    Matrix matrix;
    Parts parts(inside, swapped);
    if (!ReadVariable(parts, matrix))
      return fault(matrix.name.empty() ? "is no whole variable: " + parts.fault()
                                       : fmt::format("(variable \"{}\"): {}", matrix.name, parts.fault()));
    content.matrices.push_back(std::move(matrix));
    at += kTag + length;
  }
  return content;
}

}  // namespace dynoproof::trace::mat
