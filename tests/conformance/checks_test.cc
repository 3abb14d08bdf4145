// What every kind of check promises, asked of the whole registry: its table can be read, and it never passes a run that
// has no samples or whose samples are no numbers. A new kind adds one row.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "tests/support/check_bed.h"

namespace dynoproof {
namespace {

const Value kPair = Value::Array{1.0, 3.0};

struct Row {
  Value table;                 // complete, but for kind and origin
  bool judges_samples = true;  // false: makes runs of its own, or compares files
};

const std::map<std::string, Row>& Rows() {
  static const std::map<std::string, Row> rows = {
      {"bounded", {{{"signal", "p_s"}, {"between", Value::Array{0.5, 2.0}}}}},
      {"contacts", {{{"shaft", "k"}, {"signal", "p_s"}, {"from_s", 0.1}, {"impact_ms", 0.1}, {"nrmse", 0.01}}, false}},
      {"coupling",
       {{{"shaft", "k"},
         {"nu_rad_per_s", 1.0},
         {"stiffness_Nm_per_rad", 1.0},
         {"damping_Nms_per_rad", 1.0},
         {"relative", 0.1}},
        false}},
      {"divergence",
       {{{"signal", "p_s"}, {"path", "plant.x"}, {"from_s", 0.1}, {"to_s", 0.2}, {"at_most_per_s", 1.0}}, false}},
      {"filters_hold", {{{"notches", Value::Array{"p_ch"}}, {"gain", "u_1"}, {"near_Hz", 20.0}}, false}},
      {"follows", {{{"signal", "p_s"}, {"reference", "u_1"}, {"largest", 0.5}}}},
      {"golden", {Value(), false}},
      {"growth",
       {{{"signal", "p_s"},
         {"frequency_Hz", 2.0},
         {"growth_per_s", 0.0},
         {"first_s", 1.0},
         {"second_s", 5.0},
         {"window_s", 2.0},
         {"tolerance_Hz", 1.0},
         {"tolerance_per_s", 1.0}}}},
      {"load_step",
       {{{"speed", "p_ch"},
         {"power", "p_s"},
         {"load", "u_1"},
         {"drop_percent", kPair},
         {"recovery_s", 5.0},
         {"dip_percent", 20.0}}}},
      {"oracle", {{{"oracle", "pressure_extrapolation"}, {"signal", "p_s"}, {"nrmse", 1e-3}}}},
      {"oscillation",
       {{{"signal", "p_s"},
         {"frequency_Hz", 2.0},
         {"amplitude", 1.0},
         {"during_s", Value::Array{1.0, 5.0}},
         {"near_Hz", 1.0},
         {"tolerance_Hz", 1.0},
         {"tolerance", 0.1}}}},
      {"peak", {{{"signal", "p_s"}, {"figure", "tone"}, {"band_Hz", kPair}, {"between_Hz", kPair}}}},
      {"placements",
       {{{"notches", Value::Array{"p_ch"}},
         {"expected_Hz", Value::Array{1.0}},
         {"tolerance_Hz", 1.0},
         {"load_from_s", 40.0},
         {"signal", "p_s"}}}},
      {"ramps", {{{"signal", "p_s"}, {"reference", "u_1"}, {"overshoot_percent", 1.0}, {"settling_s", 1.0}}}},
      {"resonances", {{{"band_Hz", kPair}, {"tolerance_Hz", 1.0}, {"tolerance_gain", 0.1}}}},
      {"solvers", {{{"signal", "p_s"}, {"nrmse", 1e-3}}}},
      {"wander",
       {{{"notches", Value::Array{"p_ch"}},
         {"expected_Hz", Value::Array{1.0}},
         {"found_by_s", 1.0},
         {"tolerance_Hz", 1.0},
         {"wanders_Hz", 1.0}}}},
      {"windows", {{{"signal", "p_s"}, {"nrmse", 1e-3}}, false}},
  };
  return rows;
}

/// The check of a row, ready to be stated.
Value Stated(const std::string& kind) {
  Value table = Rows().at(kind).table;
  table["kind"] = Value(kind);
  if (kind != "golden") table["origin"] = Value("a test");
  return table;
}

TEST(CheckKinds, EachHasARowThatCanBeRead) {
  for (const CheckKind* kind : testing::FullRegistry().Checks()) {
    SCOPED_TRACE(kind->name);
    EXPECT_FALSE(kind->summary.empty());
    for (const std::string& limit : kind->relative_limits) {
      EXPECT_TRUE(std::ranges::any_of(kind->parameters, [&](const ParamInfo& one) { return one.name == limit; }))
          << limit;
    }
    ASSERT_TRUE(Rows().contains(kind->name));
    Diagnostics diagnostics;
    EXPECT_NE(kind->make(Stated(kind->name), diagnostics), nullptr) << diagnostics.Format();
  }
#ifdef DYNOPROOF_THESIS  // the harness alone has fewer kinds than rows
  EXPECT_EQ(Rows().size(), testing::FullRegistry().Checks().size()) << "a row of a kind that is gone";
#endif
}

/// What a kind says of a run with these samples; a NaN stands in for each signal where `nan` is set.
void ExpectNoPass(const std::string& kind, std::size_t samples, bool nan) {
  SCOPED_TRACE(kind);
  testing::CheckBed bed(Stated(kind));
  bed.samples.time.resize(samples);
  for (auto* signals : {&bed.samples.inputs, &bed.samples.outputs}) {
    for (std::vector<double>& values : *signals) {
      values.resize(samples);
      if (nan) values.assign(samples, std::numeric_limits<double>::quiet_NaN());
    }
  }
  bed.plan.root["analysis"] = Value{{"input", "u_1"}, {"output", "p_s"}};
  for (const score::Check& check : bed.Run()) {
    EXPECT_NE(check.verdict, score::Verdict::kPass) << check.name;
    EXPECT_FALSE(check.explanation.empty()) << check.name;
    EXPECT_EQ(check.evidence, nullptr) << check.name << ": nothing was compared";
  }
}

TEST(CheckKinds, ARunWithoutNumbersNeverPasses) {
  for (const auto& [kind, row] : Rows()) {
    if (row.judges_samples && testing::FullRegistry().FindCheck(kind) != nullptr) ExpectNoPass(kind, 4001, true);
  }
}

/// One sample of each signal in turn, in the middle of a run that is sound elsewhere.
TEST(CheckKinds, ARunWithOneSampleThatIsNoNumberNeverPasses) {
  constexpr double kNot = std::numeric_limits<double>::quiet_NaN(), kEndless = std::numeric_limits<double>::infinity();
  for (const auto& [kind, row] : Rows()) {
    if (!row.judges_samples || testing::FullRegistry().FindCheck(kind) == nullptr) continue;
    for (const double value : {kNot, kEndless, -kEndless}) {
      SCOPED_TRACE(kind + " " + std::to_string(value));
      testing::CheckBed bed(Stated(kind));
      for (auto* signals : {&bed.samples.inputs, &bed.samples.outputs}) {
        for (std::vector<double>& values : *signals) values[values.size() / 2] = value;
      }
      bed.plan.root["analysis"] = Value{{"input", "u_1"}, {"output", "p_s"}};
      for (const score::Check& check : bed.Run()) EXPECT_NE(check.verdict, score::Verdict::kPass) << check.name;
    }
  }
}

TEST(CheckKinds, ARunWithoutSamplesNeverPasses) {
  for (const auto& [kind, row] : Rows()) {
    if (row.judges_samples && testing::FullRegistry().FindCheck(kind) != nullptr) ExpectNoPass(kind, 0, false);
  }
}

TEST(CheckKinds, ARunThatEndsBeforeWhatIsLookedAtSaysSo) {
  for (const char* const kind : {"growth", "placements", "wander"}) {
    if (testing::FullRegistry().FindCheck(kind) == nullptr) continue;
    SCOPED_TRACE(kind);
    testing::CheckBed bed(Stated(kind));
    constexpr std::size_t kFew = 30;  // all of them before the first time that is asked for
    bed.samples.time.resize(kFew);
    for (auto* signals : {&bed.samples.inputs, &bed.samples.outputs}) {
      for (std::vector<double>& values : *signals) values.resize(kFew);
    }
    const std::vector<score::Check> checks = bed.Run();
    ASSERT_EQ(checks.size(), 1U);
    EXPECT_EQ(checks[0].verdict, score::Verdict::kFail);
    EXPECT_NE(checks[0].explanation.find("the run"), std::string::npos) << checks[0].explanation;
  }
}

}  // namespace
}  // namespace dynoproof
