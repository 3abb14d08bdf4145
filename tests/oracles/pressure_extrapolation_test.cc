// The oracle proves itself: closed forms of emptying and filling, rest, and refusal of what it does not know.
#include <gtest/gtest.h>

#include <cmath>

#include "oracles/oracle.h"
#include "tests/support/plan_builder.h"

namespace dynoproof::oracles {
namespace {

std::vector<double> Ticks(std::size_t count, double step) {
  std::vector<double> time(count);
  for (std::size_t i = 0; i < count; ++i) time[i] = step * static_cast<double>(i);
  return time;
}

Result<Answer> Ask(const Value& scenario, std::size_t count, double step, const std::map<std::string, double>& inputs,
                   std::vector<std::string> outputs) {
  static std::map<std::string, std::vector<double>> held;
  const std::vector<double> time = Ticks(count, step);
  Question question{scenario, time, {}, std::move(outputs)};
  for (const auto& [name, value] : inputs) {
    held[name].assign(count, value);
    question.inputs[name] = held[name];
  }
  return PressureExtrapolation(question);
}

TEST(PressureExtrapolation, ChokedEmptyingIsAnExponential) {
  Plan plan = testing::AirPlan();
  plan.root["plant"]["flap"]["1"]["area_offset_m2"] = Value(0.0);
  const Result<Answer> answer =
      Ask(plan.root, 400, 0.02, {{"u_1", 0.0}, {"u_2", 40.0}, {"q_e", 0.0}, {"q_c", 0.0}}, {"p_ch", "p_s"});
  ASSERT_TRUE(answer.ok()) << answer.failure().ToString();
  const double area = 1e-5 + 4.5e-3 * (1.0 - std::cos(std::acos(-1.0) * 0.2));
  const double rate = area * std::sqrt(287.05 * 320.0 / 2.0) / 1.2;
  for (std::size_t k = 0; k < 400; ++k) {
    const double exact = 5e5 * std::exp(-rate * 0.02 * static_cast<double>(k));
    if (exact < 2.0 * 101300.0) break;
    EXPECT_NEAR(answer->at("p_s")[k], exact, 1e-6);  // 1e-12 of 5e5 Pa over 400 ticks
    EXPECT_EQ(answer->at("p_ch")[k], 3.5e5);
  }
}

TEST(PressureExtrapolation, FuelGasSettlesWhereSixThirtyTwoSays) {
  const Plan plan = testing::GasPlan();
  const Result<Answer> answer = Ask(plan.root, 50, 0.02, {{"p_mem", 5e5}, {"q_e", 0.02}}, {"p_g", "q_g", "x"});
  ASSERT_TRUE(answer.ok()) << answer.failure().ToString();
  const double k_q = 10e5 / std::sqrt(2.0 * 518.0 * 300.0) * 0.02, x = (0.02 - 0.03) / k_q;
  for (const double value : answer->at("p_g")) EXPECT_NEAR(value, 5e5 - (200.0 + 2e4 * x) / 0.02, 1e-6);
  EXPECT_NEAR(answer->at("q_g").back(), 0.02, 1e-14);
}

TEST(PressureExtrapolation, RefusesWhatItDoesNotKnow) {
  Plan table = testing::AirPlan(), rubs = testing::GasPlan(), line = testing::LumpedPlan();
  table.root["plant"]["flap"]["1"]["law"] = Value("table");
  rubs.root["plant"]["valve"]["v_g"]["friction_N"] = Value(3.0);
  for (const auto& [plan, why] : {std::pair(table, "table"), std::pair(rubs, "rubs"), std::pair(line, "neither")}) {
    const Result<Answer> answer = Ask(plan.root, 5, 0.01, {}, {});
    ASSERT_FALSE(answer.ok());
    EXPECT_EQ(answer.failure().exit_code, 2);
    EXPECT_NE(answer.failure().message.find(why), std::string::npos) << answer.failure().message;
  }
}

}  // namespace
}  // namespace dynoproof::oracles
