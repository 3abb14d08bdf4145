// The oracle for shafts with play against closed forms, and that it refuses what it does not know.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "oracles/oracle.h"

namespace dynoproof::oracles {
namespace {

/// A mass at rest in the middle of a gap to a body that nothing moves, under a held torque.
Value OneMassInAGap(const char* law, double k, double c) {
  Value shaft{{"between", Value::Array{"wall", "I"}},
              {"law", law},
              {"stiffness_Nm_per_rad", k},
              {"damping_Nms_per_rad", c},
              {"half_gap_rad", 0.02}};
  if (std::string_view(law) == "full_state_backlash") shaft["contact_free_damping_Nms_per_rad"] = Value(0.0);
  return Value{{"plant", Value{{"type", "drive_line"},
                               {"inertia", Value{{"I", 0.01}, {"wall", 1e15}}},
                               {"shaft", Value{{"gap", std::move(shaft)}}},
                               {"torque", Value{{"T", Value{{"on", "I"}}}}}}},
               {"input", Value{{"T", Value{{"to", "plant.T"}}}}},
               {"output", Value{{"w", Value{{"of", "plant.I.speed"}}},
                                {"phi", Value{{"of", "plant.I.angle"}}},
                                {"T_gap", Value{{"of", "plant.gap.torque"}}}}}};
}

Result<Answer> Ask(const Value& scenario, double torque, int ticks) {
  static std::vector<double> time, command;
  time.clear();
  for (int k = 0; k < ticks; ++k) time.push_back(1e-4 * k);
  command.assign(ticks, torque);
  return PiecewiseExponential({scenario, time, {{"T", command}}, {"w", "phi", "T_gap"}});
}

TEST(PiecewiseExponential, AMassBouncesInAGapAsTheClosedFormSays) {
  const double I = 0.01, k = 2e4, alpha = 0.02, T = 3.0;
  for (const char* law : {"dead_zone", "full_state_backlash"}) {
    const Result<Answer> answer = Ask(OneMassInAGap(law, k, law[0] == 'd' ? 0.0 : 1e-9), T, 1000);
    ASSERT_TRUE(answer.ok()) << answer.failure().ToString();
    // Without damping: T/I t^2/2 to alpha, then a sine about alpha + T/k with the speed it arrives with.
    const double arrival = std::sqrt(2.0 * alpha * I / T), speed = T / I * arrival, nu = std::sqrt(k / I);
    const double amplitude = std::sqrt(std::pow(T / k, 2) + std::pow(speed / nu, 2));
    const double contact = 2.0 * (std::numbers::pi / 2 + std::asin(T / k / amplitude)) / nu;
    for (int i = 0; i < 1000; ++i) {
      const double t = 1e-4 * i, cycle = std::fmod(t, 2.0 * arrival + contact);
      double phi = 0.5 * T / I * cycle * cycle;
      if (cycle > arrival) {
        phi = alpha + T / k + amplitude * std::sin(nu * (cycle - arrival) - std::asin(T / k / amplitude));
      }
      if (cycle > arrival + contact) phi = 0.5 * T / I * std::pow(2.0 * arrival + contact - cycle, 2);
      ASSERT_NEAR(answer->at("phi")[i], phi, 1e-8) << law << " at " << t;
    }
  }
}

TEST(PiecewiseExponential, DampingTakesWhatTheContactSays) {
  // With damping the rebound is slower; exact for a mass that meets a spring and damper: separated when the torque is
  // 0.
  const Result<Answer> answer = Ask(OneMassInAGap("revised_dead_zone", 2e4, 2.0), 3.0, 600);
  ASSERT_TRUE(answer.ok());
  double most = 0.0;
  for (const double torque : answer->at("T_gap")) most = std::max(most, torque);
  EXPECT_LT(most, 1e-9);  // wall first: the mass is pushed back by T < 0, and never pulled
}

TEST(PiecewiseExponential, RefusesWhatItDoesNotKnow) {
  Value damped = OneMassInAGap("dead_zone", 2e4, 1.0);
  damped["plant"]["shaft"]["gap"]["law"] = Value("damped_phase_plane");
  EXPECT_FALSE(Ask(damped, 1.0, 10).ok());
  Value controlled = OneMassInAGap("dead_zone", 2e4, 1.0);
  controlled["control"]["x"] = Value{{"type", "speed_pi"}};
  EXPECT_FALSE(Ask(controlled, 1.0, 10).ok());
  Value plain = OneMassInAGap("dead_zone", 2e4, 1.0);
  plain["plant"]["shaft"]["gap"]["law"] = Value("spring_damper");
  EXPECT_FALSE(Ask(plain, 1.0, 10).ok());
}

}  // namespace
}  // namespace dynoproof::oracles
