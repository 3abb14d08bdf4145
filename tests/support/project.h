// A project of its own for a test: scenarios/ and golden/ under git, with everything committed.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/support/program.h"

namespace dynoproof::test {

class Project : public ::testing::Test {
 protected:
  /// Puts what is there under git; the program then finds its scenarios in scenarios/.
  void Begin() {
    std::filesystem::create_directories(bench_ / "golden");
    bench_.Write("golden/README.md", "golden traces\n");
    Git("init -q .");
    Git("add -A");
    Git("commit -q -m start");
    options_.environment["DYNOPROOF_SCENARIOS"] = (bench_ / "scenarios").string();
  }
  void Git(const std::string& arguments) {
    const Outcome outcome = bench_.Call({"-c", "git -c user.name=t -c user.email=t@example.com " + arguments},
                                        {.environment = {{"GIT_CONFIG_GLOBAL", "/dev/null"}}, .program = "sh"});
    ASSERT_EQ(outcome.exit, 0) << arguments << outcome.Both();
  }

  Bench bench_;
  CallOptions options_;
};

}  // namespace dynoproof::test
