// MAT files by their bytes, for tests: what a reader must take, and what no writer would write.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dynoproof::test {

template <class T>
std::string Raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
inline std::string Words(const std::vector<std::uint32_t>& words) { return Raw(words); }

/// Numbers of a smooth signal that does not compress to nothing.
inline std::vector<double> Wave(std::size_t count, double phase = 0.0) {
  std::vector<double> values(count);
  double x = 0.1 + phase, v = 1.0;
  for (double& value : values) {
    value = x;
    v -= 0.05 * x;
    x += 0.3 * v;
  }
  return values;
}

// --- v5 ---

inline std::string Header5() {
  std::string header = "MATLAB 5.0 MAT-file, written by a test";
  header.resize(116, ' ');
  header.append(8, '\0');
  return header + std::string("\x00\x01IM", 4);
}

/// An element, or a part of one, filled up to whole words of 8 bytes.
inline std::string Element5(std::uint32_t type, std::string bytes) {
  const std::string tag = Words({type, static_cast<std::uint32_t>(bytes.size())});
  bytes.resize((bytes.size() + 7) / 8 * 8);
  return tag + bytes;
}

struct Variable5 {
  std::string name;
  std::vector<std::uint32_t> extents;
  std::string data;              // of the real part
  std::uint32_t data_type = 9;   // double
  std::uint32_t class_type = 6;  // double
  std::string behind = {};       // further parts
};

inline std::string Inside5(const Variable5& v) {
  return Element5(6, Words({v.class_type, 0})) + Element5(5, Words(v.extents)) + Element5(1, v.name) +
         Element5(v.data_type, v.data) + v.behind;
}
inline std::string Plain5(const Variable5& v) { return Element5(14, Inside5(v)); }
/// A compressed element around any bytes; `cut`: so many bytes of the stream are left out.
inline std::string Packed5(const std::string& plain, std::size_t cut = 0) {
  uLongf size = compressBound(plain.size());
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(plain.data()), plain.size());
  packed.resize(size - cut);
  return Words({15, static_cast<std::uint32_t>(packed.size())}) + packed;
}
inline Variable5 Doubles5(std::string name, const std::vector<double>& values) {
  return {std::move(name), {static_cast<std::uint32_t>(values.size()), 1}, Raw(values)};
}

// --- v4 ---

/// One matrix; `type` = 1000 M + 100 O + 10 P + T.
inline std::string Matrix4(std::uint32_t type, std::uint32_t rows, std::uint32_t columns, std::string_view name,
                           const std::string& data) {
  return Words({type, rows, columns, 0, static_cast<std::uint32_t>(name.size() + 1)}) + std::string(name) + '\0' + data;
}
/// A text matrix whose columns (or rows) are the words, filled up with `fill`.
inline std::string Text4(std::string_view name, const std::vector<std::string>& words, bool in_columns,
                         char fill = '\0') {
  std::size_t longest = 0;
  for (const std::string& word : words) longest = std::max(longest, word.size());
  std::string data;
  for (std::size_t i = 0; i < words.size() * longest; ++i) {
    const std::size_t word = in_columns ? i / longest : i % words.size();
    const std::size_t letter = in_columns ? i % longest : i / words.size();
    data += letter < words[word].size() ? words[word][letter] : fill;
  }
  const auto high = static_cast<std::uint32_t>(in_columns ? longest : words.size());
  const auto wide = static_cast<std::uint32_t>(in_columns ? words.size() : longest);
  return Matrix4(51, high, wide, name, data);
}

}  // namespace dynoproof::test
