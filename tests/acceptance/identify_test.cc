// `dynoproof identify` from outside: a chirp of a line whose numbers are known, and a scenario that is off.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/acceptance/identify_line.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

using Identify = IdentifyLine;

TEST_F(Identify, FindsANumberWithinItsInterval) {
  Record({"plant.inertia.I3=0.55"});
  const nlohmann::json result = Json({"--free", kInertia, "--starts", "2"});
  ExpectInside(result["parameters"][kInertia], 0.55);
  EXPECT_GE(result["converged"], 1);
  EXPECT_NEAR(result["nrmse_after"], 0.01, 0.001);  // the noise
}

TEST_F(Identify, FromFarOffAFreeRunIsLostAndASpectrumIsNot) {
  Record();
  const nlohmann::json lost = Json(FarOff({"--method", "free_run", "--starts", "1"}));
  EXPECT_GT(lost["nrmse_after"], 0.1) << lost.dump(1);
  ExpectFound(Json(FarOff({"--method", "spectrum", "--starts", "8"})), 0.02);
}

// The lower resonance is 1.3 Hz wide: what a record resolves is one over its length.
TEST_F(Identify, AFrequencyResponseFindsWhatIsFarOffWithoutARun) {
  Record({}, 10.0);
  ExpectFound(Json(FarOff({"--method", "response"})), 0.02);
}

TEST_F(Identify, SeveralStartsFindWhatOneDoesNot) {
  Record();
  const nlohmann::json result = Json(FarOff({"--method", "free_run", "--starts", "6"}));
  ExpectFound(result, 0.01);
  ExpectInside(result["parameters"][kInertia], 0.5);
  EXPECT_LT(result["converged"], 6);
}

TEST_F(Identify, WhatOneFactorChangesIsNotToldApart) {
  Record({}, 4.0);
  std::vector<std::string> words = {"--method", "response"};
  for (const char* key : {"plant.inertia.I1", "plant.inertia.I2", "plant.inertia.I3",
                          "plant.shaft.k1.stiffness_Nm_per_rad", "plant.shaft.k2.stiffness_Nm_per_rad",
                          "plant.shaft.k1.damping_Nms_per_rad", "plant.shaft.k2.damping_Nms_per_rad"})
    words.insert(words.end(), {"--free", key});
  // From torque to torque; the speed is no part of the response.
  const nlohmann::json result = Json(words);
  ASSERT_FALSE(result["not_told_apart"].empty()) << result.dump(1);
  EXPECT_TRUE(result["parameters"]["plant.inertia.I1"]["ci95"].is_null()) << result.dump(1);
}

TEST_F(Identify, WhatTheDataDoNotSeeHasNoInterval) {
  Record();
  const nlohmann::json twice =
      Json({"--set", R"(output.T_shaft.sensor=[{type="gain",gain=1.0},{type="gain",gain=1.0}])", "--free",
            "output.T_shaft.sensor.0.gain,output.T_shaft.sensor.1.gain", "--starts", "1"});
  ASSERT_THAT(twice["not_told_apart"], SizeIs(1)) << twice.dump(1);
  for (const auto& [key, value] : twice["parameters"].items()) EXPECT_TRUE(value["ci95"].is_null()) << twice.dump(1);
  EXPECT_TRUE(twice["covariance"][0][0].is_null());
  const nlohmann::json none = Json({"--free", "check.0.nrmse", "--starts", "1"});
  EXPECT_THAT(none["not_told_apart"], SizeIs(1));
  EXPECT_TRUE(none["parameters"]["check.0.nrmse"]["ci95"].is_null()) << none.dump(1);
}

TEST_F(Identify, AResponseIsThatOfTheLineWithoutStages) {
  Record();
  const Outcome outcome = Call({"--set", R"(output.T_shaft.sensor=[{type="first_order_lag",tau_s=0.0005}])", "--free",
                                kInertia, "--method", "response"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("output.T_shaft.sensor is no part"));
}

TEST_F(Identify, AConstantOutputIsNothingToCompare) {
  std::string rows = "t,T_airgap,T_shaft\n";
  for (int i = 0; i < 2000; ++i) rows += std::to_string(1e-4 * i) + "," + std::to_string(i % 7) + ",0\n";
  bench_.Write("record.csv", rows);
  EXPECT_EQ(Call({"--free", kInertia, "--method", "spectrum", "--starts", "1"}).exit, 4);
}

TEST_F(Identify, TheScenarioThatItWritesRunsAsTheFitDid) {
  Record({"plant.inertia.I3=0.55"});
  const nlohmann::json fit = Json({"--free", kInertia + ",output.T_shaft.sensor.0.gain", "--set",
                                   R"(output.T_shaft.sensor=[{type="gain",gain=1.02}])", "--out", "found.toml"});
  ASSERT_EQ(fit["exit"], 0) << fit.dump(1);
  const nlohmann::json again =
      bench_.Json({"identify", "found.toml", "--data", "record.csv", "--free", kInertia, "--starts", "1"});
  EXPECT_NEAR(again["nrmse_before"].get<double>(), fit["nrmse_after"].get<double>(), 1e-9) << again.dump(1);
  EXPECT_EQ(again["parameters"][kInertia]["nominal"], fit["parameters"][kInertia]["value"]);
}

TEST_F(Identify, AnEffectOfTheScenarioActsOnceInWhatItWrites) {
  Record({"plant.inertia.I3=0.55"});
  // Effects that act on what is freed: a number, a list of stages, a part of their own; and one that does not.
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"name = \"inertia_change\"\nat = \"inertia:I3\"\nparameters = { delta = -0.2 }", kInertia},
      {"name = \"sensor_gain\"\nat = \"output:T_shaft\"\nparameters = { g = 1.05 }", "output.T_shaft.sensor.0.gain"},
      {"name = \"coulomb_friction\"\nat = \"inertia:I2\"\nparameters = { T_c = 0.5 }", kInertia}};
  for (const auto& [effect, key] : cases) {
    bench_.Write("with_effect.toml", std::string(Bench::kLine) + "\n[[effect]]\n" + effect + "\n");
    const nlohmann::json fit = bench_.Json({"identify", "with_effect.toml", "--data", "record.csv", "--free", key,
                                            "--starts", "1", "--out", "found.toml"});
    // Far off without a second start: that the fit explains nothing is said, and the file is written all the same.
    ASSERT_EQ(fit["exit"], fit["nrmse_after"].get<double>() > 0.9 ? 4 : 0) << fit.dump(1);
    const nlohmann::json again =
        bench_.Json({"identify", "found.toml", "--data", "record.csv", "--free", key, "--starts", "1"});
    EXPECT_NEAR(again["nrmse_before"].get<double>(), fit["nrmse_after"].get<double>(), 1e-9)
        << effect << ReadBytes(bench_ / "found.toml");
    EXPECT_EQ(again["parameters"][key]["nominal"], fit["parameters"][key]["value"]) << effect;
    EXPECT_EQ(bench_.Call({"validate", "found.toml"}).exit, 0);
  }
}

// The file that is included has none of what --set tries: it was told to leave that out, and could not be read.
TEST_F(Identify, WhatSetTriesIsInTheFileThatItWrites) {
  Record({"plant.inertia.I3=0.55"});
  const std::string gain = R"({name="sensor_gain",at="output:T_shaft",parameters={g=1.05}})",
                    change = R"({name="inertia_change",at="inertia:I3",parameters={delta=-0.2}})";
  bench_.Write("with_effect.toml", std::string(Bench::kLine) +
                                       "\n[[effect]]\nname = \"inertia_change\"\nat = \"inertia:I2\"\n" +
                                       "parameters = { delta = 0.1 }\n");
  for (const std::string scenario : {"line.toml", "with_effect.toml"}) {
    for (const std::string& effects : {"[" + gain + "]", "[" + gain + "," + change + "]"}) {
      const nlohmann::json fit =
          bench_.Json({"identify", scenario, "--set", "effect=" + effects, "--data", "record.csv", "--free", kInertia,
                       "--starts", "1", "--out", "found.toml"});
      ASSERT_EQ(fit["exit"], 0) << fit.dump(1);
      const nlohmann::json again =
          bench_.Json({"identify", "found.toml", "--data", "record.csv", "--free", kInertia, "--starts", "1"});
      ASSERT_TRUE(again.contains("nrmse_before")) << again.dump(1) << ReadBytes(bench_ / "found.toml");
      EXPECT_NEAR(again["nrmse_before"].get<double>(), fit["nrmse_after"].get<double>(), 1e-9)
          << scenario << effects << ReadBytes(bench_ / "found.toml");
    }
  }
}

TEST_F(Identify, FreesANumberThatIsLeftToItsDefault) {
  Record();
  std::string text = Bench::kLine;
  text.replace(text.find("[plant.shaft.k2]"), 16, "[plant.shaft.k2]\nlaw = \"spring_damper\"");
  text.replace(text.find("damping_Nms_per_rad = 6.0\n"), 26, "");
  bench_.Write("short.toml", text);
  const std::string damping = "plant.shaft.k2.damping_Nms_per_rad";
  const nlohmann::json fit = bench_.Json({"identify", "short.toml", "--data", "record.csv", "--free", damping,
                                          "--bound", damping + "=1:20", "--out", "found.toml"});
  ASSERT_EQ(fit["exit"], 0) << fit.dump(1);
  EXPECT_EQ(fit["parameters"][damping]["nominal"], 0.0);
  ExpectInside(fit["parameters"][damping], 6.0);
  EXPECT_EQ(bench_.Call({"identify", "found.toml", "--data", "record.csv", "--free", damping}).exit, 0);
  // A default of 0 gives no place to start from, and a name that is none gets the one that was meant.
  const Outcome zero = bench_.Call({"identify", "short.toml", "--data", "record.csv", "--free", damping});
  EXPECT_EQ(zero.exit, 2);
  EXPECT_THAT(zero.err, HasSubstr("--bound " + damping + "=LOW:HIGH"));
  const Outcome typo =
      bench_.Call({"identify", "short.toml", "--data", "record.csv", "--free", "plant.shaft.k2.dampng_Nms_per_rad"});
  EXPECT_EQ(typo.exit, 2);
  EXPECT_THAT(typo.err, HasSubstr("did you mean \"" + damping + "\"?"));
}

TEST_F(Identify, FaultsOfTheCallAreAllNamed) {
  Record();
  const std::string damping = "plant.shaft.k1.damping_Nms_per_rad";
  const Outcome outcome =
      Call({"--free", "plant.inertia.I9,plant.inertia.I2," + damping, "--free", kStiffness + "," + kStiffness, "--set",
            damping + "=0", "--bound", "plant.inertia.I2=2:1", "--bound", "plant.inertia.I2=1:2", "--bound",
            "plant.inertia.I2=1:2", "--bound", "plant.inertia.I3=1:2", "--set",
            R"(input.T_airgap.source={type="constant",value=1.0})", "--out", "line.toml"});
  EXPECT_EQ(outcome.exit, 2);
  for (const std::string& says :
       {std::string("\"plant.inertia.I9\" is no number"), std::string("is 0: it gives no magnitude"),
        std::string("\"plant.inertia.I2=2:1\" gives no bounds"), std::string("\"plant.inertia.I2\" has bounds already"),
        std::string("\"plant.inertia.I3\" is none of the --free"), "\"" + kStiffness + "\" stands there twice",
        std::string("replaces a table"), std::string("is there already, and not from identify")})
    EXPECT_THAT(outcome.err, HasSubstr(says));
}

TEST_F(Identify, WritesOverNothingButItsOwn) {
  Record();
  const std::string before = ReadBytes(bench_ / "record.csv");
  EXPECT_EQ(Call({"--free", kInertia, "--starts", "1", "--out", "record.csv"}).exit, 2);
  EXPECT_EQ(ReadBytes(bench_ / "record.csv"), before);
  for (int k = 0; k < 2; ++k) EXPECT_EQ(Call({"--free", kInertia, "--starts", "1", "--out", "found.toml"}).exit, 0);
  EXPECT_EQ(bench_
                .Call({"identify", "found.toml", "--data", "record.csv", "--free", kInertia, "--starts", "1", "--out",
                       "found.toml"})
                .exit,
            2);
}

TEST_F(Identify, AResponseNeedsADriveLineWithOne) {
  Record();
  ExpectToNeedAnalysis("response");
}

}  // namespace
}  // namespace dynoproof::test
