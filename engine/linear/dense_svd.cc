#include <Eigen/SVD>

#include "linear/dense.h"

namespace dynoproof::dense {

using Eigen::MatrixXd;

namespace {
constexpr int kThin = Eigen::ComputeThinU | Eigen::ComputeThinV;
}  // namespace

Svd DividedSvd(const MatrixXd& A) {
  const Eigen::BDCSVD<MatrixXd> svd(A, kThin);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

Svd JacobiSvd(const MatrixXd& A) {
  const Eigen::JacobiSVD<MatrixXd> svd(A, kThin);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

Eigen::VectorXd SingularValues(const MatrixXd& A) { return Eigen::JacobiSVD<MatrixXd>(A).singularValues(); }

}  // namespace dynoproof::dense
