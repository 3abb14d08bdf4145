// The oracle proves itself: closed forms of held inputs, and refusal of what it does not know.
#include <gtest/gtest.h>

#include <cmath>

#include "oracles/oracle.h"
#include "tests/support/plan_builder.h"

namespace dynoproof::oracles {
namespace {

using testing::Shaft;

Value TwoMass(double damping) {
  return Value{{"plant", Value{{"type", "drive_line"},
                               {"inertia", Value{{"I1", 2.0}, {"I2", 0.5}}},
                               {"shaft", Value{{"k", Shaft("I1", "I2", 8e5, damping)}}},
                               {"torque", Value{{"T", Value{{"on", "I1"}}}}}}},
               {"input", Value{{"T", Value{{"to", "plant.T"}}}}},
               {"output", Value{{"T_shaft", Value{{"of", "plant.k.torque"}}},
                                {"w1", Value{{"of", "plant.I1.speed"}}},
                                {"phi2", Value{{"of", "plant.I2.angle"}}}}}};
}

std::vector<double> Ticks(std::size_t count) {
  std::vector<double> time(count);
  for (std::size_t i = 0; i < count; ++i) time[i] = 1e-4 * static_cast<double>(i);
  return time;
}

/// A constant torque T on I1 at rest: T_shaft = T I2/(I1 + I2) (1 - cos nu t) without damping.
TEST(HeldInputExponential, StepResponseOfTheUndampedTwoMassLine) {
  const std::vector<double> time = Ticks(2000), torque(2000, 100.0);
  const Value scenario = TwoMass(0.0);
  const Result<Answer> answer = HeldInputExponential({scenario, time, {{"T", torque}}, {"T_shaft", "w1", "phi2"}});
  ASSERT_TRUE(answer.ok()) << answer.failure().ToString();
  const double nu = std::sqrt(8e5 * (1.0 / 2.0 + 1.0 / 0.5)), mean = 100.0 / 2.5;
  for (std::size_t k = 0; k < time.size(); ++k) {
    const double t = time[k], swing = 1.0 - std::cos(nu * t);
    // Round-off: 2000 steps of a recursion whose values reach 40 N m, 8 rad/s, 0.8 rad.
    EXPECT_NEAR(answer->at("T_shaft")[k], 100.0 * 0.5 / 2.5 * swing, 1e-9);
    EXPECT_NEAR(answer->at("w1")[k], mean * t + 100.0 / 2.0 * 0.5 / 2.5 * std::sin(nu * t) / nu, 1e-10);
    // phi2'' = T_shaft / I2.
    EXPECT_NEAR(answer->at("phi2")[k], 100.0 / 2.5 * (t * t / 2.0 - swing / (nu * nu)), 1e-10);
  }
}

/// A torque for one tick only: afterwards momentum is kept, and damping ends the twist.
TEST(HeldInputExponential, PulseLeavesItsMomentum) {
  const std::vector<double> time = Ticks(20000);
  std::vector<double> torque(20000, 0.0);
  torque[3] = 50.0;
  const Value scenario = TwoMass(400.0);
  const Result<Answer> answer = HeldInputExponential({scenario, time, {{"T", torque}}, {"T_shaft", "w1", "phi2"}});
  ASSERT_TRUE(answer.ok());
  EXPECT_EQ(answer->at("w1")[3], 0.0);
  EXPECT_NEAR(answer->at("w1")[4], 50.0 * 1e-4 / 2.0, 1e-4);  // the shaft takes 2 % of it within the tick
  EXPECT_NEAR(answer->at("w1").back(), 50.0 * 1e-4 / 2.5, 1e-13);
  EXPECT_NEAR(answer->at("T_shaft").back(), 0.0, 1e-9);
}

/// Oil that flows at once is a damper, closed-in oil a spring: the two ends between which the oracle must lie. And the
/// torque that oil holds back must fade: a lasting torque is carried by the spring alone.
TEST(HeldInputExponential, CouplingsEndInSpringsAndDampers) {
  const std::vector<double> time = Ticks(5000), torque(5000, 100.0);
  const auto solve = [&](const Value& shaft) {
    Value scenario = TwoMass(0.0);
    scenario["plant"]["shaft"]["k"] = shaft;
    const Result<Answer> answer = HeldInputExponential({scenario, time, {{"T", torque}}, {"T_shaft"}});
    EXPECT_TRUE(answer.ok());
    return answer.ok() ? answer->at("T_shaft") : std::vector<double>(5000, NAN);
  };
  const auto oil = [](double kappa, double K) {
    Value shaft = Shaft("I1", "I2", 8e5, 0.0);
    shaft.Erase("damping_Nms_per_rad");
    shaft["law"] = Value("oil_coupling");
    shaft["k_p_m3"] = Value(0.5);
    shaft["kappa_w_Pa_per_rad"] = Value(2.0 * K);
    shaft["kappa_p_per_s"] = Value(kappa);
    return shaft;
  };
  Value kelvin_voigt = Shaft("I1", "I2", 8e5, 100.0);
  kelvin_voigt["law"] = Value("kelvin_voigt");
  const std::vector<double> damper = solve(kelvin_voigt), plain = solve(Shaft("I1", "I2", 8e5, 100.0));
  const std::vector<double> flowing = solve(oil(1e8, 1e10)), spring = solve(Shaft("I1", "I2", 1.1e6, 0.0)),
                            closed = solve(oil(1e-6, 3e5));
  for (std::size_t k = 0; k < time.size(); ++k) {
    ASSERT_EQ(damper[k], plain[k]);
    ASSERT_NEAR(flowing[k], damper[k], 40.0 * 1e-4);  // nu / kappa_p = 1400 / 1e8, times some
    ASSERT_NEAR(closed[k], spring[k], 40.0 * 1e-5);   // kappa_p t = 5e-7, times the phase that it turns: 700 rad
  }
  EXPECT_NEAR(solve(oil(2000.0, 3e5)).back(), 100.0 * 0.5 / 2.5, 1e-6);
}

TEST(HeldInputExponential, RefusesWhatItDoesNotKnow) {
  const std::vector<double> time = Ticks(10), torque(10, 1.0);
  const auto refusal = [&](const Value& scenario, const char* output) -> std::string {
    const Result<Answer> answer = HeldInputExponential({scenario, time, {{"T", torque}}, {output}});
    return answer.ok() ? "" : answer.failure().ToString();
  };
  Value cubic = TwoMass(0.0);
  cubic["plant"]["shaft"]["k"]["law"] = Value("cubic_spring");
  EXPECT_NE(refusal(cubic, "T_shaft").find("law cubic_spring"), std::string::npos);
  Value drifting = TwoMass(5.0);
  drifting["plant"]["shaft"]["k"]["law"] = Value("kelvin_voigt");
  drifting["plant"]["shaft"]["k"]["drift"] = Value(0.5);
  EXPECT_NE(refusal(drifting, "T_shaft").find("changes with time"), std::string::npos);
  Value loaded = TwoMass(0.0);
  loaded["plant"]["load"]["f"] = Value{{"on", "I2"}, {"law", "coulomb"}, {"T_c_Nm", 1.0}};
  EXPECT_NE(refusal(loaded, "T_shaft").find("coulomb"), std::string::npos);
  Value lagged = TwoMass(0.0);
  lagged["input"]["T"]["actuator"] = Value(Value::Array{Value{{"type", "gain"}, {"gain", 2.0}}});
  EXPECT_NE(refusal(lagged, "T_shaft").find("actuator"), std::string::npos);
  Value sensed = TwoMass(0.0);
  sensed["output"]["w1"]["sensor"] = Value(Value::Array{Value{{"type", "gain"}, {"gain", 2.0}}});
  EXPECT_NE(refusal(sensed, "w1").find("sensor"), std::string::npos);
}

}  // namespace
}  // namespace dynoproof::oracles
