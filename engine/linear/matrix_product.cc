#include "linear/matrix_product.h"

#include <algorithm>
#include <cassert>

#include "linear/aligned_vector.h"
#include "linear/simd.h"

namespace dynoproof::mechanics {
namespace {

constexpr int kColumns = 4;  // of B at a time

/// out (2 W x 4, by column) = a (depth columns of 2 W) times four columns of B.
template <class V>
DYNOPROOF_INLINE void Panel(const double* a, const double* const* b, long depth, double* out) {
  constexpr int kWidth = V::kWidth;
  typename V::Type low0 = {}, low1 = {}, low2 = {}, low3 = {}, high0 = {}, high1 = {}, high2 = {}, high3 = {};
  for (long k = 0; k < depth; ++k, a += 2 * kWidth) {
    const typename V::Type low = Load<V>(a), high = Load<V>(a + kWidth);
    const double b0 = b[0][k], b1 = b[1][k], b2 = b[2][k], b3 = b[3][k];
    low0 += low * b0, high0 += high * b0;
    low1 += low * b1, high1 += high * b1;
    low2 += low * b2, high2 += high * b2;
    low3 += low * b3, high3 += high * b3;
  }
  Store<V>(out, low0), Store<V>(out + kWidth, high0);
  Store<V>(out + 2 * kWidth, low1), Store<V>(out + 3 * kWidth, high1);
  Store<V>(out + 4 * kWidth, low2), Store<V>(out + 5 * kWidth, high2);
  Store<V>(out + 6 * kWidth, low3), Store<V>(out + 7 * kWidth, high3);
}

using PanelKernel = void (*)(const double* a, const double* const* b, long depth, double* out);

void PanelBaseline(const double* a, const double* const* b, long depth, double* out) {
  Panel<Vector<2>>(a, b, depth, out);
}
#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] void PanelAvx2(const double* a, const double* const* b, long depth, double* out) {
  Panel<Vector<4>>(a, b, depth, out);
}
#if defined(__clang__)  // which takes explicit vectors at their width, and does not know the word
#define DYNOPROOF_WIDE ""
#else
#define DYNOPROOF_WIDE ",prefer-vector-width=512"
#endif
[[gnu::target("avx512f,avx512vl,avx512dq,fma" DYNOPROOF_WIDE)]] void PanelAvx512(const double* a,
                                                                                 const double* const* b, long depth,
                                                                                 double* out) {
  Panel<Vector<8>>(a, b, depth, out);
}
#endif

}  // namespace

Eigen::MatrixXd Multiply(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, CpuClass cpu_class) {
  assert(A.cols() == B.rows());
  PanelKernel kernel = PanelBaseline;
  long tall = 4;
#if defined(__x86_64__)
  if (cpu_class == CpuClass::kAvx2Fma) kernel = PanelAvx2, tall = 8;
  if (cpu_class == CpuClass::kAvx512) kernel = PanelAvx512, tall = 16;
#else
  static_cast<void>(cpu_class);
#endif
  const long rows = A.rows(), depth = A.cols(), columns = B.cols();
  Eigen::MatrixXd C(rows, columns);
  AlignedVector strip(static_cast<std::size_t>(tall * depth)), out(static_cast<std::size_t>(tall * kColumns));
  for (long row = 0; row < rows; row += tall) {
    const long height = std::min(tall, rows - row);
    for (long k = 0; k < depth; ++k) std::copy_n(A.data() + k * rows + row, height, strip.data() + k * tall);
    for (long column = 0; column < columns; column += kColumns) {
      const double* b[kColumns];
      for (long j = 0; j < kColumns; ++j) b[j] = B.data() + std::min(column + j, columns - 1) * depth;
      kernel(strip.data(), b, depth, out.data());
      for (long j = 0; j < kColumns && column + j < columns; ++j)
        std::copy_n(out.data() + j * tall, height, C.data() + (column + j) * rows + row);
    }
  }
  return C;
}

}  // namespace dynoproof::mechanics
