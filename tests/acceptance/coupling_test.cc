// Hydrodynamic couplings from outside: the command `coupling`, and effects on diagnose/coupling against the oracle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;

TEST(Coupling, ChoosesThePrintedMode) {
  const Bench bench;
  const nlohmann::json document = bench.Json({"coupling", "diagnose/coupling", "--static-stiffness", "94e3"});
  // Printed 73.3 rad/s; independently computed 73.25.
  EXPECT_NEAR(document.at("nu_0").get<double>(), 73.25, 0.01);
  EXPECT_EQ(document.at("modes").size(), 104u);
  EXPECT_GT(document["modes"][0]["share"].get<double>(), 0.9);
}

TEST(Coupling, FitsADataSheetAndShowsTheResiduals) {
  const Bench bench;
  // k = 1e5 + 2e5 nu^2/(nu^2 + 1e4), c = 2e7/(nu^2 + 1e4).
  bench.Write("sheet.csv", "nu,k,c\nrad/s,kN m/rad,N m s/rad\n0,100,2000\n50,140,1600\n100,200,1000\n200,260,400\n");
  const nlohmann::json document = bench.Json({"coupling", "diagnose/coupling", "--data", "sheet.csv"});
  EXPECT_NEAR(document.at("fit").at("k_s").at("value").get<double>(), 1e5, 1e-3);
  EXPECT_NEAR(document["fit"]["K"]["value"].get<double>(), 2e5, 1e-3);
  EXPECT_NEAR(document["fit"]["kappa_p"]["value"].get<double>(), 100.0, 1e-6);
  EXPECT_EQ(document["static_stiffness"], 1e5);
  // k and c of the sheet at nu_0 = 75.5 rad/s, between its rows.
  const double nu = document["nu_0"].get<double>();
  EXPECT_NEAR(document["c_KV"].get<double>(), 1600.0 - 600.0 * (nu - 50.0) / 50.0, 1e-6);
  for (const nlohmann::json& row : document.at("curves")) {
    EXPECT_NEAR(row.at("residual").at("k").get<double>(), 0.0, 1e-9);
    EXPECT_EQ(row.at("scenario").at("c"), 618.0);
  }
}

TEST(Coupling, SaysWhatIsWrong) {
  const Bench bench;
  bench.Write("sheet.csv", "nu,k\n0,100\n");
  const Outcome sheet = bench.Call({"coupling", "diagnose/coupling", "--data", "sheet.csv"});
  EXPECT_EQ(sheet.exit, 2);
  EXPECT_THAT(sheet.err, HasSubstr("no column \"c\""));
  const Outcome shaft = bench.Call({"coupling", "diagnose/coupling", "--shaft", "k9"});
  EXPECT_EQ(shaft.exit, 2);
  EXPECT_THAT(shaft.err, HasSubstr("no shaft \"k9\""));
  EXPECT_EQ(bench.Call({"coupling", "diagnose/coupling", "--data", "none.csv"}).exit, 2);
}

/// The engine's torque is a signal of a continuous part: held over a period it came half of one late, 0.5 % of the flange's torque.
TEST(Coupling, ItsOwnTraceDrivesAnEngineAsItWas) {
  const Bench bench;
  bench.Call({"run", "coupling/idle_oil", "--set", "run.duration_s=0.2", "--out", "own"});
  bench.Call({"run", "coupling/idle_oil", "--data", "own/coupling/idle_oil.h5", "--json", "run.json"});
  const nlohmann::json run = nlohmann::json::parse(ReadBytes(bench / "run.json"));
  for (const char* name : {"T.nrmse", "omega_d.nrmse"})
    EXPECT_LT(run["scenarios"][0]["figures"][name]["value"].get<double>(), 1e-4) << name;
}

/// A flap shows its controller's command, of which there is none before the first tick: its first sample, 0, is nobody's.
TEST(ChargeAir, ItsOwnTraceIsThatOfItsControllers) {
  const Bench bench;
  bench.Call({"run", "pressure/charge_air_saturated", "--out", "own"});
  const std::string trace = "own/pressure/charge_air_saturated.h5";
  bench.Call({"run", "pressure/charge_air_saturated", "--data", trace, "--json", "run.json"});
  const nlohmann::json run = nlohmann::json::parse(ReadBytes(bench / "run.json"));
  for (const char* name : {"flap_1.nrmse", "flap_2.nrmse", "p_ch.nrmse", "p_s_ref.nrmse"})
    EXPECT_LT(run["scenarios"][0]["figures"][name]["value"].get<double>(), 1e-9) << name;
  EXPECT_EQ(bench.Json({"diagnose", "pressure/charge_air_saturated", "--data", trace})["verdict"], "no_effect");
}

/// The scenario for diagnosis with the oil's dynamics as hidden truth: solver, second solver and oracle still agree.
TEST(Coupling, OilDynamicsHoldAgainstTheOracle) {
  const Bench bench;
  const std::string base = (std::filesystem::current_path() / "scenarios/diagnose/coupling.toml").string();
  bench.Write("truth.toml", "include = [\"" + base + R"("]
[run]
duration_s = 0.2

[[effect]]
name = "oil_dynamics"
at = "shaft:coupling"
parameters = { k_s = 78e3, kappa_p = 190.0, k_p_kappa_w = 154e3 }
)");
  const nlohmann::json document = bench.Json({"run", "truth.toml"});
  ASSERT_EQ(document.at("scenarios").size(), 1u);
  EXPECT_EQ(document["scenarios"][0]["verdict"], "pass") << document.dump(2);
  EXPECT_EQ(document["scenarios"][0]["checks"].size(),
            4u);  // T and omega_d, each against the oracle and the other solver
}

}  // namespace
}  // namespace dynoproof::test
