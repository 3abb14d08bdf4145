#include "thesis/parametrisation.h"

#include <algorithm>
#include <cmath>

namespace dynoproof::mechanics {

double TwoMassStiffness(double I1, double I2, double nu_r) { return I1 * I2 / (I1 + I2) * nu_r * nu_r; }

ThreeMassSolution ThreeMassStiffnesses(double I1, double I2, double I3, double nu_1, double nu_2) {
  const double left = 1.0 / I1 + 1.0 / I2, right = 1.0 / I2 + 1.0 / I3;
  const double mixed = 1.0 / (I1 * I2) + 1.0 / (I1 * I3) + 1.0 / (I2 * I3);
  const double sum = nu_1 * nu_1 + nu_2 * nu_2, product = nu_1 * nu_1 * nu_2 * nu_2;
  ThreeMassSolution solution{1.0 - 4.0 * product * left * right / (mixed * sum * sum), {}, {}};
  if (!(solution.relative_radicand >= 0.0)) return solution;
  // The springs enter (2.64) as k1 left and k2 right, the roots of x^2 - sum x + product left right / mixed; the small
  // one from the product, as the difference loses digits.
  const double large = 0.5 * sum * (1.0 + std::sqrt(solution.relative_radicand));
  const double small = product * left * right / (mixed * large);
  solution.first = {large / left, small / right};
  solution.second = {small / left, large / right};
  return solution;
}

ThreeMassSolution WideMiddleLimit(double I1, double I3, double nu_1, double nu_2) {
  const double large = std::pow(std::max(nu_1, nu_2), 2), small = std::pow(std::min(nu_1, nu_2), 2);
  const double contrast = (large - small) / (large + small);
  return {contrast * contrast, ThreeMassSprings{large * I1, small * I3}, ThreeMassSprings{small * I1, large * I3}};
}

std::vector<SplitRotor> SplitRotorFromZero(double nu_1, double nu_2, double nu_z, double I_m, double I_3) {
  const double sum = nu_1 * nu_1 + nu_2 * nu_2, product = nu_1 * nu_1 * nu_2 * nu_2, z = nu_z * nu_z;
  const double slope = product / (z * (I_m + I_3));  // k2 = slope I2 I3
  const double a = slope, b = slope * I_3 - sum, c = z * I_m;
  const double radicand = b * b - 4.0 * a * c;
  // a and c are positive: the roots are positive when b is negative, and only then.
  if (!(radicand >= 0.0 && b < 0.0)) return {};
  const double large = 0.5 * (-b + std::sqrt(radicand)) / a, small = c / (a * large);
  std::vector<SplitRotor> solutions;
  for (const double I2 : {small, large}) {
    const double I1 = I_m - I2;
    if (!(I2 > 0.0 && I1 > 0.0)) continue;
    if (!solutions.empty() && solutions.back().I2 == I2) continue;
    solutions.push_back({z * I1, slope * I2 * I_3, I1, I2});
  }
  return solutions;
}

std::optional<SplitRotor> SplitRotorFromProportionalZero(double nu_1, double nu_2, double nu_z, double I_m,
                                                         double I_3) {
  const double sum = nu_1 * nu_1 + nu_2 * nu_2, product = nu_1 * nu_1 * nu_2 * nu_2, z = nu_z * nu_z;
  const double k2 = product * I_m * I_3 / (z * (I_m + I_3));
  const double I2 = 1.0 / ((sum - z) / k2 - 1.0 / I_3), I1 = I_m - I2;
  if (!(I2 > 0.0 && I1 > 0.0 && k2 > 0.0)) return std::nullopt;
  return SplitRotor{z * I1 * I2 / I_m, k2, I1, I2};
}

}  // namespace dynoproof::mechanics
