// A verdict begins with the cause in words, its place, its values, and the share of the error that it explains.
#include "diagnosis/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dynoproof::diagnosis {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

Diagnosis Friction() {
  Diagnosis d;
  d.verdict = Conclusion::kMainCause;
  FoundEffect friction;
  friction.name = "coulomb_friction";
  friction.at = "inertia:carriage";
  friction.description = "dry friction";
  friction.law = "T = -T_c sgn(w), sticking when it can hold";
  friction.parameters = {{"T_c", "N m", 20.6, 20.1, 21.1}};
  d.effects = {friction};
  d.explained = Share{0.931, 0.9, 0.95};
  d.reason = "coulomb_friction@inertia:carriage explains most";
  return d;
}

TEST(Sentence, TellsTheCauseItsSizeAndItsShare) {
  EXPECT_EQ(
      Sentence(Friction()),
      "dry friction, at inertia:carriage with T_c 20.6 N m. It explains 93.1 % of what the model gets wrong on data "
      "that took no part; what is left is more than noise");
}

TEST(Sentence, ClaimsNoShareWhereNothingCouldBeCompared) {
  Diagnosis d = Friction();
  d.explained.reset();
  EXPECT_THAT(Sentence(d), ::testing::EndsWith("with T_c 20.6 N m. What is left is more than noise"));
}

TEST(Sentence, SaysWhereWhatIsLeftShows) {
  Diagnosis d = Friction();
  d.left["q"] = {0.1, {}};
  d.left["v"] = {0.1, {}};
  d.left["v"].where.condition = "2.4 times larger at reversals of v";
  EXPECT_THAT(Sentence(d), ::testing::EndsWith("more than noise, in v 2.4 times larger at reversals of v"));
}

TEST(Sentence, OfSeveralCausesNamesEach) {
  Diagnosis d = Friction();
  d.verdict = Conclusion::kEffectFound;
  FoundEffect gain;
  gain.name = "sensor_rectified";
  gain.at = "output:z";
  gain.description = "an output shows the magnitude only";
  d.effects.push_back(gain);
  EXPECT_THAT(Sentence(d), HasSubstr("20.6 N m; and an output shows the magnitude only, at output:z. They explain"));
  EXPECT_THAT(Sentence(d), ::testing::EndsWith("what is left is noise"));
}

TEST(Sentence, NamesNothingWhereTheVerdictDoesNot) {
  Diagnosis d = Friction();
  d.verdict = Conclusion::kUnexplained;
  EXPECT_EQ(Sentence(d), "no cause is named. Nearest comes: dry friction, at inertia:carriage with T_c 20.6 N m");
  d.effects.clear();
  EXPECT_EQ(Sentence(d), d.reason);
  d.verdict = Conclusion::kNoEffect;
  EXPECT_EQ(Sentence(d), d.reason);
}

TEST(Sentence, NamesEachOfThoseThatTheDataDoNotTellApart) {
  Diagnosis d = Friction();
  d.verdict = Conclusion::kAmbiguous;
  FoundEffect load;
  load.at = "inertia:motor";
  load.description = "a load that the model does not have";
  d.instead = {{load}};
  EXPECT_EQ(
      Sentence(d),
      "one of these, which the data do not tell apart: dry friction, at inertia:carriage with T_c 20.6 N m; or: a "
      "load that the model does not have, at inertia:motor");
}

TEST(ToTable, BeginsWithVerdictAndSentenceAndSaysWhyNoOtherModelDoes) {
  EXPECT_THAT(ToTable(Friction()), StartsWith("main_cause: dry friction, at inertia:carriage"));
  EXPECT_THAT(ToTable(Friction()), Not(HasSubstr(Friction().reason)));
  Diagnosis found = Friction();
  found.verdict = Conclusion::kEffectFound;
  found.reason = "it leaves nothing but noise, and no other model adds to it";
  EXPECT_THAT(ToTable(found), HasSubstr("is noise\n  it leaves nothing but noise, and no other model adds to it\n"));
  found.verdict = Conclusion::kUnexplained;
  EXPECT_THAT(ToTable(found), StartsWith("unexplained: no cause is named. Nearest comes: dry friction"));
  EXPECT_THAT(ToTable(found), HasSubstr("\n  it leaves nothing but noise, and no other model adds to it\n"));
}

TEST(ToTable, SaysOnTopOfWhatAModelStood) {
  Diagnosis d = Friction();
  d.considered = {{.name = "torque_ripple",
                   .at = "inertia:motor",
                   .why_not = "too small a share",
                   .on_top_of = "backlash@shaft:k"}};
  EXPECT_THAT(ToTable(d), HasSubstr("on top of backlash@shaft:k: too small a share\n"));
  EXPECT_EQ(ToJson(d)["considered"][0]["on_top_of"], "backlash@shaft:k");
}

}  // namespace
}  // namespace dynoproof::diagnosis
