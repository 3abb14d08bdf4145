// The numerator of a transfer function by confining the state to output = 0: the numerical core of TransferZeros.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <vector>

#include "base/status.h"
#include "linear/frequency_response.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

/// abs(h b) above this part of abs(h) abs(b) counts as direct action of the input on the output: keeping a smaller
/// term magnifies round-off (1e-16) by its inverse, dropping one moves the zeros by its relative size; at 1e-8 the two
/// are equal.
inline constexpr double kDirectTerm = 1e-8;

/// Appends the roots of the numerator N in G = N / det(s^2 M + s C + K) to `roots`, all of them, conjugates included.
/// Edge torques and angles only. In energy coordinates, states that the output does not see left out, the state is
/// confined by orthogonal projection to output = 0 and the derivative becomes the new output, until the input acts on
/// it directly; the roots are the ordinary eigenvalues of what is left, so that infinite zeros never appear. Conjugate
/// pairs are polished by Newton steps on G. Fails as Modes does and (2) where the input does not reach the output.
Status ProjectedRoots(const Network& network, const Eigen::VectorXd& input, const Output& output,
                      std::vector<std::complex<double>>& roots);

}  // namespace dynoproof::mechanics
