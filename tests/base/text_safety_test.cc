#include "base/text_safety.h"

#include <gtest/gtest.h>

namespace dynoproof {
namespace {

TEST(TextSafety, TellsUtf8) {
  for (const char* good : {"", "abc", "gr\u00F6\u00DFer", "\u20AC", "\U0001F600"}) EXPECT_TRUE(IsUtf8(good)) << good;
  // Latin-1, cut, longer than need be, a surrogate, beyond the last character, a byte of the middle first.
  for (const char* bad : {"gr\xF6\xDF"
                          "er",
                          "\xE2\x82", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\x80"}) {
    EXPECT_FALSE(IsUtf8(bad)) << bad;
  }
}

TEST(TextSafety, TakesOtherBytesAsWindows1252) {
  EXPECT_EQ(ToUtf8("\xB5N \xB0"
                   "C \x80 \x96"),
            "\u00B5N \u00B0C \u20AC \u2013");
  EXPECT_EQ(ToUtf8("\u00B5N"), "\u00B5N");
  std::string all;
  for (int byte = 1; byte < 256; ++byte) all += static_cast<char>(byte);
  EXPECT_TRUE(IsUtf8(ToUtf8(all)));
}

TEST(TextSafety, ShowsNothingThatATerminalObeys) {
  EXPECT_EQ(Shown("a\x1B[31m\r\n\x07"), "\"a\\x1b[31m\\x0d\\x0a\\x07\"");
  EXPECT_EQ(Shown("\u202Eevil\u2066"), "\"\\u202eevil\\u2066\"");
  EXPECT_EQ(Shown("\x9B"
                  "2J"),
            "\"\u203A2J\"");
  EXPECT_EQ(Shown("\u00C2\u009B"), "\"\u00C2\\x9b\"");
}

TEST(TextSafety, CutsBetweenCharacters) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += "\u20AC";
  const std::string shown = Shown(text);
  EXPECT_TRUE(IsUtf8(shown));
  EXPECT_EQ(shown.size(), 40u * 3 + 5);
  EXPECT_EQ(Shown(std::string(40, 'a')), '"' + std::string(40, 'a') + '"');
}

}  // namespace
}  // namespace dynoproof
