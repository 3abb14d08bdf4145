// Outputs at a shaft that transmits nothing to linear analysis: a clutch, a cubic spring, an edge of zeros.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "linear/branches.h"
#include "linear/zeros.h"

namespace dynoproof::mechanics {
namespace {

using ::testing::HasSubstr;

/// I1 - k1 - I2 - (open) - I3, as a line with a clutch is linearised.
Network Line(double stiffness = 0.0, double damping = 0.0) {
  return {{{"I1", 1.0}, {"I2", 0.5}, {"I3", 0.5}}, {{"k1", 0, 1, 1e4, 1.0}, {"clutch", 1, 2, stiffness, damping}}};
}

Eigen::VectorXd OnFirst() { return Eigen::VectorXd::Unit(3, 0); }

TEST(OpenShaft, IsInNeitherOfTheBranchesThatItJoins) {
  const Network line = Line();
  const std::vector<int> labels = Groups(line, -1, -1);
  EXPECT_EQ(labels, (std::vector<int>{0, 0, 1}));
  for (const int label : {0, 1}) {
    EXPECT_FALSE(TakeBranch(line, labels, label, CutEdges::kDrop).LocalEdge(1)) << label;
  }
  const Branch branch = TakeBranch(line, labels, 1, CutEdges::kDrop);
  EXPECT_FALSE(branch.LocalNode(0));
  EXPECT_EQ(branch.LocalNode(2), 0);
}

TEST(OpenShaft, IsNotReachedByTheInput) {
  const auto expect_not_reached = [](const Failure& failure) {
    EXPECT_THAT(failure.message, HasSubstr("does not reach"));
    EXPECT_EQ(failure.exit_code, 2);
  };
  Network line = Line();
  const Output torque{OutputKind::kEdgeTorque, 1};
  const auto zeros = TransferZeros(line, OnFirst(), torque);
  ASSERT_FALSE(zeros.ok());
  expect_not_reached(zeros.failure());
  const auto degree = RelativeDegree(line, OnFirst(), torque);
  ASSERT_FALSE(degree.ok());
  expect_not_reached(degree.failure());
  EXPECT_FALSE(IsFlatOutput(line, OnFirst(), torque).ok());
  // The same where other ways join its ends, where it ends at the ground, and where the open shaft lies on the way.
  line.edges.push_back({"beside", 1, 2, 2e4, 0.0});
  EXPECT_FALSE(TransferZeros(line, OnFirst(), torque).ok());
  line.edges[1].to = kGround;
  EXPECT_FALSE(TransferZeros(line, OnFirst(), torque).ok());
  for (const OutputKind kind : {OutputKind::kAngle, OutputKind::kSpeed}) {
    EXPECT_FALSE(TransferZeros(Line(), OnFirst(), {kind, 2}).ok());
  }
}

/// A damper alone transmits: zeros are there, but the undamped network, which the relative degree is of, has a gap.
TEST(OpenShaft, WithADamperAloneHasZerosAndNoDegree) {
  const Output torque{OutputKind::kEdgeTorque, 1};
  EXPECT_TRUE(TransferZeros(Line(0.0, 2.0), OnFirst(), torque).ok());
  EXPECT_FALSE(RelativeDegree(Line(0.0, 2.0), OnFirst(), torque).ok());
  EXPECT_FALSE(IsFlatOutput(Line(0.0, 2.0), OnFirst(), torque).ok());
  EXPECT_TRUE(RelativeDegree(Line(1e4), OnFirst(), torque).ok());
}

}  // namespace
}  // namespace dynoproof::mechanics
