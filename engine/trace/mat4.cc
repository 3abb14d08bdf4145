#include "trace/mat4.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <utility>

#include "base/text_safety.h"

namespace dynoproof::trace::mat {
namespace {

constexpr std::uint64_t kMatrixHeader = 20;
constexpr Number kPrecisions[] = {Number::kDouble, Number::kSingle, Number::kInt32,
                                  Number::kInt16,  Number::kUInt16, Number::kUInt8};

/// type = 1000 M + 100 O + 10 P + T: byte order, 0, precision, kind.
struct NumberType {
  bool swapped = false;
  Number number = Number::kDouble;
  std::uint32_t kind = 0;  // 0 numbers, 1 text, 2 sparse
};

std::optional<NumberType> ParseType(const char* bytes) {
  constexpr bool kBigHere = std::endian::native == std::endian::big;
  for (const bool big : {false, true}) {
    const bool swapped = big != kBigHere;
    const std::uint32_t word = Word(bytes, swapped), rest = word - (big ? 1000 : 0);
    if (big && word < 1000) continue;
    if (rest / 10 > 5 || rest % 10 > 2) continue;
    return NumberType{swapped, kPrecisions[rest / 10], rest % 10};
  }
  return {};
}

}  // namespace

bool LooksLike4(const char* bytes) { return ParseType(bytes).has_value(); }

Content ReadMat4(std::istream& file, std::uint64_t size) {
  Content content;
  std::uint64_t at = 0;
  const auto fault = [&](const std::string& what) {
    content.fault = fmt::format("the matrix at byte {} {}", at, what);
    return std::move(content);
  };
  while (at < size) {
    char header[kMatrixHeader];
    file.seekg(static_cast<std::streamoff>(at));
    if (size - at < kMatrixHeader || !file.read(header, kMatrixHeader)) return fault("has no whole header");
    const std::optional<NumberType> type = ParseType(header);
    if (!type) return fault(fmt::format("has an unknown type ({})", Word(header, false)));
    const auto word = [&](int number) -> std::uint64_t { return Word(header + 4 * number, type->swapped); };
    const std::uint64_t rows = word(1), columns = word(2), complex = word(3), name_length = word(4);
    if (complex > 1) return fault(fmt::format("has an imaginary part of kind {}, which there is not", complex));
    const std::uint64_t there = size - at - kMatrixHeader;
    if (name_length == 0 || name_length > there) return fault("has a name that the file cannot hold");
    // Extents below 2^32 each: their product fits, that with the size of a number may not.
    const std::uint64_t most = (there - name_length) / SizeOf(type->number) / (complex + 1);
    if (rows * columns > most)
      return fault(fmt::format("has {} x {} values, of which the file can hold {}", rows, columns, most));
    if (type->kind == 2 && columns != 3 && columns != 4)
      return fault(fmt::format("is sparse in {} columns, which there is not", columns));
    std::string name(name_length, '\0');
    std::vector<char> bytes(rows * columns * (complex + 1) * SizeOf(type->number));
    if (!file.read(name.data(), static_cast<std::streamsize>(name.size())) ||
        !file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
      return fault("cannot be read");
    if (name.back() != '\0' || name.find('\0') != name.size() - 1) return fault("has a name that does not end");
    name = WithoutControls(ToUtf8(name.substr(0, name.size() - 1)));
    Matrix matrix{.name = std::move(name), .extents = {rows, columns}, .is_text = type->kind == 1};
    matrix.why_not = type->kind == 1 ? kIsText : type->kind == 2 ? kIsSparse : complex == 1 ? kIsComplex : "";
    if (matrix.why_not.empty() || matrix.is_text) matrix.values = ToDoubles(type->number, bytes, type->swapped);
    content.matrices.push_back(std::move(matrix));
    at += kMatrixHeader + name_length + bytes.size();
  }
  return content;
}

}  // namespace dynoproof::trace::mat
