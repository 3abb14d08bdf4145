// The file of a record that a scenario states.
#include "experiment/measured_record.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

TEST(HashOf, IsTheFilesSha256) {
  const test::TempDir folder;
  EXPECT_EQ(HashOf(folder.Write("abc.csv", "abc").string()),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");  // FIPS 180-2, appendix B.1
}

TEST(HashOf, OfWhatHasNoEndIsNone) {
  const test::TempDir folder;
  const std::string pipe = (folder.path() / "pipe.csv").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(HashOf(pipe), "");
  EXPECT_EQ(HashOf("/dev/zero"), "");
  EXPECT_EQ(HashOf(folder.path().string()), "");
  EXPECT_EQ(HashOf((folder.path() / "none.csv").string()), "");
}

}  // namespace
}  // namespace dynoproof
