// `dynoproof modes` from outside: the fields of the contract and the figures of the thesis' test bed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

TEST(Modes, HaveTheFieldsOfTheContract) {
  const Bench bench;
  const nlohmann::json document = bench.Json({"modes", "line.toml"});
  EXPECT_EQ(document.at("id"), "line");
  ASSERT_EQ(document.at("modes").size(), 3u);
  double before = -1.0;
  for (const nlohmann::json& mode : document.at("modes")) {
    EXPECT_GT(mode.at("frequency_hz").get<double>(), before) << "eigenfrequencies rise";
    before = mode.at("frequency_hz");
    EXPECT_GE(mode.at("damping_ratio").get<double>(), 0.0);
    double energy = 0.0;
    for (const auto& [element, share] : mode.at("energy").items()) energy += share.get<double>();
    EXPECT_NEAR(energy, 1.0, 1e-9) << "kinetic and potential energy together; round-off";
    EXPECT_EQ(mode.at("shape").size(), 3u);
    for (const char* node : {"I1", "I2", "I3"}) EXPECT_TRUE(mode.at("shape").at(node).is_number());
  }
  EXPECT_EQ(document["modes"][0]["frequency_hz"], 0.0) << "the rigid-body mode comes first";
  ASSERT_FALSE(document.at("practical_resonances").empty());
  for (const nlohmann::json& one : document.at("practical_resonances")) {
    EXPECT_TRUE(one.at("frequency_hz").is_number());
    EXPECT_TRUE(one.at("gain").is_number());
  }
  for (const nlohmann::json& one : document.at("zeros")) {
    EXPECT_TRUE(one.at("frequency_hz").is_number());
    EXPECT_TRUE(one.at("damping_ratio").is_number());
  }
}

/// Three masses in closed form: w^2 are the roots of w^4 - w^2 (a + b) + k1 k2 (I1 + I2 + I3)/(I1 I2 I3).
TEST(Modes, AgreeWithTheClosedFormOfThreeMasses) {
  const Bench bench;
  const double i1 = 2.0, i2 = 0.3, i3 = 0.5, k1 = 4.0e5, k2 = 2.5e5;
  const double sum = k1 * (1.0 / i1 + 1.0 / i2) + k2 * (1.0 / i2 + 1.0 / i3);
  const double product = k1 * k2 * (i1 + i2 + i3) / (i1 * i2 * i3);
  const double root = std::sqrt(sum * sum / 4.0 - product);
  const nlohmann::json document = bench.Json({"modes", "line.toml"});
  const auto frequency = [](double square) { return std::sqrt(square) / (2.0 * M_PI); };
  // Round-off: the smaller root loses about one digit in the difference.
  EXPECT_NEAR(document["modes"][1]["frequency_hz"].get<double>(), frequency(sum / 2.0 - root), 1e-9);
  EXPECT_NEAR(document["modes"][2]["frequency_hz"].get<double>(), frequency(sum / 2.0 + root), 1e-9);
}

/// Table A.7 with 70 slices, setup 1. The four figures come from an eigenvalue solution of the printed table outside
/// this program, rounded to 0.1 Hz; the thesis prints an oscillation "close to 600 Hz".
TEST(Modes, OfTheRoadToRigTestBedAreThoseOfTableA7) {
  const Bench bench;
  const nlohmann::json document = bench.Json({"modes", "r2r/soft_rotor_setup_1"});
  EXPECT_EQ(document["id"], "r2r/soft_rotor_setup_1");
  ASSERT_EQ(document["modes"].size(), 72u);  // 70 slices and two flanges
  const double expected[] = {0.0, 605.1, 832.2, 1372.8, 1897.3};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(document["modes"][i]["frequency_hz"].get<double>(), expected[i], 0.1) << i;
  for (std::size_t i = 1; i < 72; ++i) {
    EXPECT_GT(document["modes"][i]["frequency_hz"].get<double>(),
              document["modes"][i - 1]["frequency_hz"].get<double>())
        << i;
  }
  EXPECT_EQ(document["modes"][0]["frequency_hz"], 0.0);
}

/// A heavier device under test lowers every mode that moves it, and none rises (Rayleigh).
TEST(Modes, OfTheFlangesSinkWithTheirInertia) {
  const Bench bench;
  const nlohmann::json light = bench.Json({"modes", "r2r/soft_rotor_setup_1"});
  const nlohmann::json heavy = bench.Json({"modes", "r2r/soft_rotor_setup_1", "--set", "plant.inertia.I5=0.171"});
  const nlohmann::json second = bench.Json({"modes", "r2r/soft_rotor_setup_2"});
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_LT(heavy["modes"][i]["frequency_hz"].get<double>(), light["modes"][i]["frequency_hz"].get<double>()) << i;
    EXPECT_EQ(heavy["modes"][i]["frequency_hz"], second["modes"][i]["frequency_hz"]) << "setup 2 is that change";
  }
}

TEST(Modes, OfWhatHasNoAnalysisAreRefused) {
  const Bench bench;
  std::string text = Bench::kLine;
  const std::size_t at = text.find("[analysis]");
  text.erase(at, text.find("[[check]]") - at);
  bench.Write("line.toml", text);
  const Outcome outcome = bench.Call({"modes", "line.toml"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("[analysis]"));
  EXPECT_EQ(bench.Call({"modes", "r2r/"}).exit, 2) << "one at a time";
}

}  // namespace
}  // namespace dynoproof::test
