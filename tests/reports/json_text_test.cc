#include "base/json_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace dynoproof {
namespace {

using nlohmann::json;

TEST(JsonText, BytesThatAreNoUtf8AreReplaced) {
  const json document = {{"gr\xfcn", {"bench_\xb5", "\xc3\xa4"}}};  // Latin-1, and the same letter in UTF-8
  std::string text;
  ASSERT_NO_THROW(text = JsonText(document));
  EXPECT_EQ(text,
            "{\"gr\xef\xbf\xbd"
            "n\":[\"bench_\xef\xbf\xbd\",\"\xc3\xa4\"]}");
  EXPECT_TRUE(json::accept(text));
  EXPECT_EQ(JsonText(json{1}, 2), "[\n  1\n]");
}

}  // namespace
}  // namespace dynoproof
