#include "base/text_safety.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <optional>

namespace dynoproof {
namespace {

struct Decoded {
  std::uint32_t code;
  std::size_t bytes;
};

/// The first character of `text`; nothing if its bytes are no UTF-8 (cut, longer than need be, surrogates included).
std::optional<Decoded> FirstOf(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return Decoded{first, 1};
  const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < bytes) return {};
  std::uint32_t code = first & (0x7Fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0u) != 0x80u) return {};
    code = (code << 6) | (byte(i) & 0x3Fu);
  }
  const bool too_long = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  if (too_long || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000)) return {};
  return Decoded{code, bytes};
}

void Append(std::string& text, std::uint32_t code) {
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xC0u | (code >> 6));
    text += static_cast<char>(0x80u | (code & 0x3Fu));
  } else {  // the table below ends before 0x10000
    text += static_cast<char>(0xE0u | (code >> 12));
    text += static_cast<char>(0x80u | ((code >> 6) & 0x3Fu));
    text += static_cast<char>(0x80u | (code & 0x3Fu));
  }
}

/// Windows-1252 from 0x80 to 0x9F; the five bytes that it leaves open keep the control character of Latin-1.
constexpr std::array<std::uint16_t, 32> kWindows = {0x20AC, 0x0081, 0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                                    0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0x008D, 0x017D, 0x008F,
                                                    0x0090, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                                    0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0x009D, 0x017E, 0x0178};

/// What a terminal may obey: control characters, marks of direction, separators of lines.
bool IsControl(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || (code >= 0x200B && code <= 0x200F) ||
         (code >= 0x2028 && code <= 0x202E) || (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF;
}

}  // namespace

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const std::optional<Decoded> next = FirstOf(text);
    if (!next) return false;
    text.remove_prefix(next->bytes);
  }
  return true;
}

std::string ToUtf8(std::string_view text) {
  if (IsUtf8(text)) return std::string(text);
  std::string result;
  for (const char c : text) {
    const std::uint32_t byte = static_cast<unsigned char>(c);
    Append(result, byte >= 0x80 && byte < 0xA0 ? kWindows[byte - 0x80] : byte);
  }
  return result;
}

std::string WithoutControls(std::string_view text, std::string_view kept) {
  std::string result;
  while (!text.empty()) {
    const Decoded next = FirstOf(text).value_or(Decoded{static_cast<unsigned char>(text.front()), 1});
    if (!IsControl(next.code) || kept.find(text.front()) != std::string_view::npos) {
      result += text.substr(0, next.bytes);
    } else if (next.code < 0x100) {
      result += fmt::format("\\x{:02x}", next.code);
    } else {
      result += fmt::format("\\u{:04x}", next.code);
    }
    text.remove_prefix(next.bytes);
  }
  return result;
}

std::string AsMessage(std::string_view text) { return WithoutControls(ToUtf8(text), "\n\t"); }

std::string Shown(std::string_view text) {
  constexpr std::size_t kMost = 40;
  const std::string whole = ToUtf8(text.substr(0, 8 * kMost));  // no character has more than 4 bytes
  std::string_view rest = whole;
  for (std::size_t i = 0; i < kMost && !rest.empty(); ++i) rest.remove_prefix(FirstOf(rest)->bytes);
  const std::string_view start = std::string_view(whole).substr(0, whole.size() - rest.size());
  return fmt::format("\"{}\"{}", WithoutControls(start), rest.empty() ? "" : "...");
}

}  // namespace dynoproof
