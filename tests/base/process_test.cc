#include "base/process.h"

#include <gtest/gtest.h>

namespace dynoproof {
namespace {

TEST(RunProgram, GivesWhatItWroteAndHowItEnded) {
  const ProgramEnd end = RunProgram({"sh", "-c", "cat; echo $0; echo fault >&2; exit 3", "a 'word' $HOME"});
  EXPECT_EQ(end.exit, 3);
  EXPECT_EQ(end.out, "a 'word' $HOME\nfault\n");  // the input is empty, words are taken as they are
}

TEST(RunProgram, DropsErrorLinesOnDemand) {
  const ProgramEnd end = RunProgram({"sh", "-c", "echo fault >&2; echo good"}, ErrorLines::kDropped);
  EXPECT_EQ(end.exit, 0);
  EXPECT_EQ(end.out, "good\n");
}

TEST(RunProgram, SaysWhichOneIsNotThere) {
  const ProgramEnd end = RunProgram({"no_such_program_of_dynoproof"});
  EXPECT_EQ(end.exit, -1);
  EXPECT_NE(end.out.find("no_such_program_of_dynoproof"), std::string::npos) << end.out;
}

TEST(RunProgram, CountsASignalAsNoExit) { EXPECT_EQ(RunProgram({"sh", "-c", "kill -9 $$"}).exit, -1); }

}  // namespace
}  // namespace dynoproof
