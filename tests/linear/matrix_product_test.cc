#include "linear/matrix_product.h"

#include <gtest/gtest.h>

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;

TEST(MatrixProduct, IsEigensInEveryClassAndOfEveryShape) {
  for (const CpuClass cpu_class : {CpuClass::kBaseline, CpuClass::kAvx2Fma, CpuClass::kAvx512}) {
    if (cpu_class > DetectCpuClass()) continue;
    for (const int rows : {1, 3, 16, 17, 71}) {
      for (const int depth : {0, 1, 5, 40}) {
        for (const int columns : {1, 4, 6, 35}) {
          const MatrixXd A = MatrixXd::Random(rows, depth), B = MatrixXd::Random(depth, columns);
          const MatrixXd C = Multiply(A, B, cpu_class), expected = A * B;
          ASSERT_EQ(C.rows(), rows);
          ASSERT_EQ(C.cols(), columns);
          // Sums of up to 40 products below 1, in any order.
          EXPECT_LE((C - expected).cwiseAbs().maxCoeff(), 40 * 40 * 1.2e-16)
              << ToString(cpu_class) << " " << rows << " x " << depth << " x " << columns;
        }
      }
    }
  }
}

TEST(MatrixProduct, NotANumberStaysInItsRowAndColumn) {
  MatrixXd A = MatrixXd::Ones(9, 9), B = MatrixXd::Ones(9, 9);
  A(2, 3) = std::nan("");
  const MatrixXd C = Multiply(A, B);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) EXPECT_EQ(std::isnan(C(i, j)), i == 2);
  }
}

}  // namespace
}  // namespace dynoproof::mechanics
