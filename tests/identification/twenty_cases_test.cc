// Twenty made cases over all scenarios of the diagnosis, friction and play among them: numbers that are 12 % to a decade
// off come back.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "identification/identify.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::identification {
namespace {

struct Case {
  std::string scenario;
  double duration_s;
  std::vector<std::string> outputs;
  std::vector<std::pair<std::string, double>> off;  // numbers, and what the search begins at over the truth
  std::string friction_at = {};  // a body with dry friction of `friction_Nm`, which the search begins with a tenth of
  double friction_Nm = 0.0;
};

const std::vector<std::string> kShaft = {"T_shaft", "omega_1"}, kCoupling = {"T", "omega_d"}, kAir = {"p_ch", "p_s"},
                               kBed = {"omega_1", "omega_2", "omega_3", "T_m1", "T_m2"};
const std::string kK3 = "plant.shaft.k3.stiffness_Nm_per_rad", kK4 = "plant.shaft.k4.stiffness_Nm_per_rad";

std::vector<Case> Cases() {
  return {
      {"r2r_soft", 1.0, kShaft, {{kK3, 1.12}}},
      {"r2r_soft", 1.0, kShaft, {{kK4, 0.75}, {"plant.inertia.I5", 1.12}}},
      {"r2r_soft", 1.0, kShaft, {{"plant.inertia.I4", 0.5}, {"plant.rotor.I1.stiffness_Nm_per_rad", 1.12}}},
      {"r2r_soft", 1.0, kShaft, {{kK3, 1.12}, {"plant.shaft.k4.damping_Nms_per_rad", 10.0}}},
      {"r2r_soft", 1.0, kShaft, {}, "I5", 10.0},
      {"heavy_duty_soft", 1.0, kShaft, {{kK3, 0.88}}},
      {"heavy_duty_soft", 1.0, kShaft, {{kK4, 1.25}, {"plant.inertia.I5", 0.88}}},
      {"heavy_duty_soft", 1.0, kShaft, {{"plant.rotor.I1.stiffness_Nm_per_rad", 1.12}, {"plant.inertia.I4", 0.88}}},
      {"heavy_duty_lumped", 1.0, kShaft, {{kK3, 1.12}, {kK4, 0.88}}},
      {"heavy_duty_lumped", 1.0, kShaft, {{"plant.inertia.I4", 10.0}}},
      {"heavy_duty_lumped", 1.0, kShaft, {}, "I4", 40.0},
      {"coupling", 2.0, kCoupling, {{"plant.shaft.coupling.stiffness_Nm_per_rad", 10.0}}},
      {"coupling",
       2.0,
       kCoupling,
       {{"plant.shaft.coupling.stiffness_Nm_per_rad", 0.88}, {"plant.shaft.coupling.damping_Nms_per_rad", 0.1}}},
      {"charge_air", 60.0, kAir, {{"plant.volume.V_1.volume_m3", 10.0}, {"plant.volume.V_2.volume_m3", 0.88}}},
      {"charge_air", 60.0, kAir, {{"plant.flap.1.area_span_m2", 0.5}, {"plant.flap.2.area_span_m2", 1.12}}},
      {"fuel_gas", 0.0, {"p_g"}, {{"plant.volume.V.volume_m3", 10.0}}},
      {"fuel_gas", 0.0, {"p_g"}, {{"plant.valve.v_g.area_slope_m", 0.5}, {"plant.volume.V.volume_m3", 1.12}}},
      {"backlash", 0.4, kBed, {{"plant.shaft.backlash.half_gap_rad", 0.88}}},
      {"backlash", 0.4, kBed, {{"plant.shaft.k6.stiffness_Nm_per_rad", 1.12}, {"plant.inertia.I7", 0.88}}},
      {"backlash", 0.4, kBed, {{"plant.shaft.backlash.half_gap_rad", 0.3}}},
  };
}

/// Each is a test of its own, so that they run side by side.
class TwentyCases : public ::testing::TestWithParam<int> {
 protected:
  void ComesBack() const;
};

void TwentyCases::ComesBack() const {
  const Case one = Cases()[static_cast<std::size_t>(GetParam())];
  std::vector<std::string> changes;
  if (one.duration_s > 0.0) changes.push_back("run.duration_s=" + std::to_string(one.duration_s));
  Plan truth = estimation::Scenario("scenarios/diagnose/" + one.scenario + ".toml", changes);
  Plan nominal = truth;
  std::vector<FreeKey> free;
  for (const auto& [key, factor] : one.off) {
    Value* value = nominal.root.FindPath(key);
    ASSERT_NE(value, nullptr) << key;
    *value = Value(value->number() * factor);
    free.push_back({key, std::pair(value->number() / factor / 20.0, value->number() / factor * 20.0)});
  }
  if (!one.friction_at.empty()) {
    const auto with = [&](Plan& plan, double torque) {
      plan.root["plant"]["load"]["rubs"] = Value{{"on", one.friction_at}, {"law", "coulomb"}, {"T_c_Nm", torque}};
    };
    with(truth, one.friction_Nm);
    with(nominal, 0.1 * one.friction_Nm);
    SetSubsteps(truth, 16);
    free.push_back({"plant.load.rubs.T_c_Nm", std::pair(0.01 * one.friction_Nm, 20.0 * one.friction_Nm)});
  }
  const auto seed = static_cast<std::uint64_t>(GetParam() + 1);
  const MappedRecord record = estimation::RecordOf(truth, 0.005, one.outputs, seed);
  const Result<Identified> found = Identify(nominal, {record}, testing::BuiltIns(), {free, "corrected"});
  ASSERT_TRUE(found.ok()) << found.failure().ToString();
  for (const IdentifiedValue& value : found->values) {
    EXPECT_NEAR(value.value / truth.root.FindPath(value.key)->number(), 1.0, 0.03) << value.key;
  }
  EXPECT_LT(found->level->simulations, 2000);
}

std::string NameOf(const ::testing::TestParamInfo<int>& tested) {
  return Cases()[static_cast<std::size_t>(tested.param)].scenario + "_" + std::to_string(tested.param + 1);
}

class SlowTwentyCases : public TwentyCases {};
TEST_P(SlowTwentyCases, ComeBack) { ComesBack(); }
INSTANTIATE_TEST_SUITE_P(, SlowTwentyCases, ::testing::Values(0, 2, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 19),
                         NameOf);

/// Four of them take as long as all others: soft rotors and the backlash bed.
class NightlyTwentyCases : public TwentyCases {};
TEST_P(NightlyTwentyCases, ComeBack) { ComesBack(); }
INSTANTIATE_TEST_SUITE_P(, NightlyTwentyCases, ::testing::Values(1, 3, 17, 18), NameOf);

}  // namespace
}  // namespace dynoproof::identification
