// The slow part of a large network: its lowest modes, and what forces do to all faster ones at rest. A soft rotor of 100 slices keeps
// some twenty modes, before it is decomposed.
#pragma once

#include <Eigen/Dense>

namespace dynoproof::mechanics {

/// `count` orthonormal columns (n x count) for A = S^T S, S (springs x n) the spring forces by mass-normalised displacements: of
/// S restricted to them the lowest modes are those of A, and the others together yield to each column of `forces` (n x m) as all the
/// faster modes of A do at rest (component modes with residual flexibility: MacNeal 1971, Rubin 1975). They span a
/// rational Krylov space of A on the forces (Ruhe 1984): as many whatever the numbers of the network are, so that answers change
/// smoothly with these. They hold `shapes` (n x any) as they are. `rigid`: the unit vector with S rigid = 0 of a free part, to which all are
/// orthogonal; empty else. Empty where `count` is most of n: then nothing is gained.
Eigen::MatrixXd LowModes(const Eigen::MatrixXd& S, const Eigen::VectorXd& rigid, const Eigen::MatrixXd& forces,
                         const Eigen::MatrixXd& shapes, int count);

}  // namespace dynoproof::mechanics
