// What every source, actuator and sensor promises, asked of the whole registry with the examples of the READMEs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/units.h"
#include "model/linear_part.h"
#include "tests/support/build.h"
#include "tests/support/readme_examples.h"

namespace dynoproof {
namespace {

using testing::Build;
using testing::BuiltIns;
using testing::Example;
using testing::OutputOf;

const testing::Examples& Examples() {
  static const testing::Examples examples = testing::ReadmeExamples();
  return examples;
}

bool IsSmall(const std::string& kind) { return kind == "source" || kind == "actuator" || kind == "sensor"; }

/// Every registered source, actuator and sensor, built from its example.
template <class Body>
void ForEachExample(const std::string& kind, const Body& body) {
  int count = 0;
  for (const PluginInfo* info : BuiltIns().Plugins()) {
    if (info->kind != kind) continue;
    SCOPED_TRACE(kind + "." + info->name);
    const auto example = Examples().find({kind, info->name});
    ASSERT_NE(example, Examples().end()) << "its README has no example";
    std::string faults;
    const std::unique_ptr<Component> built = Build(kind, example->second.table, {.nominal = 1000.0}, &faults);
    ASSERT_NE(built, nullptr) << faults;
    body(*built, example->second);
    ++count;
  }
  EXPECT_GE(count, 6);  // the contract's effects alone need that many of each kind
}

void ExpectPorts(const std::vector<Port>& ports) {
  for (const Port& port : ports) {
    EXPECT_TRUE(ParseUnit(port.unit)) << port.name << " [" << port.unit << "]";
    EXPECT_FALSE(port.description.empty()) << port.name;
    EXPECT_GT(port.nominal, 0.0) << port.name;
    EXPECT_TRUE(std::isfinite(port.nominal)) << port.name;
  }
}

TEST(Plugins, EachSaysWhatItIs) {
  for (const PluginInfo* info : BuiltIns().Plugins()) {
    SCOPED_TRACE(info->kind + "." + info->name);
    EXPECT_THAT(std::vector<std::string>({"plant", "law", "control", "source", "actuator", "sensor"}),
                ::testing::Contains(info->kind));
    EXPECT_FALSE(info->summary.empty());
    EXPECT_FALSE(info->law.empty());
    EXPECT_FALSE(info->source.empty());
    for (const ParamInfo& parameter : info->parameters) {
      EXPECT_FALSE(parameter.description.empty()) << parameter.name;
      const bool number = parameter.type == "number" || parameter.type == "array of numbers";
      EXPECT_TRUE(!number || ParseUnit(parameter.unit)) << parameter.name << " [" << parameter.unit << "]";
    }
  }
}

TEST(Plugins, ReadmesNameEveryParameter) {
  for (const PluginInfo* info : BuiltIns().Plugins()) {
    if (!IsSmall(info->kind) && info->kind != "law") continue;
    SCOPED_TRACE(info->kind + "." + info->name);
    const auto example = Examples().find({info->kind, info->name});
    ASSERT_NE(example, Examples().end()) << "its README has no example";
    for (const ParamInfo& parameter : info->parameters) {
      EXPECT_THAT(example->second.readme, ::testing::HasSubstr("| `" + parameter.name + "` |"));
    }
  }
}

TEST(Plugins, AnUnknownKeyIsAFault) {
  for (const char* kind : {"source", "actuator", "sensor"}) {
    ForEachExample(kind, [&](const Component&, const Example& example) {
      Value table = example.table;
      table["no_such_key"] = Value(1.0);
      std::string faults;
      EXPECT_EQ(Build(kind, table, {}, &faults), nullptr);
      EXPECT_THAT(faults, ::testing::HasSubstr("unknown key \"no_such_key\""));
    });
  }
}

/// The tables that differ from this one by a number in one place that is none.
std::vector<std::pair<std::string, Value>> WithoutANumber(const Value& table) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  std::vector<std::pair<std::string, Value>> changed;
  for (const Value::Entry& entry : table.table()) {
    for (const double no_number : {std::numeric_limits<double>::quiet_NaN(), kEndless, -kEndless}) {
      Value other = table;
      if (entry.value.is_number()) {
        other[entry.key] = Value(no_number);
      } else if (entry.value.is_array() && !entry.value.array().empty() && entry.value.array()[0].is_number()) {
        other[entry.key].array().back() = Value(no_number);
      } else {
        continue;
      }
      changed.emplace_back(entry.key + " = " + std::to_string(no_number), std::move(other));
    }
  }
  return changed;
}

TEST(Plugins, AParameterThatIsNoNumberIsAFault) {
  int tried = 0;
  for (const char* kind : {"source", "actuator", "sensor"}) {
    ForEachExample(kind, [&](const Component&, const Example& example) {
      for (const auto& [what, table] : WithoutANumber(example.table)) {
        std::string faults;
        EXPECT_EQ(Build(kind, table, {.nominal = 1000.0}, &faults), nullptr) << what;
        EXPECT_NE(faults, "") << what;
        ++tried;
      }
    });
  }
  for (const PluginInfo* info : BuiltIns().Plugins()) {
    if (info->kind != "law") continue;
    SCOPED_TRACE("law." + info->name);
    for (const auto& [what, table] : WithoutANumber(Examples().at({"law", info->name}).table)) {
      std::string faults;
      EXPECT_EQ(testing::BuildLaw(table, &faults), nullptr) << what;
      EXPECT_NE(faults, "") << what;
      ++tried;
    }
  }
  EXPECT_GT(tried, 150);  // 3 for each number of some 60 examples
}

TEST(Sources, ArePureFunctionsOfTimeAndSeed) {
  ForEachExample("source", [](const Component& source, const Example& example) {
    EXPECT_TRUE(source.layout().inputs.empty() && source.layout().states.empty());
    ASSERT_EQ(source.layout().outputs.size(), 1u);
    EXPECT_EQ(source.layout().outputs[0].name, "value");
    ExpectPorts(source.layout().outputs);
    const std::unique_ptr<Component> again = Build("source", example.table, {.nominal = 1000.0});
    std::vector<double> forwards;
    for (int i = 0; i < 3000; ++i) forwards.push_back(OutputOf(source, i * 1e-3));
    for (int i = 2999; i >= 0; --i) {  // backwards, on another instance: the same bits
      ASSERT_EQ(OutputOf(*again, i * 1e-3), forwards[i]) << "at " << i << " ms";
      ASSERT_TRUE(std::isfinite(forwards[i]));
    }
  });
}

TEST(Stages, HaveOneInputAndOneOutputOfTheSameUnit) {
  for (const char* kind : {"actuator", "sensor"}) {
    ForEachExample(kind, [](const Component& stage, const Example&) {
      ASSERT_EQ(stage.layout().inputs.size(), 1u);
      ASSERT_EQ(stage.layout().outputs.size(), 1u);
      EXPECT_EQ(stage.layout().inputs[0].unit, stage.layout().outputs[0].unit);
      EXPECT_EQ(stage.layout().outputs[0].nominal, 1000.0);
      ExpectPorts(stage.layout().inputs);
      ExpectPorts(stage.layout().outputs);
      ExpectPorts(stage.layout().states);
    });
  }
}

TEST(Stages, FeedThroughWhereTheOutputFollowsAtOnce) {
  for (const char* kind : {"actuator", "sensor"}) {
    ForEachExample(kind, [](const Component& stage, const Example&) {
      std::vector<double> states(stage.layout().states.size(), 0.0);
      const double low = 300.0, high = 1500.0;  // beyond every dead zone, below every limit of the examples
      const double change = OutputOf(stage, 0.5, {&high, 1}, states) - OutputOf(stage, 0.5, {&low, 1}, states);
      EXPECT_EQ(change != 0.0, stage.FeedsThrough(0, 0));
    });
  }
}

TEST(Stages, LinearPartsAreTheStage) {
  for (const char* kind : {"actuator", "sensor"}) {
    ForEachExample(kind, [](const Component& stage, const Example&) {
      const LinearPart* part = stage.linear_part();
      if (part == nullptr) return;
      const auto n = static_cast<Eigen::Index>(stage.layout().states.size());
      ASSERT_EQ(part->system.A.rows(), n);
      ASSERT_EQ(part->system.inputs(), 1);
      ASSERT_EQ(part->system.outputs(), 1);
      EXPECT_TRUE(part->channels.empty());
      ASSERT_EQ(part->x_from_state.rows(), n);
      ASSERT_EQ(part->state_from_p.rows(), n);
      ASSERT_EQ(part->p_from_state.cols(), n);
      EXPECT_TRUE((part->state_from_x * part->x_from_state).isIdentity(0.0));
      const double in = 7.25;
      const Eigen::VectorXd s = Eigen::VectorXd::Constant(n, -3.5);
      const Eigen::VectorXd x = part->x_from_state * s, u = Eigen::VectorXd::Constant(1, in);
      const std::span<const double> states(s.data(), static_cast<std::size_t>(n));
      Eigen::VectorXd rates(n);
      stage.Derivative({0.5, {&in, 1}, states, {}}, {rates.data(), static_cast<std::size_t>(n)});
      // Two roundings of a product and a sum each way: a few ulps.
      const Eigen::VectorXd linear = part->system.A * x + part->system.B * u;
      EXPECT_LE((linear - rates).norm(), 1e-15 * 8 * rates.norm());
      const double out = (part->system.C * x + part->system.D * u)[0];
      EXPECT_DOUBLE_EQ(OutputOf(stage, 0.5, {&in, 1}, states), out);
    });
  }
}

TEST(Stages, StartInSteadyState) {
  for (const char* kind : {"actuator", "sensor"}) {
    ForEachExample(kind, [](const Component& stage, const Example&) {
      std::vector<double> states(stage.layout().states.size(), 0.0), rates = states;
      std::vector<int> modes(static_cast<std::size_t>(stage.layout().modes), 0);
      const double in = 421.0;
      stage.Start({&in, 1}, states, modes);
      stage.Derivative({0.0, {&in, 1}, states, modes}, rates);
      for (const double rate : rates) EXPECT_EQ(rate, 0.0);
    });
  }
}

/// At once, or as the rate of a state: a limit or a play must not make a number of it.
TEST(Stages, PassOnWhatIsNoNumber) {
  for (const char* kind : {"actuator", "sensor"}) {
    ForEachExample(kind, [](const Component& stage, const Example&) {
      std::vector<double> states(stage.layout().states.size(), 0.0), rates = states;
      std::vector<int> modes(static_cast<std::size_t>(stage.layout().modes), 0);
      const double in = std::numeric_limits<double>::quiet_NaN();
      double out = 0.0;
      stage.Output({0.5, {&in, 1}, states, modes}, {&out, 1});
      stage.Derivative({0.5, {&in, 1}, states, modes}, rates);
      const bool shows = std::isnan(out) || std::ranges::any_of(rates, [](double rate) { return std::isnan(rate); });
      EXPECT_TRUE(shows) << "gives " << out;
    });
  }
}

TEST(Stages, GuardsChangeContinuously) {
  for (const char* kind : {"actuator", "sensor"}) {
    ForEachExample(kind, [](const Component& stage, const Example&) {
      std::vector<double> before(static_cast<std::size_t>(stage.layout().guards)), after = before;
      for (double in = -3000.0; in < 3000.0; in += 0.5) {
        const double next = in + 0.5;
        stage.Guards({0.0, {&in, 1}, {}, {}}, before);
        stage.Guards({0.0, {&next, 1}, {}, {}}, after);
        // The guards are in the unit of the input, with slope 1: a step of 0.5 moves them by no more.
        for (std::size_t i = 0; i < before.size(); ++i) ASSERT_LE(std::abs(after[i] - before[i]), 0.5);
      }
    });
  }
}

}  // namespace
}  // namespace dynoproof
