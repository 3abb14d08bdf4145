// A record of a line whose numbers are known, for `dynoproof identify` from outside.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/noisy_record.h"
#include "tests/support/program.h"
#include "trace/csv_write.h"

namespace dynoproof::test {

class IdentifyLine : public ::testing::Test {
 protected:
  /// Of line.toml with `changes`, from 0 to 400 Hz in `seconds`; noise of 1 % of what it swings on the outputs.
  void Record(const std::vector<std::string>& changes = {}, double seconds = 1.0) {
    std::vector<std::string> run = {"line.toml", "--set", "run.duration_s=" + std::to_string(seconds), "--set",
                                    "input.T_airgap.source.rate_Hz_per_s=" + std::to_string(400.0 / seconds)};
    for (const std::string& change : changes) run.insert(run.end(), {"--set", change});
    const std::vector<trace::Column> columns =
        NoisyRecord(bench_, run, "out/line.h5", {"T_airgap"}, {"T_shaft", "omega_1"});
    ASSERT_FALSE(trace::WriteCsv(bench_ / "record.csv", columns));
  }
  std::vector<std::string> Words(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"identify", "line.toml", "--data", "record.csv", "--set", "analysis.to_Hz=390"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Outcome Call(const std::vector<std::string>& more) const { return bench_.Call(Words(more)); }
  nlohmann::json Json(const std::vector<std::string>& more) const { return bench_.Json(Words(more)); }
  /// `method` needs the frequency response of [analysis], which the line has lost here.
  void ExpectToNeedAnalysis(const std::string& method) {
    std::string text = Bench::kLine;
    text.replace(text.find("[analysis]"), text.find("[[check]]") - text.find("[analysis]"), "");
    bench_.Write("without.toml", text);
    const Outcome outcome =
        bench_.Call({"identify", "without.toml", "--data", "record.csv", "--free", kInertia, "--method", method});
    EXPECT_EQ(outcome.exit, 2);
    EXPECT_THAT(outcome.err, ::testing::HasSubstr("needs [analysis]"));
  }
  /// The last shaft and its inertia, wherever they lie: what the search starts from is a third of the truth, or three
  /// times it. The record's angular speed fixes the size of all.
  std::vector<std::string> FarOff(std::vector<std::string> more) const {
    more.insert(more.end(), {"--free", kInertia, "--free", kStiffness, "--bound", kInertia + "=0.01:10", "--bound",
                             kStiffness + "=1e4:1e7", "--set", kInertia + "=1.5", "--set", kStiffness + "=8e4"});
    return more;
  }
  static void ExpectFound(const nlohmann::json& result, double within) {
    EXPECT_NEAR(result["parameters"][kInertia]["value"].get<double>(), 0.5, 0.5 * within) << result.dump(1);
    EXPECT_NEAR(result["parameters"][kStiffness]["value"].get<double>(), 2.5e5, 2.5e5 * within);
  }
  static void ExpectInside(const nlohmann::json& found, double value) {
    ASSERT_FALSE(found["ci95"].is_null()) << found.dump();
    EXPECT_LT(found["ci95"][0], value) << found.dump();
    EXPECT_GT(found["ci95"][1], value) << found.dump();
  }

  static inline const std::string kInertia = "plant.inertia.I3", kStiffness = "plant.shaft.k2.stiffness_Nm_per_rad";
  Bench bench_;
};

}  // namespace dynoproof::test
