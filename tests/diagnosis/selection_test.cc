// Hypotheses against each other: none may lose because it had not found its place yet.
#include "diagnosis/selection.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

namespace dynoproof::diagnosis {
namespace {

using SlowContest = LumpedLine;

// A speed sensor that drifts looks like a torque that speeds the line up, to the torque sensor's noise. Who was beaten
// beside nominal values that were wrong has to be asked again where they are right.
TEST_F(SlowContest, WhoWasBeatenIsAskedAgainBesideTheLeader) {
  constexpr std::size_t kRows = 7001;
  constexpr double kDrift = 0.05;  // rad/s^2
  ASSERT_TRUE(plan_);
  MappedRecord record = LineRecord(blind::IndependentLine(), blind::IndependentTorque(kRows, 7), 0.003);
  std::vector<double> speed = *record.outputs["omega_1"].values;
  for (std::size_t i = 0; i < speed.size(); ++i) speed[i] += kDrift * 1e-4 * static_cast<double>(i);
  record.outputs["omega_1"].values = Shared(std::move(speed));
  const EstimationProblem problem(*plan_, {record}, registry_);
  const EffectInstance load = {registry_.FindEffect("constant_load"), *ParsePlace("inertia:I4"), {-1.0}};
  const EffectInstance drift = {registry_.FindEffect("sensor_drift"), *ParsePlace("output:omega_1"), {0.01}};

  const auto winner = [&](std::vector<EffectInstance> beaten) {
    SavedFits saved((std::filesystem::path(testing::TempDir()) / "contest_test_state.json").string(), false, problem);
    Selection selection(problem, saved, [](auto&&...) {});
    Estimate null = EstimateAt(problem, problem.Nominal());
    Hypothesis at = problem.Nominal();
    at.effects = {load};
    std::vector<Estimate> fits = {EstimateAt(problem, at)};
    selection.Recall(std::move(beaten));
    selection.Decide({}, fits, null);
    return fits.empty() ? std::string() : fits.front().Name();
  };
  EXPECT_EQ(winner({}), "constant_load@inertia:I4");
  EXPECT_EQ(winner({drift}), "sensor_drift@output:omega_1");
}

// A mode that has moved by more than its width leaves no slope to follow: from two percent no search comes to a shaft
// that is a sixth softer beside values that are a percent off.
TEST_F(SlowContest, SomeStartLeadsToASofterShaft) {
  blind::IndependentLine line;
  line.stiffness[3] *= 0.83;
  line.stiffness[2] *= 1.012;
  line.inertia[3] *= 0.99;
  ASSERT_TRUE(plan_);
  const EstimationProblem problem(*plan_, {LineRecord(line, blind::IndependentTorque(7001, 7), 0.003)}, registry_);
  SavedFits saved((std::filesystem::path(testing::TempDir()) / "contest_test_starts.json").string(), false, problem);
  Selection selection(problem, saved, [](auto&&...) {});
  const auto softer = [&](double delta) {
    return EffectInstance{registry_.FindEffect("stiffness_change"), *ParsePlace("shaft:k4"), {delta}};
  };
  const EffectInstance load = {registry_.FindEffect("constant_load"), *ParsePlace("inertia:I4"), {-1.0}};
  EXPECT_FALSE(selection.FromAnyStart({softer(0.02), load}));
  const std::optional<Hypothesis> found = selection.FromAnyStart({softer(0.02), load, softer(-0.3), softer(0.2)});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->effects.front().ToString(), softer(0.0).ToString());
  EXPECT_NEAR(found->effects.front().parameters.front(), -0.17, 0.01);
}

}  // namespace
}  // namespace dynoproof::diagnosis
