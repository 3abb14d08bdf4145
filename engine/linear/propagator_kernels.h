// The inner loops of a propagation step, once for each class of vector instructions. Internal to Propagator.
#pragma once

#include "base/cpu.h"
#include "linear/modal_form.h"

namespace dynoproof::mechanics {

/// Lets a step live on the stack.
inline constexpr int kMaxBlock = 1024;

/// The part of the state, in doubles and multiples of StateLayout::kGroup, outside of which rows are zero.
struct Range {
  int begin = 0, end = 0;
};

/// Rows over the state, four at a time (one range each four), and over the inputs.
struct RowSet {
  const double* values = nullptr;  // count x stride
  const double* direct = nullptr;  // count x columns, or null where all are zero
  const Range* ranges = nullptr;   // of rows 4 i .. 4 i + 3
  int count = 0, stride = 0, columns = 0;
};

struct LargerBlock {
  const double* phi = nullptr;   // size columns of `stride` (padded) rows
  const double* gain = nullptr;  // columns x stride
  int begin = 0, size = 0, stride = 0;
};

/// Everything a step reads; m inputs.
struct StepPlan {
  static constexpr int kGroup = StateLayout::kGroup;
  static constexpr int kGainsInRecord = 3 * kGroup;

  /// One record for each group of pairs: kGroup values each of a, of b (Phi = [a b; -b a]), of the first output's
  /// weight of the first coordinate, then for each column the gains of the first and of the second coordinates.
  const double* pair_records = nullptr;
  long record_size = 0;
  long double_groups = 0, last_pairs = 0;  // pairs = 2 kGroup double_groups + last_pairs
  long real_begin = 0;
  int reals = 0, real_stride = 0;
  const double *real_phi = nullptr, *real_gain = nullptr;
  const LargerBlock* larger = nullptr;
  int larger_count = 0;
  int integrator_begin = 0;
  RowSet integrators;  // increments of p from the state before the step
  RowSet outputs;      // direct: D, m columns
  Range output_rest;   // of the first output, beyond the first coordinates of the pairs
  /// Set for the usual drive line (one real eigenvalue, one integrator of it alone, no larger block): Phi, the
  /// integrator's increment by the old state, then for each column the gains of both.
  const double* rigid_record = nullptr;
  /// For each input the state at the end of the interval per unit held, then per unit at the end of a ramp.
  const double* responses = nullptr;  // 2 m x state_size
  int state_size = 0;
};

/// One interval under u [m] held: the state is replaced.
using AdvanceKernel = void (*)(const StepPlan& plan, double* state, const double* u, int inputs);
/// The same for a plan with one output, returning the output at the end.
using AdvanceAndOutputKernel = double (*)(const StepPlan& plan, double* state, const double* u, int inputs);
/// Adds to the state what `input` would have added, held and as a ramp.
using RespondKernel = void (*)(const StepPlan& plan, double* state, int input, double held, double ramp);
/// y [r] of the state and of u [m].
using OutputKernel = void (*)(const StepPlan& plan, const double* state, const double* u, double* y);

/// Adds to the state the columns [state_size x count], each times its factor.
using AddKernel = void (*)(const StepPlan& plan, const double* columns, const double* factors, int count,
                           double* state);

/// Indices: whether the plan has a rigid_record; number of inputs where it is 1 or 2, else 0 for any.
struct Kernels {
  AdvanceKernel advance[2][3];
  AdvanceAndOutputKernel advance_and_output[2][3];
  OutputKernel output;
  RespondKernel respond;
  AddKernel add;

  static int Variant(int inputs) { return inputs <= 2 ? inputs : 0; }
};

const Kernels& KernelsFor(CpuClass cpu_class);

}  // namespace dynoproof::mechanics
