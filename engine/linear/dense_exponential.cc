#include <unsupported/Eigen/MatrixFunctions>

#include "linear/dense.h"

namespace dynoproof::dense {

Eigen::MatrixXd Exponential(const Eigen::MatrixXd& A) { return A.exp(); }

MatrixXld Exponential(const MatrixXld& A) { return A.exp(); }

}  // namespace dynoproof::dense
