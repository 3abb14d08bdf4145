// Products of dense matrices of a few hundred rows in the machine's widest vectors. The program is built for the oldest
// x86-64, and so is Eigen in it; decompositions are made of these products.
#pragma once

#include <Eigen/Dense>

#include "base/cpu.h"

namespace dynoproof::mechanics {

/// A B. The same bits on the same class only.
Eigen::MatrixXd Multiply(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, CpuClass cpu_class = DetectCpuClass());

}  // namespace dynoproof::mechanics
