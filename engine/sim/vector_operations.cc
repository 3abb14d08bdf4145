#include "sim/vector_operations.h"

#include <algorithm>
#include <cmath>

namespace dynoproof {
namespace {

sunindextype Size(N_Vector vector) { return NV_LENGTH_S(vector); }
double* Data(N_Vector vector) { return NV_DATA_S(vector); }

/// z_i = f(x_i), z_i = f(x_i, y_i): z may be one of the others.
template <class Function>
void Each(N_Vector x, N_Vector result, Function f) {
  const double* const from = Data(x);
  double* const to = Data(result);
  const sunindextype n = Size(result);
  for (sunindextype i = 0; i < n; ++i) to[i] = f(from[i]);
}
template <class Function>
void Each(N_Vector x, N_Vector y, N_Vector result, Function f) {
  const double *const left = Data(x), *const right = Data(y);
  double* const to = Data(result);
  const sunindextype n = Size(result);
  for (sunindextype i = 0; i < n; ++i) to[i] = f(left[i], right[i]);
}

// Wider registers where a CPU has them: each number is formed by the same operations in the same order, and AVX2 alone has no
// fused multiplication, so both forms give the same bits.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define DYNOPROOF_WIDER __attribute__((target_clones("avx2", "default")))
#else
#define DYNOPROOF_WIDER
#endif

/// Equal factors are applied to the sum, as SUNDIALS does it, unless they are 1 or -1 and nothing is rounded.
void LinearSum(double a, N_Vector x, double b, N_Vector y, N_Vector result) {
  const bool exact = std::abs(a) == 1.0 || std::abs(b) == 1.0;
  if (!exact && a == b) {
    Each(x, y, result, [a](double left, double right) { return a * (left + right); });
  } else if (!exact && a == -b) {
    Each(x, y, result, [a](double left, double right) { return a * (left - right); });
  } else {
    Each(x, y, result, [a, b](double left, double right) { return a * left + b * right; });
  }
}

/// z = sum c_i x_i over all vectors in one pass.
DYNOPROOF_WIDER int LinearCombination(int count, double* factors, N_Vector* vectors, N_Vector result) {
  constexpr int kMost = 16;
  if (count > kMost) return -1;
  const double* x[kMost];
  for (int i = 0; i < count; ++i) x[i] = Data(vectors[i]);
  double* z = Data(result);
  const sunindextype n = Size(result);
  constexpr int kStrip = 16;  // kept in registers while all vectors are added
  sunindextype k = 0;
  for (; k + kStrip <= n; k += kStrip) {
    double sum[kStrip] = {};
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < kStrip; ++j) sum[j] += factors[i] * x[i][k + j];
    }
    for (int j = 0; j < kStrip; ++j) z[k + j] = sum[j];
  }
  for (; k < n; ++k) {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) sum += factors[i] * x[i][k];
    z[k] = sum;
  }
  return 0;
}

double WeightedSquares(N_Vector x, N_Vector weights) {
  const double *const value = Data(x), *const weight = Data(weights);
  const sunindextype n = Size(x);
  double sum = 0.0;
  for (sunindextype i = 0; i < n; ++i) sum += (value[i] * weight[i]) * (value[i] * weight[i]);
  return sum;
}

}  // namespace

void UseOwnOperations(N_Vector vector) {
  auto& ops = *vector->ops;
  ops.nvlinearsum = LinearSum;
  ops.nvlinearcombination = LinearCombination;
  ops.nvconst = [](double c, N_Vector z) { std::fill_n(Data(z), Size(z), c); };
  ops.nvprod = [](N_Vector x, N_Vector y, N_Vector z) { Each(x, y, z, [](double a, double b) { return a * b; }); };
  ops.nvdiv = [](N_Vector x, N_Vector y, N_Vector z) { Each(x, y, z, [](double a, double b) { return a / b; }); };
  ops.nvscale = [](double c, N_Vector x, N_Vector z) { Each(x, z, [c](double a) { return c * a; }); };
  ops.nvabs = [](N_Vector x, N_Vector z) { Each(x, z, [](double a) { return std::abs(a); }); };
  ops.nvinv = [](N_Vector x, N_Vector z) { Each(x, z, [](double a) { return 1.0 / a; }); };
  ops.nvaddconst = [](N_Vector x, double b, N_Vector z) { Each(x, z, [b](double a) { return a + b; }); };
  ops.nvwsqrsumlocal = WeightedSquares;
  ops.nvwrmsnorm = [](N_Vector x, N_Vector weights) {
    return std::sqrt(WeightedSquares(x, weights) / static_cast<double>(Size(x)));
  };
}

}  // namespace dynoproof
