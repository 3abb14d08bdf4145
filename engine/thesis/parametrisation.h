// Springs and inertias from measured resonances, in closed form (thesis Sec. 2.2.6, 2.2.9). Frequencies in rad/s,
// undamped; wherever resonances come in a pair, their order matters only as stated.
#pragma once

#include <optional>
#include <vector>

namespace dynoproof::mechanics {

/// (2.60): k = I1 I2/(I1 + I2) nu_r^2 [N m/rad].
double TwoMassStiffness(double I1, double I2, double nu_r);

/// The springs of I1 --k1-- I2 --k2-- I3.
struct ThreeMassSprings {
  double k1, k2;  // [N m/rad]
};

/// Both solutions of (2.64). The radicand of (2.65), (2.66), here divided by (nu_1^2 + nu_2^2)^2, must not be negative:
/// resonances that lie too close together need a larger I2 between the outer inertias. Zero: both solutions agree.
struct ThreeMassSolution {
  double relative_radicand;  // in units of (nu_1^2 + nu_2^2)^2; at most 1
  /// None where the radicand is negative; else `first` (2.65), `second` (2.66).
  std::optional<ThreeMassSprings> first, second;
};
ThreeMassSolution ThreeMassStiffnesses(double I1, double I2, double I3, double nu_1, double nu_2);

/// The limits for I2 -> infinity, (2.67) for `first` and (2.68) for `second`. The first tuple takes the plus sign for
/// k1, so its k1 belongs to the larger frequency: the printed assignment holds for nu_1 > nu_2 (and is returned so
/// whatever the order).
ThreeMassSolution WideMiddleLimit(double I1, double I3, double nu_1, double nu_2);

/// A three-mass oscillator whose rotor I_m = I1 + I2 is to be split so that it shows a transmission zero.
struct SplitRotor {
  double k1, k2;  // [N m/rad]
  double I1, I2;  // [kg m^2]
};

/// All positive real solutions of (2.89), (2.90), input on I2: k1 = nu_z^2 I1, I2 = I_m - I1. The second equation of
/// (2.90) then says k2 = P I2 I3 / (nu_z^2 (I_m + I3)) with P = nu_1^2 nu_2^2, and the first becomes a quadratic in I2:
///   P I2^2 / (nu_z^2 (I_m + I3)) + (P I3 / (nu_z^2 (I_m + I3)) - nu_1^2 - nu_2^2) I2 + nu_z^2 I_m = 0.
/// None, one or two, by rising I2.
std::vector<SplitRotor> SplitRotorFromZero(double nu_1, double nu_2, double nu_z, double I_m, double I_3);

/// The same with the airgap torque spread in proportion to I1 and I2, zero (2.92): k1 = nu_z^2 I1 I2 / I_m. Then k2 and
/// I2 follow uniquely: k2 = P I_m I3 / (nu_z^2 (I_m + I3)), 1/I2 = (nu_1^2 + nu_2^2 - nu_z^2)/k2 - 1/I3. None where no
/// positive split exists.
std::optional<SplitRotor> SplitRotorFromProportionalZero(double nu_1, double nu_2, double nu_z, double I_m, double I_3);

}  // namespace dynoproof::mechanics
