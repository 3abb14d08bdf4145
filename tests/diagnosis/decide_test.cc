// What may not stand although nobody explains the data better.

#include "diagnosis/decide.h"

#include <gtest/gtest.h>

#include "tests/diagnosis/line_record.h"
#include "tests/diagnosis/lumped_line.h"

namespace dynoproof::diagnosis {
namespace {

using LeavesTheSignal = LumpedLine;

// As the measurement would be if the model missed so much of each channel's motion.
TEST_F(LeavesTheSignal, WhereMostOfItIsMissedInTheChannelThatGainsMost) {
  ASSERT_TRUE(plan_);
  const Study study(*plan_, {LineRecord(blind::IndependentLine(), blind::IndependentTorque(2001, 7), 0.003)},
                    registry_);
  const auto missing = [&](double torque, double speed) {
    Fit fit;
    fit.predicted = study.measured();
    for (const Channel& c : study.channels()) {
      for (Eigen::Index i = 0; i < c.count; ++i)
        fit.predicted[c.begin + i] += (i % 2 == 0 ? 1.0 : -1.0) * c.spread * (c.name == "T_shaft" ? torque : speed);
    }
    return fit;
  };
  EXPECT_TRUE(dynoproof::diagnosis::LeavesTheSignal(study, missing(1.4, 0.01), missing(0.9, 0.01)));
  // A small effect under little noise, a large one under much, and a channel of noise alone beside one that gains.
  EXPECT_FALSE(dynoproof::diagnosis::LeavesTheSignal(study, missing(0.011, 0.01), missing(0.01, 0.01)));
  EXPECT_FALSE(dynoproof::diagnosis::LeavesTheSignal(study, missing(3.0, 0.01), missing(0.9, 0.01)));
  EXPECT_FALSE(dynoproof::diagnosis::LeavesTheSignal(study, missing(2.9, 0.57), missing(0.01, 0.56)));
}

}  // namespace
}  // namespace dynoproof::diagnosis
