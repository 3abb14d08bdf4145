// Transmission zeros: the signals that a drive line does not let through (thesis Sec. 2.2.9).
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <vector>

#include "base/status.h"
#include "linear/frequency_response.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

/// One zero s of G. Of a conjugate pair only the member with positive imaginary part is listed.
struct Zero {
  std::complex<double> s;  // [rad/s]
  double frequency_hz;     // abs(s) / (2 pi)
  double damping_ratio;    // -Re s / abs(s); 0 at the origin; negative right of the axis
  bool oscillatory;        // a conjugate pair: blocks an oscillation. False for the real zeros that dampers add
};

struct ZeroAnalysis {
  std::vector<Zero> zeros;  // by rising frequency
  int relative_degree;      // order minus number of zeros, both without the cancelled ones; dampers lower it
  int cancelled;            // invariant zeros left out because they meet a pole: modes not excited or not seen
};

/// The transmission zeros of G from the weighted torque to the output (see TransferFunction::Build).
///
/// These are the finite generalised eigenvalues of the Rosenbrock pencil. QZ on that pencil would turn its infinite
/// eigenvalue of multiplicity r + 1 into large finite ones at eps^(-1/(r+1)) of the norm, which nothing separates from
/// true ones. Here no infinite zero is ever computed: shafts and branches on the way from the output back to the input
/// are factored out exactly (each damped shaft gives a zero -k/c, each branch its clamped eigenvalues), and the rest
/// comes from the ordinary eigenvalue problem of ProjectedRoots. Zeros that meet a pole to
/// 1e-8 of its size are left out and counted.
/// Cost as a dense eigenvalue problem of size 2 n. Fails as TransferFunction::Build and Modes do, and (2) where the
/// input does not reach the output at all.
Result<ZeroAnalysis> TransferZeros(const Network& network, const Eigen::VectorXd& input, const Output& output);

/// Relative degree of the undamped network (2.79): the number of differentiations from the output to the input, i.e.
/// the index of the first Markov parameter that is not zero. The parameters c A^i b span a hundred decades; here each
/// A^i c is made orthogonal to its predecessors and normalised (Lanczos on M^-1/2 K M^-1/2), which changes no
/// parameter's being zero as all before it are, and brings those that are not to order one. Fails like TransferZeros.
Result<int> RelativeDegree(const Network& network, const Eigen::VectorXd& input, const Output& output);

/// Whether the output is flat in the sense of (2.79): the relative degree of the undamped network equals the order of
/// the part the output belongs to (2 n - 2 for the torques of a free part, 2 n - 1 for its speeds, 2 n otherwise), so
/// that no zeros exist.
Result<bool> IsFlatOutput(const Network& network, const Eigen::VectorXd& input, const Output& output);

/// (2.87): input on I2, torque counted beyond it: nu_z = sqrt(k1/I1) [rad/s].
double CounterOscillatorZero(double k1, double I1);
/// (2.92): input spread over I1 and I2 in proportion to their inertia: nu_z = sqrt(k1 (1/I1 + 1/I2)) [rad/s].
double ProportionalInputZero(double k1, double I1, double I2);
/// (2.93): input split kappa1 : kappa2, nu_z = sqrt(k1/I1 (kappa1/kappa2 + 1)) [rad/s]; kappa2 > 0. With weights that
/// are not negative it lies from sqrt(k1/I1) upwards, not anywhere above 0.
double SplitInputZero(double k1, double I1, double kappa1, double kappa2);

}  // namespace dynoproof::mechanics
