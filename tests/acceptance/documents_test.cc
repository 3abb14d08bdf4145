// The documents of probe, reduce and bisect are what their published schemas describe.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/json_schema.h"
#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

using ::testing::IsEmpty;

JsonSchema Published(const std::string& name) {
  return JsonSchema(nlohmann::json::parse(ReadBytes("reports/" + name + ".schema.json")));
}

/// The document of a call is what the schema says; with a key too many or too few it is not.
void ExpectDescribed(const std::string& schema, const nlohmann::json& document, const std::string& needed) {
  const JsonSchema published = Published(schema);
  EXPECT_THAT(published.Faults(document), IsEmpty()) << document.dump(1);
  nlohmann::json wrong = document;
  wrong["surprise"] = 1;
  wrong[needed] = true;
  EXPECT_EQ(published.Faults(wrong).size(), 2u);
}

/// The line with a check that does not follow the plan: where its resonance lies.
std::string WithPeak(const std::string& between_Hz) {
  std::string text = Bench::kLine;
  return text.substr(0, text.find("[[check]]")) +
         "[[check]]\nkind = \"peak\"\nsignal = \"T_shaft\"\nfigure = \"f\"\nband_Hz = [20.0, 400.0]\nbetween_Hz = " +
         between_Hz + "\norigin = \"made up\"\n";
}

TEST(Documents, OfProbeAreAsPublished) {
  const Bench bench;
  bench.Write("line.toml", WithPeak("[20.0, 400.0]"));
  const nlohmann::json probed =
      bench.Json({"probe", "line.toml", "--effects", "sensor_offset,stiffness_change,turned_sign", "--see",
                  "stiffness_change=5%", "--see", "turned_sign"});
  ASSERT_TRUE(probed.contains("limits") && !probed.at("limits").empty()) << probed.dump(1);
  ASSERT_EQ(probed.at("demands").size(), 2u);
  ExpectDescribed("probe", probed, "limits");
}

TEST(Documents, OfReduceAreAsPublished) {
  const Bench bench;
  bench.Write("line.toml", WithPeak("[399.0, 400.0]"));
  const nlohmann::json reduced = bench.Json({"reduce", "line.toml", "--check", "peak", "--most-runs", "12"});
  ASSERT_TRUE(reduced.contains("steps") && !reduced.at("steps").empty()) << reduced.dump(1);
  ExpectDescribed("reduce", reduced, "lines");
}

TEST(Documents, OfBisectAreAsPublished) {
  const Bench bench;
  const auto shell = [&](const std::string& command) {
    ASSERT_EQ(std::system(("cd '" + bench.path().string() + "' && " + command + " >/dev/null 2>&1").c_str()), 0)
        << command;
  };
  const std::string commit =
      "git add line.toml && git -c user.name=test -c user.email=test@example.org -c commit.gpgsign=false commit -m ";
  shell("git init -q && " + commit + "First");
  std::string text = Bench::kLine;
  text.replace(text.find("I3 = 0.5"), 8, "I3 = 0.6");
  bench.Write("line.toml", text);
  shell(commit + "Second");
  const nlohmann::json found = bench.Json({"bisect", "line.toml", "--good", "HEAD~1"});
  ASSERT_TRUE(found.contains("first")) << found.dump(1);
  EXPECT_EQ(found.at("first").at("subject"), "Second");
  ExpectDescribed("bisect", found, "first");
}

TEST(Documents, OfACallThatFailsAreAsPublishedToo) {
  const Bench bench;
  for (const char* command : {"probe", "reduce"}) {
    const nlohmann::json document = bench.Json({command, "nobody.toml"});
    EXPECT_EQ(document.at("exit"), 2);
    EXPECT_THAT(Published(command).Faults(document), IsEmpty()) << document.dump(1);
  }
}

}  // namespace
}  // namespace dynoproof::test
