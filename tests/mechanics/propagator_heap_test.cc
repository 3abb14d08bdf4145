// A propagation step must not touch the heap: this file replaces operator new for the whole test program and counts.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "mechanics/aligned_vector.h"
#include "mechanics/energy_coordinates.h"
#include "mechanics/propagator.h"
#include "tests/support/plants.h"

namespace {

std::atomic<long> allocations{0};

void* Allocate(std::size_t size, std::size_t alignment) {
  ++allocations;
  const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
  if (void* place = std::aligned_alloc(alignment, rounded > 0 ? rounded : alignment)) return place;
  throw std::bad_alloc();
}

}  // namespace

// Not inlined: the compiler would take free() for the wrong partner of new.
[[gnu::noinline]] void* operator new(std::size_t size) { return Allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__); }
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  return Allocate(size, static_cast<std::size_t>(alignment));
}
[[gnu::noinline]] void operator delete(void* place) noexcept { std::free(place); }
[[gnu::noinline]] void operator delete(void* place, std::size_t) noexcept { std::free(place); }
[[gnu::noinline]] void operator delete(void* place, std::align_val_t) noexcept { std::free(place); }
[[gnu::noinline]] void operator delete(void* place, std::size_t, std::align_val_t) noexcept { std::free(place); }

namespace dynoproof::mechanics {
namespace {

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
