#include "thesis/two_mass.h"

#include <cmath>

namespace dynoproof::mechanics {
namespace {

/// abs of the denominator of (2.15) at s = j nu.
double Denominator(const TwoMass& plant, double nu) {
  const double m = InverseInertia(plant);
  return std::hypot(plant.k * m - nu * nu, plant.c * m * nu);
}

}  // namespace

std::pair<std::complex<double>, std::complex<double>> Eigenvalues(const TwoMass& plant) {
  const double half = 0.5 * plant.c * InverseInertia(plant), square = plant.k * InverseInertia(plant);
  const double radicand = half * half - square;
  if (radicand < 0.0) return {{-half, std::sqrt(-radicand)}, {-half, -std::sqrt(-radicand)}};
  const double fast = half + std::sqrt(radicand);  // the slow one from the product: no cancellation
  return {-square / fast, -fast};
}

std::optional<double> DampedFrequency(const TwoMass& plant) {
  const double nu = Eigenvalues(plant).first.imag();
  if (nu == 0.0) return std::nullopt;
  return nu;
}

double TwistGain(const TwoMass& plant, double nu) { return 1.0 / (plant.I1 * Denominator(plant, nu)); }

double ShaftTorqueGain(const TwoMass& plant, double nu) {
  return std::hypot(plant.k, plant.c * nu) / (plant.I1 * Denominator(plant, nu));
}

std::optional<double> TwistResonance(const TwoMass& plant) {
  const double m = InverseInertia(plant), square = plant.k * m - 0.5 * plant.c * plant.c * m * m;
  if (square < 0.0) return std::nullopt;
  return std::sqrt(square);
}

double ShaftTorqueResonance(const TwoMass& plant) {
  const double a = plant.k * InverseInertia(plant), ratio = plant.c / plant.k;
  return std::sqrt(2.0 * a / (1.0 + std::sqrt(1.0 + 2.0 * a * ratio * ratio)));
}

}  // namespace dynoproof::mechanics
