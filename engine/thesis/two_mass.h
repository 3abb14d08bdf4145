// The two-mass oscillator in closed form (thesis Sec. 2.2.2), where eigenfrequency and practical resonance first
// differ.
#pragma once

#include <complex>
#include <optional>
#include <utility>

namespace dynoproof::mechanics {

/// I1 --(k, c)-- I2, the airgap torque on I1. All values positive (c >= 0).
struct TwoMass {
  double I1, I2;  // [kg m^2]
  double k;       // [N m/rad]
  double c;       // [N m s/rad]
};

/// 1 / I1 + 1 / I2 [1/(kg m^2)]: what the twist feels of both.
inline double InverseInertia(const TwoMass& plant) { return 1.0 / plant.I1 + 1.0 / plant.I2; }

/// The eigenvalues of A_d (2.13) [rad/s]; the one with positive imaginary part, or the slow real one, first.
std::pair<std::complex<double>, std::complex<double>> Eigenvalues(const TwoMass& plant);

/// The damped eigenfrequency (2.14) [rad/s]; none when the eigenvalues are real.
std::optional<double> DampedFrequency(const TwoMass& plant);

/// abs(G(j nu)) of (2.16), nu in rad/s, from the airgap torque to the twist phi_1 - phi_2 [rad/(N m)] (numerator 1/I1)
/// and to the shaft torque [-] (numerator (c s + k)/I1).
double TwistGain(const TwoMass& plant, double nu);
double ShaftTorqueGain(const TwoMass& plant, double nu);

/// nu_max (2.17) [rad/s], which minimises the denominator of (2.16): the practical resonance of the twist. None when
/// the radicand is negative (then the twist is largest at nu = 0).
std::optional<double> TwistResonance(const TwoMass& plant);

/// The practical resonance of the shaft torque [rad/s]. With a = k (1/I1 + 1/I2) the derivative of (2.16) vanishes at
/// nu^2 = 2 a / (1 + sqrt(1 + 2 a c^2/k^2)): it exists for any damping, and lies above (2.17).
double ShaftTorqueResonance(const TwoMass& plant);

}  // namespace dynoproof::mechanics
