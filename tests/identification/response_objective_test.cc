// What is fitted to a frequency response: nothing is missed at the truth, and something beside it.
#include "identification/response_objective.h"

#include <gtest/gtest.h>

#include "tests/identification/response_misfits.h"

namespace dynoproof::identification {
namespace {

// The hold of the input would be 6 % in gain and 0.6 in phase at 2000 Hz.
TEST_F(ResponseMisfits, TheCurveIsMetAtTheTruthAndMissedBesideIt) {
  const Result<MeasuredCurve> measured = MeasuredResponse(problem_);
  ASSERT_TRUE(measured.ok()) << measured.failure().ToString();
  const std::unique_ptr<Objective> curve = ResponseObjective(problem_, measured->response);
  ASSERT_GT(curve->size(), 400);
  const double at_truth = Missed(*curve, kStiffness, 1.0);
  EXPECT_LT(at_truth, 0.02);
  for (const double factor : {0.97, 1.03}) EXPECT_GT(Missed(*curve, kStiffness, factor), 3.0 * at_truth) << factor;
}

TEST_F(ResponseMisfits, WithoutWhatAResponseNeedsThereIsNone) {
  Plan plan = *plan_;
  ASSERT_TRUE(std::erase_if(plan.root.table(), [](const Value::Entry& entry) { return entry.key == "analysis"; }) > 0);
  const Result<MeasuredCurve> no_analysis = MeasuredResponse(EstimationProblem(plan, {Chirp()}, registry_));
  ASSERT_FALSE(no_analysis.ok());
  EXPECT_EQ(no_analysis.failure().exit_code, 2);
  MappedRecord constant = Chirp();
  constant.inputs["T_airgap"].values = Shared(std::vector<double>(20001, 100.0));
  const Result<MeasuredCurve> no_excitation = MeasuredResponse(EstimationProblem(*plan_, {constant}, registry_));
  ASSERT_FALSE(no_excitation.ok());
  EXPECT_NE(no_excitation.failure().message.find("no frequency response"), std::string::npos);
}

}  // namespace
}  // namespace dynoproof::identification
