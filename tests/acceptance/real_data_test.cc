// Records that somebody measured: what is missing from a linear model of them, and what its name is worth. They are no
// part of this repository; without them the tests are skipped.
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

namespace fs = std::filesystem;

class SlowRealData : public ::testing::Test {
 protected:
  /// NRMSE of a scenario fitted to a record.
  double Fitted(const std::string& scenario, const std::string& record, const std::string& map,
                const std::string& free) {
    const nlohmann::json result = bench_.Json(
        {"identify", Real(scenario), "--data", record, "--map", Real(map), "--free", free, "--starts", "1"});
    return result["nrmse_after"].get<double>();
  }
  static std::string Real(const std::string& file) { return fs::absolute("tests/real/" + file).string(); }
  static std::string Data(const std::string& file) { return fs::absolute("../shared/data/" + file).string(); }

  Bench bench_;
};

TEST_F(SlowRealData, ASpringThatHardensExplainsTheSilverbox) {
  const std::string record = Data("silverbox/SNLS80mV.mat");
  if (!fs::exists(record)) GTEST_SKIP() << record << " is not here";
  const std::string free =
      "plant.inertia.mass,plant.shaft.spring.stiffness_Nm_per_rad,plant.shaft.spring.damping_Nms_per_rad,"
      "plant.load.offset.T_0_Nm";
  const double linear = Fitted("silverbox.toml", record, "silverbox_multisine.toml", free);
  const double cubic = Fitted("silverbox_cubic.toml", record, "silverbox_multisine.toml", free);
  // Measured: 0.141 and 0.041. What is left is the input between its samples, which nobody recorded.
  EXPECT_GT(linear, 0.12);
  EXPECT_LT(cubic, 0.06);
}

TEST_F(SlowRealData, DryFrictionExplainsMostOfADamper) {
  const std::string record = Data("mr_damper/data_simulation_4.1_MRdamper.mat");
  if (!fs::exists(record)) GTEST_SKIP() << record << " is not here";
  const double linear = Fitted("mr_damper.toml", record, "mr_damper_map.toml", "plant.damping_Ns_per_m");
  const double dry = Fitted("mr_damper_coulomb.toml", record, "mr_damper_map.toml",
                            "plant.damping_Ns_per_m,plant.load.friction.T_c_Nm");
  // Measured: 0.346 and 0.220.
  EXPECT_GT(linear, 0.3);
  EXPECT_LT(dry, 0.24);
}

}  // namespace
}  // namespace dynoproof::test
