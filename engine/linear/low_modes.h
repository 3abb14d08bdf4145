// The slow part of a large network: its lowest modes, and what forces do to all faster ones at rest. Of a soft rotor's 100 modes
// some twenty are left, before anything is decomposed.
#pragma once

#include <Eigen/Dense>

namespace dynoproof::mechanics {

/// Orthonormal columns (n x k, k well below n) for A = S^T S, S (springs x n) the spring forces by mass-normalised displacements: they
/// hold each mode below `limit` [rad/s] and the answer at rest to each column of `forces` (n x m), so that S restricted to them has
/// the first as they are and the second in modes beyond the limit (component modes with residual flexibility: MacNeal 1971, Rubin
/// 1975). They hold `shapes` (n x any) as they are. `rigid`: the unit vector with S rigid = 0 of a free part, to which all are
/// orthogonal; empty else. Empty where they would be most of n: then nothing is gained.
Eigen::MatrixXd LowModes(const Eigen::MatrixXd& S, const Eigen::VectorXd& rigid, const Eigen::MatrixXd& forces,
                         const Eigen::MatrixXd& shapes, double limit);

}  // namespace dynoproof::mechanics
