#include "probe/proposal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenario/load.h"

namespace dynoproof::probe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

Finding Hole(const char* name, const char* place, std::map<std::string, double> reach) {
  Finding hole{.name = name, .place = place, .unit = "1"};
  hole.state = State::kUnseen;
  hole.sized = true;
  hole.reach = std::move(reach);
  return hole;
}

TEST(Proposals, AreTheFewestTubesThatSeeAllHolesAtHalfTheirStrength) {
  const std::vector<Finding> holes = {Hole("a", "shaft:k1", {{"T", 0.05}, {"w", 0.2}}),
                                      Hole("b", "shaft:k2", {{"T", 0.013}, {"w", 1e-9}}),
                                      Hole("c", "output:w", {{"T", 0.0}, {"w", 0.4}})};
  const std::vector<Proposal> proposals = Propose(holes, {{"T", 1e-9}, {"w", 1e-6}});
  ASSERT_THAT(proposals, SizeIs(2));
  EXPECT_EQ(proposals[0].output, "T");
  EXPECT_DOUBLE_EQ(proposals[0].relative_width, 0.006) << "half of 0.013, rounded down";
  EXPECT_THAT(proposals[0].sees, ElementsAre("a at shaft:k1", "b at shaft:k2"));
  EXPECT_EQ(proposals[1].output, "w");
  EXPECT_DOUBLE_EQ(proposals[1].relative_width, 0.2);
}

TEST(Proposals, AreNeverNarrowerThanWhatBuildsKeep) {
  // Two solvers 2e-4 apart: no tube below 2e-3, so what moves the output by less than twice that is out of reach.
  const std::vector<Finding> holes = {Hole("small", "shaft:k1", {{"T", 3.9e-3}}),
                                      Hole("large", "shaft:k1", {{"T", 4.1e-3}})};
  const std::vector<Proposal> proposals = Propose(holes, {{"T", 2e-4}});
  ASSERT_THAT(proposals, SizeIs(1));
  EXPECT_THAT(proposals[0].sees, ElementsAre("large at shaft:k1"));
  EXPECT_DOUBLE_EQ(proposals[0].relative_width, 2e-3);
  EXPECT_THAT(Propose({Hole("tiny", "shaft:k1", {{"T", 1e-7}})}, {{"T", 0.0}}), IsEmpty());
  EXPECT_THAT(Propose(holes, {}), IsEmpty()) << "nothing is known of any build";
}

TEST(Proposals, AskNothingOfWhatIsSeen) {
  Finding seen = Hole("a", "shaft:k1", {{"T", 0.5}});
  seen.state = State::kSeen;
  seen.size = 0.5;
  EXPECT_THAT(Propose({seen}, {{"T", 0.0}}), IsEmpty());
}

TEST(Proposals, AreLinesThatAReaderTakes) {
  const std::string lines = ToLines({{"T_shaft", 2e-3, 1e-6, {"a at shaft:k1"}}}, false);
  EXPECT_THAT(lines, HasSubstr("kind = \"golden\""));
  EXPECT_THAT(ToLines({{"T_shaft", 2e-3, 1e-6, {"a at shaft:k1"}}}, true), Not(HasSubstr("[[check]]")));
  const std::optional<Value> read = FromToml(lines);
  ASSERT_TRUE(read.has_value()) << lines;
  EXPECT_DOUBLE_EQ(read->NumberOr("signal.T_shaft.relative_width", 0.0), 2e-3);
  EXPECT_THAT(read->TextOr("signal.T_shaft.origin"), HasSubstr("a at shaft:k1"));
}

}  // namespace
}  // namespace dynoproof::probe
