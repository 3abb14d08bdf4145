// A propagation step must not touch the heap.
#include <gtest/gtest.h>

#include "linear/aligned_vector.h"
#include "linear/energy_coordinates.h"
#include "linear/propagator.h"
#include "tests/support/count_allocations.h"
#include "tests/support/plants.h"

namespace dynoproof::mechanics {
namespace {

using dynoproof::testing::allocations;

/// Every path of a step: pairs, real eigenvalues, a larger block, one and several integrators and outputs.
LinearSystem Everything() {
  LinearSystem system;
  system.A = Eigen::MatrixXd::Zero(6, 6);
  system.A.topLeftCorner(2, 2) << 0.0, 500.0, -500.0, -1.0;
  system.A(2, 2) = -3.0;
  system.A.bottomRightCorner(2, 2) << 0.0, 300.0, -300.0, -600.0;
  system.B = Eigen::MatrixXd::Ones(6, 2);
  system.C = Eigen::MatrixXd::Ones(5, 6);
  system.P = Eigen::MatrixXd::Ones(2, 6);
  system.E = Eigen::MatrixXd::Ones(5, 2);
  system.D = Eigen::MatrixXd::Ones(5, 2);
  return system;
}

TEST(PropagatorHeap, StepsDoNotAllocate) {
  const auto coordinates = EnergyCoordinates::Build(support::SoftRotorR2R(), support::AirgapR2R());
  ASSERT_TRUE(coordinates.ok());
  for (const LinearSystem& system : {coordinates->System({coordinates->EdgeTorque(70)}), Everything()}) {
    const ModalForm form = ModalForm::Build(system);
    const auto propagator = Propagator::Create(form, 1e-4);
    ASSERT_TRUE(propagator.ok());
    AlignedVector state(propagator->state_size());
    const std::vector<double> u(form.inputs(), 1.0);
    std::vector<double> y(form.outputs());
    const long before = allocations;
    for (int k = 0; k < 10; ++k) {
      propagator->Advance(state, u);
      propagator->AdvanceRamp(state, u, u);
      propagator->Output(state, u, y);
      propagator->AdvanceAndOutput(state, u, y);
    }
    EXPECT_EQ(allocations - before, 0);
    const std::vector<double> more(100);
    EXPECT_GT(allocations - before, 0);  // the counter does count
    EXPECT_NE(y[0], 0.0);
  }
}

}  // namespace
}  // namespace dynoproof::mechanics
