// KeptReference returns the samples of an earlier run for the same run, and for no other.
#include "experiment/kept_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <map>

#include "experiment/prepare.h"
#include "tests/support/build.h"
#include "tests/support/run_plan.h"
#include "tests/support/temp_dir.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

class KeptReferenceTest : public ::testing::Test {
 protected:
  static std::unique_ptr<Prepared> Of(const std::function<void(Value&)>& change = {}) {
    Plan plan = testing::OneMass(1.0, Value{{"type", "constant"}, {"value", 1.0}}, 0.01);
    plan.id = "one/mass";
    if (change) change(plan.root);
    Diagnostics diagnostics;
    auto prepared = Prepare(std::move(plan), {}, testing::BuiltIns(), diagnostics);
    EXPECT_NE(prepared, nullptr) << diagnostics.Format();
    return prepared;
  }

  /// Keeps the samples of a scenario, and returns them.
  Samples Keep(const Prepared& prepared) const {
    Samples samples = testing::RunRig(*prepared.rig, "reference");
    EXPECT_FALSE(KeptReference(Folder(), prepared).Keep(samples));
    return samples;
  }

  std::optional<Samples> Find(const Prepared& prepared) const { return KeptReference(Folder(), prepared).Find(); }

  /// Writes the kept file once more, changed.
  void Rewrite(const Prepared& prepared, const std::function<void(trace::Trace&)>& change) const {
    const std::string file = KeptReference(Folder(), prepared).file();
    Result<trace::Trace> trace = trace::ReadTrace(file);
    ASSERT_TRUE(trace.ok());
    change(*trace);
    ASSERT_FALSE(trace::WriteTrace(file, *trace));
  }

  std::string Folder() const { return folder_.path().string(); }

 private:
  test::TempDir folder_;
};

TEST_F(KeptReferenceTest, GivesBackWhatWasComputed) {
  const auto prepared = Of();
  EXPECT_FALSE(Find(*prepared)) << "nothing is kept yet";
  const Samples computed = Keep(*prepared);
  const std::optional<Samples> found = Find(*prepared);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->time, computed.time);
  EXPECT_EQ(found->inputs, computed.inputs);
  EXPECT_EQ(found->outputs, computed.outputs);
  EXPECT_EQ(found->counters, computed.counters);
  EXPECT_EQ(found->solver_summary, computed.solver_summary);
}

TEST_F(KeptReferenceTest, StandsWhateverIsCheckedAndHoweverItIsCalled) {
  Keep(*Of());
  const auto other = Of([](Value& root) { root["title"] = "another name"; });
  other->plan.root["check"] = Value(Value::Array{Value{{"kind", "solvers"}, {"signal", "w"}, {"nrmse", 1e-3}}});
  EXPECT_TRUE(Find(*other));
}

TEST_F(KeptReferenceTest, FallsWithAnythingThatTheRunIsMadeOf) {
  Keep(*Of());
  const std::map<std::string, std::function<void(Value&)>> changes = {
      {"an inertia", [](Value& root) { *root.FindPath("plant.inertia.I") = Value(std::nextafter(1.0, 2.0)); }},
      {"the excitation", [](Value& root) { *root.FindPath("input.T.source.value") = Value(2.0); }},
      {"the period", [](Value& root) { root["run"]["period_s"] = 5e-5; }},
      {"the duration", [](Value& root) { root["run"]["duration_s"] = 0.02; }},
  };
  for (const auto& [what, change] : changes) EXPECT_FALSE(Find(*Of(change))) << what;
  EXPECT_TRUE(Find(*Of()));
}

TEST_F(KeptReferenceTest, FallsWithRecordsCodeAndProcessor) {
  const auto prepared = Of();
  Keep(*prepared);
  const auto played = Of();
  played->records = std::make_shared<Records>();
  (*played->records)["T"] = {std::make_shared<const std::vector<double>>(std::vector{0.0, 1.0}),
                             std::make_shared<const std::vector<double>>(std::vector{0.0, 1.0})};
  EXPECT_FALSE(Find(*played)) << "a source plays a record that was not there";
  for (const char* of : {"code", "cpu", "records"}) {
    Keep(*prepared);
    ASSERT_TRUE(Find(*prepared));
    Rewrite(*prepared, [of](trace::Trace& trace) { trace.provenance.Set(of, "another"); });
    EXPECT_FALSE(Find(*prepared)) << of;
  }
}

TEST_F(KeptReferenceTest, FallsWhereTheFileIsDamagedOrLacksASignal) {
  const auto prepared = Of();
  Keep(*prepared);
  Rewrite(*prepared, [](trace::Trace& trace) { trace.signals.back().name = "another"; });
  EXPECT_FALSE(Find(*prepared));
  Keep(*prepared);
  const std::string file = KeptReference(Folder(), *prepared).file();
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_FALSE(Find(*prepared));
}

}  // namespace
}  // namespace dynoproof
