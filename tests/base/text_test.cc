#include "base/text.h"

#include <gtest/gtest.h>

#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

TEST(ReadTextFile, GivesAllBytesOrNothing) {
  const test::TempDir folder;
  const std::string longer(100'001, 'x');
  EXPECT_EQ(ReadTextFile(folder.Write("longer", longer)), longer);
  EXPECT_EQ(ReadTextFile(folder.Write("empty", "")), "");
  EXPECT_EQ(ReadTextFile(folder / "missing"), std::nullopt);
  EXPECT_EQ(ReadTextFile(folder.path()), std::nullopt) << "a folder opens, but has no text";
}

}  // namespace
}  // namespace dynoproof
