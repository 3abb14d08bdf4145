// Rotors with continuously distributed inertia (thesis Sec. 2.3.1, Appendix B): the spatial eigenfrequency equation,
// its heuristic extension, and the exact eigenfrequencies of such a rotor with a chain of lumped inertias at its end.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "base/status.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

/// A spring and the inertia beyond it.
struct Oscillator {
  double stiffness;  // [N m/rad], > 0
  double inertia;    // [kg m^2], > 0
};

/// A uniform rotor, free at the left, with lumped inertias pinned to its ends and a chain of oscillators in series on
/// its right end: rotor -k[0]- I[0] -k[1]- I[1] ... No damping.
struct HybridRotor {
  double inertia;                                  // I, of the rotor alone [kg m^2], > 0
  double stiffness;                                // k_im, end to end [N m/rad], > 0
  double left_inertia = 0.0, right_inertia = 0.0;  // pinned to the ends [kg m^2], >= 0
  std::vector<Oscillator> chain;
};

/// The roots of (2.111), -x cot x = I/I_end with x = q L, as frequencies [Hz] up to f_max: a rotor with I_end > 0
/// pinned to its right end. One root lies in each ((m - 1/2) pi, m pi); the rigid-body mode is not listed. By (2.100)
/// nu = x sqrt(k/I). Fails (exit code 2) on values that are not positive and finite.
Result<std::vector<double>> SpatialEigenfrequencies(double inertia, double stiffness, double end_inertia,
                                                    double f_max_hz);

/// The roots of (B.4), -x cot x = (I/I_5) (nu - nu_0)/(nu - nu_r) with (B.1), (B.2), as frequencies [Hz] up to f_max.
/// The left side rises in each interval between poles of the cotangent, the right side falls on both sides of nu_r:
/// exactly one root lies between neighbouring poles of either. The formula is a heuristic, not the structure's
/// eigenfrequencies. Fails like SpatialEigenfrequencies.
Result<std::vector<double>> HeuristicEigenfrequencies(double inertia, double stiffness, const Oscillator& oscillator,
                                                      double f_max_hz);

/// Number of eigenfrequencies of the hybrid rotor in (0, f], rigid-body mode left out, by Wittrick and Williams: those
/// of the rotor clamped at both ends, x = m pi, plus the negative pivots of the dynamic stiffness matrix of the lumped
/// nodes, less one for the rigid-body mode.
int CountEigenfrequencies(const HybridRotor& rotor, double frequency_hz);

/// All eigenfrequencies in (0, f_max] [Hz], rising, with multiplicity, each bisected on the count to the last bits:
/// none can be missed. Fails (exit code 2) on values out of range.
Result<std::vector<double>> ExactEigenfrequencies(const HybridRotor& rotor, double f_max_hz);

/// The rotor cut into slices (AddSoftRotor), without damping; pinned inertias are added to the outer slices.
Network Sliced(const HybridRotor& rotor, int slices);

/// How the sliced rotor approaches the exact one, for one mode (1 = the lowest elastic one).
struct SliceConvergence {
  double exact_hz;
  std::vector<int> slices;
  std::vector<double> frequency_hz;  // by slices
  std::vector<double> order;         // between neighbours: log(error ratio)/log(slice ratio), one less than slices
};
/// Fails as ExactEigenfrequencies and UndampedFrequencies do, and (2) on fewer than two numbers of slices, numbers that
/// do not rise, or too few for the mode.
Result<SliceConvergence> MeasureSliceConvergence(const HybridRotor& rotor, int mode, const std::vector<int>& slices);

}  // namespace dynoproof::mechanics
