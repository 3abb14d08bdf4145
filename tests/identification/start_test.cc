// Records that begin in motion, each with a start of its own.
#include "identification/start.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "base/random.h"
#include "experiment/checks.h"
#include "identification/objective.h"
#include "model/registry.h"
#include "scenario/load.h"
#include "score/series.h"
#include "tests/identification/three_masses.h"
#include "tests/support/temp_dir.h"

namespace dynoproof::identification {
namespace {

class Start : public testing::Test {
 protected:
  Start() {
    RegisterBuiltIns(registry_);
    RegisterChecks(registry_);
    Diagnostics diagnostics;
    plan_ = LoadPlan(folder_.Write("line.toml", kThreeMasses).string(),
                     {"plant.inertia.I3=0.5", "plant.shaft.k1.stiffness_Nm_per_rad=4e5"}, diagnostics);
    EXPECT_TRUE(plan_ && diagnostics.error_count() == 0);
  }

  /// Rows [first, last) of one experiment at 1 kHz.
  static MappedRecord Cut(std::size_t first, std::size_t last) {
    const Rows all = RunThreeMasses(Chirp(last, 1e-3, 1), 1e-3);
    const auto part = [&](const std::vector<double>& values) {
      return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(first), values.end());
    };
    trace::Record record{.source = "part",
                         .columns = {{.name = "t", .values = part(all.t)},
                                     {.name = "T_airgap", .values = part(all.T_airgap)},
                                     {.name = "T_shaft", .values = part(all.T_shaft)},
                                     {.name = "omega_1", .values = part(all.omega_1)}},
                         .time = {},
                         .non_finite = {},
                         .notes = {}};
    trace::FinishRecord(record);
    Diagnostics diagnostics;
    std::optional<MappedRecord> mapped =
        MapRecord(record, {}, {{"T_airgap", "N m"}}, {{"T_shaft", "N m"}, {"omega_1", "rad/s"}}, diagnostics);
    EXPECT_TRUE(mapped);
    mapped->in_motion = true;
    return *std::move(mapped);
  }

  test::TempDir folder_;
  Registry registry_;
  std::optional<Plan> plan_;
};

/// The record with noise on its speed, and turning a little faster throughout.
MappedRecord Noisier(MappedRecord record, double sigma, double faster, std::uint64_t seed) {
  std::vector<double> speed = *record.outputs.at("omega_1").values;
  for (std::size_t i = 0; i < speed.size(); ++i) speed[i] += faster + sigma * RandomNormal(seed, 0, i);
  record.outputs.at("omega_1").values = std::make_shared<const std::vector<double>>(std::move(speed));
  return record;
}

TEST_F(Start, InMotionIsSeenBelowTheNoiseOfASample) {
  const MappedRecord rest = Cut(0, 600);
  const double sigma = 0.02 * score::StandardDeviation(*rest.outputs.at("omega_1").values);
  Diagnostics diagnostics;
  const std::optional<Plan> off =
      LoadPlan(folder_.Write("line.toml", kThreeMasses).string(), {"plant.inertia.I3=0.55"}, diagnostics);
  ASSERT_TRUE(off);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto motion = [&](const Plan& plan, double faster) {
      return MotionAtStart({plan, {Noisier(rest, sigma, faster, seed)}, registry_});
    };
    EXPECT_EQ(motion(*plan_, 0.0), "") << seed;
    EXPECT_NE(motion(*plan_, 2.5 * sigma), "") << seed;
    EXPECT_EQ(motion(*off, 0.0), "") << "a model that is a little off goes astray later, " << seed;
  }
}

TEST_F(Start, IsFoundForEachRecord) {
  const EstimationProblem problem(*plan_, {Cut(200, 500), Cut(350, 600), Cut(0, 100)}, registry_);
  const auto starts = std::count_if(problem.nuisances().begin(), problem.nuisances().end(),
                                    [](const Nuisance& nuisance) { return nuisance.start; });
  ASSERT_EQ(starts, 5);  // one speed, and of each of two shafts its twist and the rate of that
  const Result<Plan> found = FitStarts(problem, problem.plan());
  ASSERT_TRUE(found.ok());
  const std::unique_ptr<Objective> free_run = FreeRunObjective(problem);
  const Result<double> off = NrmseOf(*free_run, *found);
  ASSERT_TRUE(off.ok());
  // A linear line: the slopes are differences of runs, whose round-off is 1e-10 of the spread over the step of 1e-3.
  EXPECT_LT(*off, 1e-7);
}

}  // namespace
}  // namespace dynoproof::identification
