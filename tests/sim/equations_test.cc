// Plants that a scenario writes down itself: beside a plant of the program with the same equations, closed forms, and what is told
// of equations that are none.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/build.h"
#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

namespace dynoproof::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The largest distance of two courses, over the largest value of the first.
double Distance(const std::vector<double>& a, const std::vector<double>& b) {
  double apart = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    apart = std::max(apart, std::abs(a[k] - b[k]));
    largest = std::max(largest, std::abs(a[k]));
  }
  return a.size() == b.size() && largest > 0.0 ? apart / largest : HUGE_VAL;
}

/// A plant of its section's text; the faults where there is none.
struct Built {
  std::unique_ptr<Component> plant;
  std::string faults;
};
Built PlantOf(Value table) {
  Built built;
  table["type"] = Value("equations");
  built.plant = Build("plant", table, {}, &built.faults);
  return built;
}

Value State(const char* rate) { return Value{{"rate", rate}}; }

TEST(Equations, OfADriveLineMoveAsTheDriveLine) {
  for (const char* solver : {"reference", "realtime"}) {
    const Samples line = RunPlan(TwoBodiesPlan(), solver), written = RunPlan(EquationsPlan(), solver);
    ASSERT_EQ(line.outputs.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      // The reference solver keeps 1e-10; realtime carries the line exactly, and the equations by a fourth order.
      EXPECT_LT(Distance(line.outputs[i], written.outputs[i]), 1e-8) << solver << " output " << i;
    }
  }
}

/// Effects change them as they change the line.
TEST(Equations, TakeEffectsAsTheDriveLine) {
  const auto with = [](Plan plan, const char* name, const char* at, const std::vector<double>& values) {
    BuiltIns().FindEffect(name)->Apply(plan, *ParsePlace(at), values);
    return RunPlan(plan, "reference").outputs;
  };
  const auto plain = RunPlan(TwoBodiesPlan(), "reference").outputs;
  const auto line = with(TwoBodiesPlan(), "stiffness_change", "shaft:k", {0.3});
  const auto written = with(EquationsPlan(), "parameter_change", "parameter:k", {0.3});
  EXPECT_GT(Distance(plain[0], line[0]), 0.1);
  EXPECT_LT(Distance(line[0], written[0]), 1e-8);
  const auto dragged = with(TwoBodiesPlan(), "quadratic_drag", "inertia:B", {0.5}),
             dragged_too = with(EquationsPlan(), "quadratic_drag", "inertia:B", {0.5});
  EXPECT_GT(Distance(plain[1], dragged[1]), 0.1);
  EXPECT_LT(Distance(dragged[1], dragged_too[1]), 1e-8);
}

/// A body that coasts under dry friction comes to rest after v0 m / F; it slips on by what tanh leaves near standstill.
TEST(Equations, LetABodyRubToRest) {
  Plan plan = EquationsPlan();
  plan.root["run"]["duration_s"] = Value(1.0);
  plan.root["plant"] =
      Value{{"type", "equations"},
            {"motion", "translation"},
            {"parameter", Value{{"m", 2.0}}},
            {"state", Value{{"x", State("v")}, {"v", Value{{"rate", "load_cart/m"}, {"start", 1.5}}}}},
            {"body", Value{{"cart", Value{{"position", "x"}, {"speed", "v"}, {"transition_speed", 1e-4}}}}},
            {"load", Value{{"rail", Value{{"on", "cart"}, {"law", "coulomb"}, {"T_c_N", 6.0}}}}}};
  plan.root.Erase("input");
  plan.root["output"] =
      Value{{"x", Value{{"of", "plant.x"}, {"nominal", 1.0}}}, {"v", Value{{"of", "plant.v"}, {"nominal", 1.0}}}};
  const Samples samples = RunPlan(plan, "reference");
  for (std::size_t k = 0; k < samples.time.size(); ++k)
    EXPECT_NEAR(samples.outputs[1][k], std::max(0.0, 1.5 - 3.0 * samples.time[k]), 2e-4) << samples.time[k];
  EXPECT_NEAR(samples.outputs[0].back(), 1.5 * 0.25, 1e-4);
}

/// Every function and operator, at numbers where they differ.
TEST(Equations, KnowTheUsualFunctions) {
  const std::pair<const char*, double> values[] = {
      {"2 + 3*4^2/8 - 1", 7.0},
      {"-2^2", -4.0},
      {"sin(0.3) + cos(0.3) + tan(0.3)", std::sin(0.3) + std::cos(0.3) + std::tan(0.3)},
      {"asin(0.3) + acos(0.3) + atan(0.3)", std::asin(0.3) + std::acos(0.3) + std::atan(0.3)},
      {"sinh(0.3) + cosh(0.3) + tanh(0.3)", std::sinh(0.3) + std::cosh(0.3) + std::tanh(0.3)},
      {"exp(1.2) + log(1.2) + sqrt(1.2)", std::exp(1.2) + std::log(1.2) + std::sqrt(1.2)},
      {"abs(-3) + floor(2.7) + 10*sign(-0.1) + sign(0)", -5.0},
      {"atan2(1, -1) + hypot(3, 4) + pow(2, 0.5)", std::atan2(1.0, -1.0) + 5.0 + std::sqrt(2.0)},
      {"min(2, 3) + 10*max(2, 3)", 32.0},
      {"t > 1 ? 5 : 7", 5.0},
      {"pi", 3.14159265358979323846},
      {"(t == 2) + 10*(t != 2) + 100*(t <= 2 && t >= 2)", 101.0},
  };
  for (const auto& [text, value] : values) {
    const Built built = PlantOf({{"state", Value{{"x", State(text)}}}});
    ASSERT_NE(built.plant, nullptr) << built.faults;
    const double state = 0.0;
    double rate = 0.0;
    built.plant->Derivative({2.0, {}, {&state, 1}, {}}, {&rate, 1});
    EXPECT_DOUBLE_EQ(rate, value) << text;
  }
}

/// An input reaches an output at once through definitions, and no other.
TEST(Equations, TellWhichOutputsFollowAnInputAtOnce) {
  const Built built = PlantOf({{"input", Value{{"u", Value{{"unit", "1"}}}, {"d", Value{{"unit", "1"}}}}},
                               {"define", Value{{"z", "2*y"}, {"y", "u + x"}}},
                               {"state", Value{{"x", State("d - x")}}},
                               {"output", Value{{"now", Value{{"value", "z"}}}, {"later", Value{{"value", "x^2"}}}}}});
  ASSERT_NE(built.plant, nullptr) << built.faults;
  EXPECT_FALSE(built.plant->FeedsThrough(0, 0)) << "a state";
  EXPECT_TRUE(built.plant->FeedsThrough(0, 1)) << "now";
  EXPECT_FALSE(built.plant->FeedsThrough(1, 1));
  EXPECT_FALSE(built.plant->FeedsThrough(0, 2)) << "later";
  const double inputs[] = {3.0, 0.0}, state = 5.0;
  double outputs[3];
  built.plant->Output({0.0, inputs, {&state, 1}, {}}, outputs);
  EXPECT_EQ(outputs[1], 16.0);
  EXPECT_EQ(outputs[2], 25.0);
}

TEST(Equations, TellEveryFaultAtOnceWithItsRemedy) {
  const Built built =
      PlantOf({{"parameter", Value{{"m", 1.0}, {"sin", 2.0}}},
               {"input", Value{{"F", Value{{"unit", "N"}}}, {"m", Value{{"unit", "N"}}}}},
               {"define", Value{{"a", "b + 1"}, {"b", "2*a"}}},
               {"state", Value{{"x", State("vv")},
                               {"v", State("F +* m")},
                               {"q", State("sqr(x)")},
                               {"t", State("1")},
                               {"y", State("x = 2")}}},
               {"body", Value{{"cart", Value{{"speed", "F"}}}}},
               {"load", Value{{"rail", Value{{"on", "kart"}, {"law", "viscous"}, {"b_Nms_per_rad", 1.0}}}}}});
  EXPECT_EQ(built.plant, nullptr);
  for (const char* told : {"\"m\" is there twice", "\"sin\" is a function", "\"t\" has a meaning already",
                           "\"a\" needs itself: a -> b -> a", "\"vv\" is not known", "did you mean \"v\"?",
                           "\"F +* m\" is no expression", "there is no function \"sqr\"", "did you mean \"sqrt\"?",
                           "equal is ==", "the motion of a body is an expression of t, states and parameters alone",
                           "load_cart stands in no equation", "write on = \"cart\""})
    EXPECT_THAT(built.faults, HasSubstr(told));
}

/// The parser's own limits are told as faults of the scenario.
TEST(Equations, ThatAreTooLongAreRefused) {
  std::string sum = "x";
  for (int i = 0; i < 20'000; ++i) sum += "+x";
  for (const std::string& text : {sum, std::string(50'000, '(') + "1" + std::string(50'000, ')')})
    EXPECT_THAT(PlantOf({{"state", Value{{"x", State(text.c_str())}}}}).faults, HasSubstr("is no expression"));
  EXPECT_THAT(PlantOf({{"state", Value{{"x", State("sin")}}}}).faults, HasSubstr("write sin(...)"));
}

TEST(Equations, WithoutStatesAreNone) {
  EXPECT_THAT(PlantOf({{"state", Value()}}).faults, HasSubstr("a plant without states"));
}

}  // namespace
}  // namespace dynoproof::testing
