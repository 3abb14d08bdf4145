#include "diagnosis/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dynoproof::diagnosis {
namespace {

using ::testing::HasSubstr;

VerdictEvidence Found() {
  VerdictEvidence evidence;
  evidence.best = "viscous_friction@inertia:I5";
  evidence.alike = 1;
  evidence.holdout_gains = true;
  return evidence;
}

TEST(VerdictTable, NothingSignificantAndNothingLeftIsNoEffect) {
  EXPECT_EQ(VerdictOf({}).verdict, Verdict::kNoEffect);
  VerdictEvidence evidence;
  evidence.holdout_gains = false;  // there is nothing that could gain
  EXPECT_EQ(VerdictOf(evidence).verdict, Verdict::kNoEffect);
}

TEST(VerdictTable, WithoutACandidateStructureOrStrainedValuesContradictTheModel) {
  VerdictEvidence structure;
  structure.structure = true;
  structure.found = "T_shaft has a line at 97.4 Hz";
  EXPECT_EQ(VerdictOf(structure).verdict, Verdict::kUnexplained);
  EXPECT_THAT(VerdictOf(structure).reason, HasSubstr("97.4 Hz"));
  VerdictEvidence strained;
  strained.strained = {"nominal_value@plant.preload_N"};
  EXPECT_EQ(VerdictOf(strained).verdict, Verdict::kUnexplained);
  EXPECT_THAT(VerdictOf(strained).reason, HasSubstr("plant.preload_N"));
  VerdictEvidence deviation;
  deviation.null_deviation = 3.9;
  EXPECT_EQ(VerdictOf(deviation).verdict, Verdict::kNoEffect);
  deviation.null_deviation = 4.0;
  EXPECT_EQ(VerdictOf(deviation).verdict, Verdict::kUnexplained);
}

TEST(VerdictTable, OneCandidateAtTheNoiseIsTheEffect) {
  EXPECT_EQ(VerdictOf(Found()).verdict, Verdict::kEffectFound);
  VerdictEvidence unopened = Found();
  unopened.holdout_gains.reset();
  EXPECT_EQ(VerdictOf(unopened).verdict, Verdict::kEffectFound);
}

TEST(VerdictTable, TwoOrThreeAlikeAreASetAndFourAreNone) {
  VerdictEvidence evidence = Found();
  for (evidence.alike = 2; evidence.alike <= 3; ++evidence.alike)
    EXPECT_EQ(VerdictOf(evidence).verdict, Verdict::kAmbiguous) << evidence.alike;
  EXPECT_EQ(VerdictOf(evidence).verdict, Verdict::kUnexplained);
  EXPECT_THAT(VerdictOf(evidence).reason, HasSubstr("4 candidates"));
}

TEST(VerdictTable, WhatSpeaksAgainstTheBestCandidateMakesItUnexplained) {
  VerdictEvidence structure = Found(), deviation = Found(), holdout = Found();
  structure.structure = true;
  structure.pairs = "no pair of effects accounts for the rest either";
  deviation.deviation = 3.6;
  holdout.holdout_gains = false;
  EXPECT_EQ(VerdictOf(structure).verdict, Verdict::kUnexplained);
  EXPECT_THAT(VerdictOf(structure).reason, HasSubstr("no pair of effects"));
  EXPECT_EQ(VerdictOf(deviation).verdict, Verdict::kUnexplained);
  EXPECT_THAT(VerdictOf(deviation).reason, HasSubstr("3.6 prior standard deviations"));
  EXPECT_EQ(VerdictOf(holdout).verdict, Verdict::kUnexplained);
  EXPECT_THAT(VerdictOf(holdout).reason, HasSubstr("hold-out"));
  holdout.alike = 2;
  EXPECT_EQ(VerdictOf(holdout).verdict, Verdict::kUnexplained) << "a set that does not gain is none";
}

// The covariance had passed an effect whose printed interval was [0, 4.4 ms].
TEST(VerdictTable, AnIntervalThatIncludesNothingNamesNothing) {
  VerdictEvidence found = Found();
  found.includes_neutral = true;
  EXPECT_EQ(VerdictOf(found).verdict, Verdict::kUnexplained);
  EXPECT_THAT(VerdictOf(found).reason, HasSubstr("includes that there is none of it"));
  found.alike = 2;
  EXPECT_EQ(VerdictOf(found).verdict, Verdict::kUnexplained) << "nor does a set";
}

TEST(VerdictTable, ADeviationThatIsNoNumberIsBeyondThePrior) {
  VerdictEvidence nothing, found = Found();
  nothing.null_deviation = std::nan("");
  found.deviation = std::nan("");
  EXPECT_EQ(VerdictOf(nothing).verdict, Verdict::kUnexplained);
  EXPECT_EQ(VerdictOf(found).verdict, Verdict::kUnexplained);
}

TEST(VerdictTable, NamesItsRow) {
  EXPECT_EQ(VerdictOf(Found()).rule, "one candidate, noise alone in its residual");
  EXPECT_EQ(VerdictOf({}).rule, "no significant candidate, noise alone in the residual");
}

}  // namespace
}  // namespace dynoproof::diagnosis
