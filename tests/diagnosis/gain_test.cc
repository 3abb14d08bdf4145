// How far predictions are from a measurement, where its last part stands still and where it has few rows.
#include "diagnosis/gain.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tests/support/registry.h"
#include "tests/support/run_plan.h"

namespace dynoproof::diagnosis {
namespace {

/// A speed that is `value(i)` in the i-th of so many samples, 10 ms apart.
template <class Value>
EstimationProblem RecordedAs(int samples, const Value& value) {
  std::vector<double> time, speed, torque;
  for (int i = 0; i < samples; ++i) {
    time.push_back(0.01 * i);
    speed.push_back(value(i));
    torque.push_back(0.0);
  }
  const auto shared = [](std::vector<double> values) {
    return std::make_shared<const std::vector<double>>(std::move(values));
  };
  MappedRecord record;
  const auto clock = shared(time);
  record.inputs["T"] = {clock, shared(torque)};
  record.outputs["w"] = {clock, shared(speed)};
  record.end_s = time.back();
  return {testing::OneMass(1.0, dynoproof::Value{{"type", "constant"}, {"value", 0.0}}), {record}, testing::BuiltIns()};
}

// It swings between -1 and 1 up to the hold-out, and stands at 0 there: a spread of 1e-12 of what is usual made 1e11 of this error.
TEST(Gain, IsToldByTheWholeRecordWhereTheHoldOutStandsStill) {
  const EstimationProblem problem = RecordedAs(100, [](int i) { return i < 70 ? (i % 2 == 0 ? 1.0 : -1.0) : 0.0; });
  const Eigen::VectorXd off = Eigen::VectorXd::Constant(100, 0.5), right = problem.measured();
  const auto gains = GainsOf(problem, off, right, 0.7);
  ASSERT_EQ(gains.size(), 1U);
  const SignalGain& gain = gains.at("w");
  EXPECT_NEAR(gain.before, 0.5 / (0.01 * problem.channels().front().spread), 1e-9);
  EXPECT_EQ(gain.after, 0.0);
  EXPECT_NEAR(gain.lower, gain.before, 1e-9);
  EXPECT_NEAR(ExplainedShare(problem, off, right, 0.7)->value, 1.0, 1e-12);
}

TEST(Gain, OfThirtyRowsHasAShareToo) {
  const EstimationProblem problem = RecordedAs(100, [](int i) { return i % 2 == 0 ? 1.0 : -1.0; });
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(100), half = 0.5 * problem.measured();
  const std::optional<Share> share = ExplainedShare(problem, none, half, 0.7);
  ASSERT_TRUE(share.has_value());
  EXPECT_NEAR(share->value, 0.75, 1e-12);
  EXPECT_NEAR(share->lower, 0.75, 1e-12) << "every block is like the others";
  EXPECT_FALSE(ExplainedShare(problem, none, half, 0.92).has_value()) << "eight rows are no two blocks";
}

}  // namespace
}  // namespace dynoproof::diagnosis
