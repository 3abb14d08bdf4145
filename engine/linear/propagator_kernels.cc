#include "linear/propagator_kernels.h"

#include "linear/simd.h"

// Keeps a value that is used twice in its register. GCC 12 would fold the load into both uses, and these loops are
// bound by their loads. It emits no instruction.
#if defined(__x86_64__) && !defined(__clang__)
#define DYNOPROOF_KEEP(value) asm("" : "+v"(value))
#else
#define DYNOPROOF_KEEP(value) static_cast<void>(0)
#endif

namespace dynoproof::mechanics {
namespace {

using Vector2 = Vector<2>;
using Vector4 = Vector<4>;
using Vector8 = Vector<8>;

DYNOPROOF_INLINE double Sum(const Vector2::Type& v) { return v[0] + v[1]; }
DYNOPROOF_INLINE double Sum(const Vector4::Type& v) {
  return Sum(__builtin_shufflevector(v, v, 0, 1) + __builtin_shufflevector(v, v, 2, 3));
}
DYNOPROOF_INLINE double Sum(const Vector8::Type& v) {
  return Sum(__builtin_shufflevector(v, v, 0, 1, 2, 3) + __builtin_shufflevector(v, v, 4, 5, 6, 7));
}

/// Adds rows [row, row + R) over the state to sum[0..R), R <= 4. The totals have names because an array of them would
/// live in memory.
template <class V, int R>
DYNOPROOF_INLINE void Dot(const RowSet& rows, int row, Range range, const double* state, double* sum) {
  const long stride = R > 1 ? rows.stride : 0;
  const double* values = rows.values + static_cast<long>(row) * rows.stride;
  typename V::Type total0 = {}, total1 = {}, total2 = {}, total3 = {};
  for (int i = range.begin; i < range.end; i += V::kWidth) {
    const typename V::Type x = Load<V>(state + i);
    total0 = Load<V>(values + i) * x + total0;
    if constexpr (R > 1) total1 = Load<V>(values + stride + i) * x + total1;
    if constexpr (R > 2) total2 = Load<V>(values + 2 * stride + i) * x + total2;
    if constexpr (R > 3) total3 = Load<V>(values + 3 * stride + i) * x + total3;
  }
  sum[0] += Sum(total0);
  if constexpr (R > 1) sum[1] += Sum(total1);
  if constexpr (R > 2) sum[2] += Sum(total2);
  if constexpr (R > 3) sum[3] += Sum(total3);
}

/// sum[i] += row i of the inputs.
DYNOPROOF_INLINE void AddDirect(const RowSet& rows, int row, const double* u, int columns, double* sum) {
  double total = sum[row];
  for (int j = 0; j < columns; ++j) total = rows.direct[row * rows.columns + j] * u[j] + total;
  sum[row] = total;
}

/// sum[i] += row i of the state and of the first `columns` inputs.
template <class V>
DYNOPROOF_INLINE void AddRows(const RowSet& rows, const double* state, const double* u, int columns, double* sum) {
  for (int row = 0; row < rows.count; row += 4) {
    const Range range = rows.ranges[row / 4];
    switch (rows.count - row) {
      case 1:
        Dot<V, 1>(rows, row, range, state, sum + row);
        break;
      case 2:
        Dot<V, 2>(rows, row, range, state, sum + row);
        break;
      case 3:
        Dot<V, 3>(rows, row, range, state, sum + row);
        break;
      default:
        Dot<V, 4>(rows, row, range, state, sum + row);
    }
  }
  if (rows.direct == nullptr) return;
  for (int row = 0; row < rows.count; ++row) AddDirect(rows, row, u, columns, sum);
}

/// The inputs as the loop over the pairs reads them: M of them in registers, or (M = 0) any number in memory.
template <int M>
struct HeldInputs {
  const double* memory;
  int columns;
  double value[M > 0 ? M : 1];
};

/// One vector of pairs at lane `lane` of a group; adds the first output's share to `total`. All addresses are one
/// pointer plus a constant: an indexed one would cost a micro-operation more.
template <class V, int M, bool kSum>
DYNOPROOF_INLINE void StepPairs(const double* record, double* group, int lane, const HeldInputs<M>& inputs,
                                typename V::Type& total) {
  constexpr int kGroup = StepPlan::kGroup;
  typename V::Type first = Load<V>(group + lane), second = Load<V>(group + kGroup + lane);
  typename V::Type a = Load<V>(record + lane), b = Load<V>(record + kGroup + lane);
  DYNOPROOF_KEEP(first);
  DYNOPROOF_KEEP(second);
  DYNOPROOF_KEEP(a);
  DYNOPROOF_KEEP(b);
  const double* u = M > 0 ? inputs.value : inputs.memory;
  const int columns = M > 0 ? M : inputs.columns;
  const double* gain = record + StepPlan::kGainsInRecord + lane;
  typename V::Type force_first = {}, force_second = {};
  for (int j = 0; j < columns; ++j) {
    const bool start = M > 0 && j == 0;  // known to the compiler: it saves an addition to zero
    force_first = start ? Load<V>(gain) * u[j] : Load<V>(gain) * u[j] + force_first;
    force_second = start ? Load<V>(gain + kGroup) * u[j] : Load<V>(gain + kGroup) * u[j] + force_second;
    gain += 2 * kGroup;
  }
  const typename V::Type next_first = a * first + (b * second + force_first);
  const typename V::Type next_second = a * second + (force_second - b * first);
  Store<V>(group + lane, next_first);
  Store<V>(group + kGroup + lane, next_second);
  if constexpr (kSum) total = Load<V>(record + 2 * kGroup + lane) * next_first + total;
}

/// A whole group of pairs; two totals in turn, because one would wait for its own latency.
template <class V, int M, bool kSum>
DYNOPROOF_INLINE void StepGroup(const double* record, double* group, const HeldInputs<M>& inputs,
                                typename V::Type& even, typename V::Type& odd) {
  constexpr int kWidth = V::kWidth;
  StepPairs<V, M, kSum>(record, group, 0, inputs, even);
  if constexpr (kWidth <= 4) StepPairs<V, M, kSum>(record, group, kWidth, inputs, odd);
  if constexpr (kWidth <= 2) StepPairs<V, M, kSum>(record, group, 2 * kWidth, inputs, even);
  if constexpr (kWidth <= 2) StepPairs<V, M, kSum>(record, group, 3 * kWidth, inputs, odd);
}

/// All pairs; with kSum the first output's sum over them.
template <class V, int M, bool kSum>
DYNOPROOF_INLINE double AllPairs(const StepPlan& plan, double* state, const double* u, int columns) {
  HeldInputs<M> inputs{u, columns, {}};
  for (int j = 0; j < M; ++j) inputs.value[j] = u[j];
  const double* record = plan.pair_records;
  const long record_size = plan.record_size;
  typename V::Type even = {}, odd = {};
  for (long twice = plan.double_groups; twice > 0; --twice) {
    StepGroup<V, M, kSum>(record, state, inputs, even, odd);
    record += record_size;
    StepGroup<V, M, kSum>(record, state + 2 * StepPlan::kGroup, inputs, odd, even);
    record += record_size;
    state += 4 * StepPlan::kGroup;
  }
  long left = plan.last_pairs;
  if (left > StepPlan::kGroup - V::kWidth) {
    StepGroup<V, M, kSum>(record, state, inputs, even, odd);
    record += record_size;
    state += 2 * StepPlan::kGroup;
    left -= StepPlan::kGroup;
  }
  for (int lane = 0; lane < left; lane += V::kWidth) StepPairs<V, M, kSum>(record, state, lane, inputs, even);
  return kSum ? Sum(even + odd) : 0.0;
}

/// K = 1 or 4 vectors of rows of one larger block, read from x, written to next.
template <class V, int K>
DYNOPROOF_INLINE void BlockRows(const LargerBlock& block, int row, const double* x, const double* u, int columns,
                                double* next) {
  constexpr int kWidth = V::kWidth;
  typename V::Type total0 = {}, total1 = {}, total2 = {}, total3 = {};
  for (int c = 0; c < block.size + columns; ++c) {
    const bool of_state = c < block.size;
    const double factor = of_state ? x[c] : u[c - block.size];
    const double* column = (of_state ? block.phi + static_cast<long>(c) * block.stride
                                     : block.gain + static_cast<long>(c - block.size) * block.stride) +
                           row;
    total0 = Load<V>(column) * factor + total0;
    if constexpr (K > 1) {
      total1 = Load<V>(column + kWidth) * factor + total1;
      total2 = Load<V>(column + 2 * kWidth) * factor + total2;
      total3 = Load<V>(column + 3 * kWidth) * factor + total3;
    }
  }
  Store<V>(next + row, total0);
  if constexpr (K > 1) {
    Store<V>(next + row + kWidth, total1);
    Store<V>(next + row + 2 * kWidth, total2);
    Store<V>(next + row + 3 * kWidth, total3);
  }
}

/// All but the pairs, kept out of the way of the usual drive line: integrators, larger blocks, real eigenvalues.
template <class V>
DYNOPROOF_INLINE void StepRare(const StepPlan& plan, double* state, const double* u, int columns) {
  AddRows<V>(plan.integrators, state, u, columns, state + plan.integrator_begin);
  for (int b = 0; b < plan.larger_count; ++b) {
    const LargerBlock block = plan.larger[b];
    double next[kMaxBlock];
    double* x = state + block.begin;
    int row = 0;
    for (; row + 4 * V::kWidth <= block.stride; row += 4 * V::kWidth) BlockRows<V, 4>(block, row, x, u, columns, next);
    for (; row < block.stride; row += V::kWidth) BlockRows<V, 1>(block, row, x, u, columns, next);
    for (int i = 0; i < block.stride; ++i) x[i] = next[i];
  }
  double* x = state + plan.real_begin;
  for (int i = 0; i < plan.reals; i += V::kWidth) {
    typename V::Type next = Load<V>(plan.real_phi + i) * Load<V>(x + i);
    for (int j = 0; j < columns; ++j) next = Load<V>(plan.real_gain + j * plan.real_stride + i) * u[j] + next;
    Store<V>(x + i, next);
  }
}

/// A rigid body and its angle.
template <int M>
DYNOPROOF_INLINE void StepRigid(const StepPlan& plan, double* state, const double* u, int columns) {
  const int inputs = M > 0 ? M : columns;
  const double* record = plan.rigid_record;
  double* body = state + plan.real_begin;
  const double speed = body[0];
  double next_speed = record[0] * speed;
  double next_angle = record[1] * speed + body[StepPlan::kGroup];
  for (int j = 0; j < inputs; ++j) {
    next_speed = record[2 + 2 * j] * u[j] + next_speed;
    next_angle = record[3 + 2 * j] * u[j] + next_angle;
  }
  body[0] = next_speed;
  body[StepPlan::kGroup] = next_angle;
}

/// One interval; with kSum the first output. What comes first needs the old state of the pairs. A plan with a single
/// rigid body makes no call: its function then needs no stack frame.
template <class V, int M, bool kRigid, bool kSum, AdvanceKernel kRare>
DYNOPROOF_INLINE double Step(const StepPlan& plan, double* state, const double* u, int columns) {
  if constexpr (kRigid) {
    StepRigid<M>(plan, state, u, columns);
  } else {
    kRare(plan, state, u, columns);
  }
  double sum = AllPairs<V, M, kSum>(plan, state, u, columns);
  if constexpr (kSum) {
    if (plan.output_rest.end > plan.output_rest.begin) Dot<V, 1>(plan.outputs, 0, plan.output_rest, state, &sum);
    if (plan.outputs.direct != nullptr) AddDirect(plan.outputs, 0, u, M > 0 ? M : columns, &sum);
  }
  return sum;
}

template <class V>
DYNOPROOF_INLINE void Outputs(const StepPlan& plan, const double* state, const double* u, double* y) {
  for (int i = 0; i < plan.outputs.count; ++i) y[i] = 0.0;
  AddRows<V>(plan.outputs, state, u, plan.outputs.columns, y);
}

template <class V>
DYNOPROOF_INLINE void AddResponse(const StepPlan& plan, double* state, int input, double held, double ramp) {
  const double* by_held = plan.responses + 2L * input * plan.state_size;
  const double* by_ramp = by_held + plan.state_size;
  for (int i = 0; i < plan.state_size; i += V::kWidth) {
    Store<V>(state + i, Load<V>(by_held + i) * held + (Load<V>(by_ramp + i) * ramp + Load<V>(state + i)));
  }
}

/// N columns at once, so that the state is read and written once for all of them. Factors and size are copied, because the
/// compiler would read them anew behind each write.
template <class V, int N>
DYNOPROOF_INLINE void AddSome(int size, const double* columns, const double* factors, double* state) {
  const double first = factors[0], second = factors[N - 1];
  const double* others = columns + static_cast<long>(N - 1) * size;
  for (int i = 0; i < size; i += V::kWidth) {
    typename V::Type next = Load<V>(columns + i) * first + Load<V>(state + i);
    if constexpr (N == 2) next = Load<V>(others + i) * second + next;
    Store<V>(state + i, next);
  }
}

template <class V>
DYNOPROOF_INLINE void AddColumns(const StepPlan& plan, const double* columns, const double* factors, int count,
                                 double* state) {
  const int size = plan.state_size;
  int j = 0;
  for (; j + 2 <= count; j += 2) AddSome<V, 2>(size, columns + static_cast<long>(j) * size, factors + j, state);
  if (j < count) AddSome<V, 1>(size, columns + static_cast<long>(j) * size, factors + j, state);
}

// The functions of one class of instructions. TARGET cannot be a template argument, hence the macro.
#define DYNOPROOF_KERNELS(NAME, V, TARGET)                                                                       \
  [[gnu::noinline]] TARGET void Rare##NAME(const StepPlan& plan, double* state, const double* u, int columns) {  \
    StepRare<V>(plan, state, u, columns);                                                                        \
  }                                                                                                              \
  template <int M, bool kRigid>                                                                                  \
  TARGET void Advance##NAME(const StepPlan& plan, double* state, const double* u, int columns) {                 \
    Step<V, M, kRigid, false, Rare##NAME>(plan, state, u, columns);                                              \
  }                                                                                                              \
  template <int M, bool kRigid>                                                                                  \
  TARGET double AdvanceAndOutput##NAME(const StepPlan& plan, double* state, const double* u, int columns) {      \
    return Step<V, M, kRigid, true, Rare##NAME>(plan, state, u, columns);                                        \
  }                                                                                                              \
  TARGET void Output##NAME(const StepPlan& plan, const double* state, const double* u, double* y) {              \
    Outputs<V>(plan, state, u, y);                                                                               \
  }                                                                                                              \
  TARGET void Respond##NAME(const StepPlan& plan, double* state, int input, double held, double ramp) {          \
    AddResponse<V>(plan, state, input, held, ramp);                                                              \
  }                                                                                                              \
  TARGET void Add##NAME(const StepPlan& plan, const double* columns, const double* factors, int count,           \
                        double* state) {                                                                         \
    AddColumns<V>(plan, columns, factors, count, state);                                                         \
  }                                                                                                              \
  constexpr Kernels k##NAME {                                                                                    \
    {{Advance##NAME<0, false>, Advance##NAME<1, false>, Advance##NAME<2, false>},                                \
     {Advance##NAME<0, true>, Advance##NAME<1, true>, Advance##NAME<2, true>}},                                  \
        {{AdvanceAndOutput##NAME<0, false>, AdvanceAndOutput##NAME<1, false>, AdvanceAndOutput##NAME<2, false>}, \
         {AdvanceAndOutput##NAME<0, true>, AdvanceAndOutput##NAME<1, true>, AdvanceAndOutput##NAME<2, true>}},   \
        Output##NAME, Respond##NAME, Add##NAME                                                                   \
  }

DYNOPROOF_KERNELS(Baseline, Vector2, );
#if defined(__x86_64__)
DYNOPROOF_KERNELS(Avx2Fma, Vector4, __attribute__((target("avx2,fma"))));
DYNOPROOF_KERNELS(Avx512, Vector8, __attribute__((target("avx2,fma,avx512f,avx512dq,avx512vl"))));
#endif

}  // namespace

const Kernels& KernelsFor([[maybe_unused]] CpuClass cpu_class) {
#if defined(__x86_64__)
  if (cpu_class == CpuClass::kAvx512) return kAvx512;
  if (cpu_class == CpuClass::kAvx2Fma) return kAvx2Fma;
#endif
  return kBaseline;
}

}  // namespace dynoproof::mechanics
