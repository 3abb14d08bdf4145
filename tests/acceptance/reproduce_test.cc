// `reproduce`, from outside: the thesis, an independent value and ours side by side, and the standings counted apart.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kStandings[] = {"reproduced",   "reproduced_assumed", "derived",
                                      "contradicted", "misprint",           "not_checkable"};

TEST(Reproduce, AllStandsAsTheLedgerSaysAndTheStandingsAreCountedApart) {
  const Bench bench;
  const Outcome run = bench.Call({"reproduce", "all", "--json", "claims.json"});
  EXPECT_EQ(run.exit, 0) << run.Both();
  const nlohmann::json document = nlohmann::json::parse(ReadBytes(bench / "claims.json"));
  EXPECT_EQ(document["exit"], 0);
  std::map<std::string, int> counts;
  for (const nlohmann::json& claim : document["claims"]) {
    const std::string standing = claim["standing"], id = claim["id"];
    ++counts[standing];
    EXPECT_EQ(claim["as_expected"], true) << id;
    for (const char* field : {"thesis", "independent", "ours", "allowed", "at_least", "at_most", "deviation", "unit",
                              "origin", "assumed", "explanation", "place"}) {
      EXPECT_TRUE(claim.contains(field)) << id << " " << field;
    }
    EXPECT_EQ(claim["ours"].is_null(), standing == "not_checkable") << id;
    if (standing == "reproduced") {
      EXPECT_TRUE(claim["thesis"].is_number() && claim["assumed"].is_null()) << id;
    } else if (standing == "reproduced_assumed") {
      EXPECT_TRUE(claim["assumed"].is_string()) << id;
    } else if (standing == "derived") {
      EXPECT_TRUE(claim["thesis"].is_null() && claim["independent"].is_number()) << id;
    }
  }
  const nlohmann::json& summary = document["summary"];
  for (const char* standing : kStandings) {
    EXPECT_GT(counts[standing], 0) << standing;
    EXPECT_EQ(summary[standing], counts[standing]) << standing;
  }
  EXPECT_EQ(summary["faults"], 0);
  EXPECT_EQ(summary["otherwise_than_expected"], 0);
  const std::string claims = "of " + std::to_string(document["claims"].size()) + " claims: ";
  const std::string line = std::to_string(counts["reproduced"]) + " reproduced, " +
                           std::to_string(counts["reproduced_assumed"]) + " reproduced with assumed data, " +
                           std::to_string(counts["derived"]) + " derived, " + std::to_string(counts["contradicted"]) +
                           " contradicted, " + std::to_string(counts["misprint"]) + " misprint, " +
                           std::to_string(counts["not_checkable"]) + " not checkable";
  EXPECT_THAT(run.out, HasSubstr(line));
  // The page says the same; ci/claims.py writes it.
  EXPECT_THAT(ReadBytes("tests/README.md"), HasSubstr(claims + line));
}

TEST(Reproduce, OneClaimShowsWhatThePrintSaysAnotherMethodAndTheTolerance) {
  const Bench bench;
  const Outcome run = bench.Call({"reproduce", "B.1-formula"});
  EXPECT_EQ(run.exit, 0) << run.Both();
  for (const char* text : {"thesis says", "independent", "ours", "allowed", "deviation", "standing", "269.1", "269.032",
                           "+-0.05", "-0.068", "contradicted", "half a unit"}) {
    EXPECT_THAT(run.out, HasSubstr(text));
  }
  const nlohmann::json document = bench.Json({"reproduce", "B.1-formula"});
  ASSERT_EQ(document["claims"].size(), 1u);
  EXPECT_EQ(document["claims"][0]["thesis"], 269.1);
  EXPECT_EQ(document["claims"][0]["standing"], "contradicted");
  EXPECT_EQ(document["summary"]["contradicted"], 1);
}

/// 390.8 Hz stands nowhere in the thesis.
TEST(Reproduce, WhatTheThesisDoesNotPrintIsNotSaidToBePrinted) {
  const Bench bench;
  const nlohmann::json claim = bench.Json({"reproduce", "A.1-mode-1"})["claims"][0];
  EXPECT_TRUE(claim["thesis"].is_null());
  EXPECT_EQ(claim["standing"], "derived");
  EXPECT_NEAR(claim["independent"].get<double>(), 390.832, 1e-9);
}

TEST(Reproduce, CoverageShowsEveryRowWithItsStateAndReason) {
  const Bench bench;
  const Outcome run = bench.Call({"reproduce", "--coverage", "--json", "coverage.json"});
  EXPECT_EQ(run.exit, 0) << run.Both();
  const nlohmann::json document = nlohmann::json::parse(ReadBytes(bench / "coverage.json"));
  std::map<std::string, int> counts;
  for (const nlohmann::json& row : document["rows"]) {
    const std::string state = row["state"], name = row["name"];
    ++counts[state];
    EXPECT_THAT(run.out, HasSubstr(name));
    EXPECT_EQ(row["reason"].is_null(), state == "whole") << name;
  }
  for (const char* state : {"whole", "assumed", "partial", "not_given"}) {
    EXPECT_GT(counts[state], 0) << state;
    EXPECT_EQ(document["summary"]["all"][state], counts[state]) << state;
  }
  EXPECT_EQ(document["summary"]["all"]["missing"], 0);
  EXPECT_THAT(run.out, HasSubstr("experiment"));
  EXPECT_EQ(bench.Call({"reproduce", "all", "--coverage"}).exit, 2);
}

TEST(Reproduce, AnUnknownClaimIsAnsweredWithTheNearest) {
  const Bench bench;
  const Outcome run = bench.Call({"reproduce", "B.1-formla"});
  EXPECT_EQ(run.exit, 2) << run.Both();
  EXPECT_THAT(run.err, HasSubstr("did you mean \"B.1-formula\"?"));
}

}  // namespace
}  // namespace dynoproof::test
