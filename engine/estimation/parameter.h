// A number that an estimate moves, whatever it belongs to: a value of the plan, or a parameter of an effect.
#pragma once

#include <optional>
#include <string>

namespace dynoproof::estimation {

/// value = reference exp(scale q) or reference + scale q, by a coordinate q without a unit. Of a number with a prior q is
/// standard normal, and `scale` the standard deviation of the value or of its logarithm.
struct Parameter {
  std::string name, unit;  // "plant.inertia.I5", "coulomb_friction@inertia:I5 T_c"
  bool logarithmic = false;
  double reference = 0.0, scale = 1.0;
  double lower = 0.0, upper = 0.0;  // bounds of the value
  bool prior = false;
  std::optional<double> neutral;  // value at which an effect vanishes
  /// Of differences, in q. Where a rig has guards, small ones see only how events move within the same period, not that
  /// there are more of them.
  double step = 1e-5, rough_step = 3e-3;

  double ValueAt(double q) const;
  /// Of a value within the bounds.
  double CoordinateOf(double value) const;
};

}  // namespace dynoproof::estimation
