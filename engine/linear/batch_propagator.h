// Variants of one linear system propagated side by side: each lane of a vector is a variant. What Propagator does for
// one state with its modes in the lanes, this does for kLanes states with the variants in the lanes; no sum crosses
// lanes, and a handful of modes fills the vectors as well as many do.
#pragma once

#include <span>
#include <vector>

#include "base/cpu.h"
#include "base/status.h"
#include "linear/aligned_vector.h"
#include "linear/modal_form.h"

namespace dynoproof::mechanics {

/// What a step reads; kLanes numbers each. Rows are the outputs, then the integrators that they see.
struct BatchPlan {
  static constexpr int kLanes = 8;
  static constexpr int kMostRows = 8;
  int pairs = 0, reals = 0, inputs = 0, outputs = 0, integrators = 0;
  const double* pair_records = nullptr;   // each: a, b; gains of both coordinates by input; weights of both by row
  const double* real_records = nullptr;   // each: phi; gains by input; weights by row
  const double* direct = nullptr;         // rows x inputs: D; of an integrator its growth by a held input
  const double* by_integrator = nullptr;  // outputs x integrators: E
};
using BatchKernel = void (*)(const BatchPlan& plan, double* state, const double* held, const double* u, double* y);

class BatchPropagator {
 public:
  static constexpr int kLanes = BatchPlan::kLanes;

  /// Whether a form can take part: pairs and real eigenvalues only.
  static bool Takes(const ModalForm& form);

  /// 1 to kLanes forms of variants, with as many inputs and outputs each; those of fewer modes are filled up with
  /// zeros, which changes no bit of a lane. `outputs`: the rows of the forms that are wanted, at most
  /// BatchPlan::kMostRows with the integrators they see. Fails (exit code 2) on anything else.
  static Result<BatchPropagator> Create(std::span<const ModalForm* const> forms, double interval_s,
                                        std::span<const int> outputs, CpuClass cpu_class = DetectCpuClass());

  BatchPropagator(BatchPropagator&&) = default;  // a copy's plan would point into the original

  int pairs() const { return plan_.pairs; }
  /// Doubles of a state, for all lanes; zeros at first.
  std::size_t state_size() const {
    return static_cast<std::size_t>(2 * plan_.pairs + plan_.reals + plan_.integrators) * kLanes;
  }
  /// Puts a lane's x and p into the state.
  void SetState(int lane, const ModalForm& form, const Eigen::VectorXd& x, const Eigen::VectorXd& p,
                std::span<double> state) const;

  /// y [outputs x kLanes] of the state and of the input `held` so far; then one interval with `u` held. Inputs are
  /// [inputs x kLanes].
  void Step(std::span<double> state, const double* held, const double* u, double* y) const {
    kernel_(plan_, state.data(), held, u, y);
  }

 private:
  BatchPropagator() = default;
  BatchPlan plan_;
  std::vector<int> integrators_;  // of the forms, that are carried
  AlignedVector values_;
  BatchKernel kernel_ = nullptr;
};

}  // namespace dynoproof::mechanics
