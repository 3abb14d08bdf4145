// In what two scenarios differ.
#include "scenario/changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenario/load.h"

namespace dynoproof {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> Between(const std::string& was, const std::string& is) {
  return ChangesBetween(*FromToml(was), *FromToml(is));
}

TEST(Changes, NameEachValueWithWhatItWas) {
  EXPECT_THAT(Between("[plant.inertia]\nI1 = 2.0\nI3 = 0.5\n", "[plant.inertia]\nI3 = 0.6\nI1 = 2.0\n"),
              ElementsAre("plant.inertia.I3 = 0.6 (was 0.5)"));
  EXPECT_THAT(Between("a = 1\nb = { c = 'x', d = [1, 2] }\n", "a = 1\nb = { c = 'y', d = [1, 3] }\n"),
              ElementsAre("b.c = \"y\" (was \"x\")", "b.d = [1, 3] (was [1, 2])"));
}

TEST(Changes, NameWhatIsNewAndWhatIsGone) {
  EXPECT_THAT(Between("a = 1\n", "a = 1\nload = { c = 2 }\n"), ElementsAre("load.c = 2 (was not there)"));
  EXPECT_THAT(Between("a = 1\nload = { c = 2 }\n", "a = 1\n"), ElementsAre("load.c is gone (was 2)"));
  EXPECT_THAT(Between("a = 1\n", "a = 1\nload = { friction = { on = 'I3', law = 'coulomb', T_c_Nm = 20.0 } }\n"),
              ElementsAre("load.friction = { on = \"I3\", law = \"coulomb\", T_c_Nm = 20.0 } (was not there)"));
}

TEST(Changes, WithinAListOfTablesAreThoseOfItsItems) {
  const std::string rest = "[[check]]\nkind = 'golden'\n";
  EXPECT_THAT(
      Between("[[check]]\nkind = 'peak'\nwithin = 3.0\n" + rest, "[[check]]\nkind = 'peak'\nwithin = 4.0\n" + rest),
      ElementsAre("check.0.within = 4.0 (was 3.0)"));
  EXPECT_THAT(Between("[[check]]\nkind = 'peak'\n" + rest, rest), ElementsAre("check.0.kind is gone (was \"peak\")"));
  EXPECT_THAT(Between(rest, rest + "[[check]]\nkind = 'peak'\n"),
              ElementsAre("check.1.kind = \"peak\" (was not there)"));
}

TEST(Changes, AreNoneWhereNumbersAreEqual) {
  EXPECT_THAT(Between("a = 2\n[b]\nc = 0.1\n", "a = 2.0\n[b]\nc = 0.1\n"), IsEmpty());
}

TEST(Changes, OfALongValueAreCutShort) {
  const std::string longer = "a = '" + std::string(200, 'x') + "'\n";
  EXPECT_LT(Between("a = 1\n", longer).at(0).size(), 100U);
}

}  // namespace
}  // namespace dynoproof
