// The undamped modes of a network, M phi'' + K phi = 0, and what the dampers make of each.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <utility>
#include <vector>

#include "base/status.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

/// One mode. Energies are shares of the mode's total: over an oscillation half of it is kinetic and half is strain, so
/// the entries of `kinetic` sum to 1/2, those of `strain` to 1/2, together 1. A rigid-body mode strains nothing: its
/// `kinetic` sums to 1.
struct Mode {
  double frequency_hz;   // undamped; exactly 0 for rigid-body modes
  double damping_ratio;  // of `damped`; see below
  /// The two eigenvalues of s^2 M + s C + K that belong to this mode [rad/s]: conjugate (the first with positive
  /// imaginary part), or two real ones (overdamped; the slow one first). Damping ratio: -Re s / abs(s), or
  /// (abs(s1) + abs(s2)) / (2 sqrt(s1 s2)) >= 1 for two real ones. Rigid-body modes: 0 and -d, where d is not zero when
  /// dampers without spring hold the part (to the ground or to another part); their ratio is 0 by definition.
  std::pair<std::complex<double>, std::complex<double>> damped;
  Eigen::VectorXd shape;    // per node, the entry of largest magnitude scaled to +1
  Eigen::VectorXd kinetic;  // per node
  Eigen::VectorXd strain;   // per edge
};

/// All modes of a network of n nodes.
struct ModalAnalysis {
  std::vector<Mode> modes;  // n: rigid-body modes first, one for each part that no spring holds, then rising
  int rigid = 0;            // how many are rigid-body modes
  Eigen::VectorXd omega;    // n, undamped [rad/s], in the order of `modes`
  Eigen::MatrixXd phi;      // n x n, columns mass-normalised: phi^T M phi = 1, phi^T K phi = diag(omega^2)

  /// All 2n eigenvalues of s^2 M + s C + K [rad/s], mode by mode.
  std::vector<std::complex<double>> DampedEigenvalues() const;
};

/// Modes of the network. Each connected part (Network::Parts) is solved alone, so that parts do not mix even where
/// their frequencies agree; frequencies come from the Rayleigh quotient of the twists, which keeps low ones as precise
/// as high ones. The damped eigenvalues are exact (not a perturbation); a mode is given the pair closest to its
/// first-order estimate s^2 + s phi^T C phi + omega^2 = 0.
/// Cost about n^3: 0.4 s for 1000 nodes in a chain. Fails (exit code 2) as CheckNetwork does, and (3) where no
/// eigenvalue is found.
Result<ModalAnalysis> Modes(const Network& network);

/// The undamped frequencies alone [Hz], rigid-body modes first (exactly 0), then rising.
Result<Eigen::VectorXd> UndampedFrequencies(const Network& network);

/// phi^T C phi, n x n. What dampers inside a part cannot do to its rigid-body motion is exactly zero.
Eigen::MatrixXd ModalDamping(const Network& network, const Eigen::MatrixXd& phi);

/// State matrix in energy coordinates x = (omega q, q', q'_rigid), dimension 2 (n - rigid) + rigid: skew-symmetric
/// without damping, abs(x)^2 / 2 is the energy. `modal_damping` as above. Only omega, rigid are read of `modal`.
Eigen::MatrixXd EnergyStateMatrix(const ModalAnalysis& modal, const Eigen::MatrixXd& modal_damping);

}  // namespace dynoproof::mechanics
