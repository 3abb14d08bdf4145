// The eigenvalues of s^2 M + s C + K: by the dense eigenvalue problem of small networks, by simultaneous iteration on
// the characteristic function of large ones; each mode is given its two.
#pragma once

#include <complex>
#include <optional>
#include <utility>
#include <vector>

#include "base/status.h"
#include "linear/modes.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

using EigenvaluePair = std::pair<std::complex<double>, std::complex<double>>;

/// What is known of the eigenvalue problem before it is solved: per mode the damping phi_m^T C phi_m of the first-order
/// estimate s^2 + s damping + omega^2 = 0, and how many of the rigid-body modes no damper reaches. Zero is an
/// eigenvalue (rigid + unreached) times, exactly; the others are the 2 n - rigid - unreached that have to be found.
struct DampingEstimate {
  Eigen::VectorXd damping;       // n [rad/s]
  Eigen::VectorXd rigid_decays;  // rigid - unreached rates of the rigid-body motion alone [rad/s], rising
  int unreached = 0;
};
DampingEstimate EstimateDamping(const Network& network, const ModalAnalysis& modal);

/// The eigenvalues that are not exactly zero, by the dense problem in energy coordinates (of size 2 n). O(n^3) with a
/// large factor: 0.1 s at n = 150, a minute at n = 1000. Empty when the iteration fails.
std::vector<std::complex<double>> DenseEigenvalues(const Network& network, const ModalAnalysis& modal,
                                                   const DampingEstimate& estimate);

/// The same for networks without meshes by Ehrlich-Aberth iteration, O(n) for each eigenvalue and step and O(n^2)
/// altogether, started from the estimates. The sum of all eigenvalues, known from trace(M^-1 C), and of their squares
/// must come out; nothing is returned when it does not, or where the network has meshes.
std::optional<std::vector<std::complex<double>>> IteratedEigenvalues(const Network& network, const ModalAnalysis& modal,
                                                                     const DampingEstimate& estimate);

/// For each mode of `modal` its two damped eigenvalues (see Mode::damped). Iterates beyond 150 nodes and falls back to
/// the dense problem. Overdamped modes are those with the largest estimated ratio; real eigenvalues are matched to
/// their estimates in rising order, conjugate pairs to the nearest estimate.
Result<std::vector<EigenvaluePair>> DampedPairs(const Network& network, const ModalAnalysis& modal);

}  // namespace dynoproof::mechanics
