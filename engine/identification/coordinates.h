// How a search sees the parameters of effects: logarithms where the range spans decades and no value is neutral, else
// multiples of a natural step. All searched numbers are about 1 apart.
#pragma once

#include <vector>

#include "identification/estimation_problem.h"

namespace dynoproof::identification {

class Coordinates {
 public:
  /// About the effects as they are.
  explicit Coordinates(const std::vector<EffectInstance>& effects);

  std::size_t size() const { return axes_.size(); }
  double lower(std::size_t i) const { return To(i, axes_[i].lower); }
  double upper(std::size_t i) const { return To(i, axes_[i].upper); }
  /// d value / d coordinate.
  double Slope(std::size_t i, double value) const { return axes_[i].log ? value : axes_[i].scale; }
  /// The effects as they are, within their bounds.
  std::vector<double> Start() const;
  std::vector<EffectInstance> At(const double* x) const;
  /// The step of a forward difference there, away from a bound. The free run is smooth to some 1e-9 of its size for
  /// linear lines; 1e-5 of a parameter's own size, and no less than the engine resolves, stands far above that, and is
  /// small beside a sharp resonance's width.
  double Difference(std::size_t i, double x) const;

 private:
  struct Axis {
    double lower, upper, origin, scale;
    bool log;
    double least = 0.0;  // step that the engine resolves
  };
  double To(std::size_t i, double value) const;

  std::vector<EffectInstance> effects_;
  std::vector<Axis> axes_;
};

}  // namespace dynoproof::identification
