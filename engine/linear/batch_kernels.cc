#include "linear/batch_kernels.h"

#include "linear/simd.h"

namespace dynoproof::mechanics {
namespace {

constexpr int kLanes = BatchPlan::kLanes;

/// The lanes [lane, lane + W) of a step with ROWS rows and INPUTS inputs (0: any number).
template <int W, int ROWS, int INPUTS>
DYNOPROOF_INLINE void StepLanes(const BatchPlan& plan, double* state, const double* held, const double* u, double* y,
                                int lane) {
  using Doubles = Vector<W>;
  using V = typename Doubles::Type;
  const int rows = ROWS > 0 ? ROWS : plan.outputs + plan.integrators;
  const int inputs = INPUTS > 0 ? INPUTS : plan.inputs;
  V sums[ROWS > 0 ? ROWS : BatchPlan::kMostRows] = {};
  V force[INPUTS > 0 ? INPUTS : 1];
  for (int j = 0; j < INPUTS; ++j) force[j] = Load<Doubles>(u + j * kLanes + lane);
  const double* record = plan.pair_records + lane;
  double* x = state + lane;
  for (int pair = 0; pair < plan.pairs; ++pair) {
    const V first = Load<Doubles>(x), second = Load<Doubles>(x + kLanes);
    const V a = Load<Doubles>(record), b = Load<Doubles>(record + kLanes);
    record += 2 * kLanes;
    V next_first = a * first + b * second, next_second = a * second - b * first;
    for (int j = 0; j < inputs; ++j) {
      const V now = INPUTS > 0 ? force[j] : Load<Doubles>(u + j * kLanes + lane);
      next_first = Load<Doubles>(record) * now + next_first;
      next_second = Load<Doubles>(record + kLanes) * now + next_second;
      record += 2 * kLanes;
    }
    for (int row = 0; row < rows; ++row) {
      sums[row] = Load<Doubles>(record) * first + sums[row];
      sums[row] = Load<Doubles>(record + kLanes) * second + sums[row];
      record += 2 * kLanes;
    }
    Store<Doubles>(x, next_first);
    Store<Doubles>(x + kLanes, next_second);
    x += 2 * kLanes;
  }
  record = plan.real_records + lane;
  for (int real = 0; real < plan.reals; ++real) {
    const V old = Load<Doubles>(x);
    V next = Load<Doubles>(record) * old;
    record += kLanes;
    for (int j = 0; j < inputs; ++j) {
      next = Load<Doubles>(record) * Load<Doubles>(u + j * kLanes + lane) + next;
      record += kLanes;
    }
    for (int row = 0; row < rows; ++row) {
      sums[row] = Load<Doubles>(record) * old + sums[row];
      record += kLanes;
    }
    Store<Doubles>(x, next);
    x += kLanes;
  }
  for (int row = 0; row < rows; ++row) {
    const bool output = row < plan.outputs;
    for (int j = 0; j < inputs; ++j) {
      const double* v = (output ? held : u) + j * kLanes + lane;
      sums[row] = Load<Doubles>(plan.direct + (row * inputs + j) * kLanes + lane) * Load<Doubles>(v) + sums[row];
    }
    for (int i = 0; output && i < plan.integrators; ++i)
      sums[row] = Load<Doubles>(plan.by_integrator + (row * plan.integrators + i) * kLanes + lane) *
                      Load<Doubles>(x + i * kLanes) +
                  sums[row];
    if (output) Store<Doubles>(y + row * kLanes + lane, sums[row]);
  }
  for (int i = 0; i < plan.integrators; ++i)
    Store<Doubles>(x + i * kLanes, Load<Doubles>(x + i * kLanes) + sums[plan.outputs + i]);
}

template <int W, int ROWS, int INPUTS>
DYNOPROOF_INLINE void StepAll(const BatchPlan& plan, double* state, const double* held, const double* u, double* y) {
  for (int lane = 0; lane < kLanes; lane += W) StepLanes<W, ROWS, INPUTS>(plan, state, held, u, y, lane);
}

#define DYNOPROOF_BATCH_KERNELS(NAME, W, TARGET)                                                                 \
  template <int ROWS, int INPUTS>                                                                                \
  TARGET void Step##NAME(const BatchPlan& plan, double* state, const double* held, const double* u, double* y) { \
    StepAll<W, ROWS, INPUTS>(plan, state, held, u, y);                                                           \
  }                                                                                                              \
  constexpr BatchKernel k##NAME[] = {Step##NAME<0, 0>, Step##NAME<1, 1>, Step##NAME<2, 1>, Step##NAME<3, 1>,     \
                                     Step##NAME<4, 1>}

DYNOPROOF_BATCH_KERNELS(Baseline, 2, );
#if defined(__x86_64__)
DYNOPROOF_BATCH_KERNELS(Avx2Fma, 4, __attribute__((target("avx2,fma"))));
DYNOPROOF_BATCH_KERNELS(Avx512, 8, __attribute__((target("avx2,fma,avx512f,avx512dq,avx512vl"))));
#endif

}  // namespace

BatchKernel BatchKernelFor([[maybe_unused]] CpuClass cpu_class, int rows, int inputs) {
  const int variant = inputs == 1 && 1 <= rows && rows <= 4 ? rows : 0;
#if defined(__x86_64__)
  if (cpu_class == CpuClass::kAvx512) return kAvx512[variant];
  if (cpu_class == CpuClass::kAvx2Fma) return kAvx2Fma[variant];
#endif
  return kBaseline[variant];
}

}  // namespace dynoproof::mechanics
