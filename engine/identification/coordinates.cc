#include "identification/coordinates.h"

#include <algorithm>
#include <cmath>

namespace dynoproof::identification {
namespace {

/// How far a parameter is from its origin. One that has come to nothing beside others of its kind (friction in one
/// direction only) keeps a tenth of theirs: by its own measure it would not find back.
double ScaleOf(const EffectInstance& instance, std::size_t parameter) {
  const std::vector<EffectParameter>& parameters = instance.effect->info().parameters;
  double scale = 0.0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].unit != parameters[parameter].unit) continue;
    const double origin = std::isfinite(parameters[i].neutral) ? parameters[i].neutral : 0.0;
    scale = std::max(scale, (i == parameter ? 1.0 : 0.1) * std::abs(instance.parameters[i] - origin));
  }
  return scale;
}

}  // namespace

Coordinates::Coordinates(const std::vector<EffectInstance>& effects) : effects_(effects) {
  for (const EffectInstance& instance : effects) {
    for (std::size_t i = 0; i < instance.parameters.size(); ++i) {
      const EffectParameter& p = instance.effect->info().parameters[i];
      Axis axis{p.lower, p.upper, 0.0, 1.0, false};
      axis.log = p.lower > 0.0 && p.upper / p.lower > 100.0 && (!std::isfinite(p.neutral) || p.neutral == p.upper);
      if (!axis.log) {
        axis.origin = std::isfinite(p.neutral) ? p.neutral : 0.0;
        axis.scale = ScaleOf(instance, i);
        if (!(axis.scale > 0.0)) axis.scale = std::abs(p.start - axis.origin);
        if (!(axis.scale > 0.0)) axis.scale = 1e-3 * (p.upper - p.lower);
      }
      // The engine counts time in whole nanoseconds: fifty of them round a delay's slope by two percent.
      constexpr double kLeast_s = 5e-8;
      if (p.unit == "s") axis.least = kLeast_s / (axis.log ? instance.parameters[i] : axis.scale);
      axes_.push_back(axis);
    }
  }
}

std::vector<double> Coordinates::Start() const {
  std::vector<double> x;
  for (const EffectInstance& instance : effects_) {
    for (const double value : instance.parameters)
      x.push_back(std::clamp(To(x.size(), value), lower(x.size()), upper(x.size())));
  }
  return x;
}

std::vector<EffectInstance> Coordinates::At(const double* x) const {
  std::vector<EffectInstance> effects = effects_;
  std::size_t k = 0;
  for (EffectInstance& instance : effects) {
    for (double& value : instance.parameters) {
      const Axis& axis = axes_[k];
      value = axis.log ? std::exp(x[k]) : axis.origin + axis.scale * x[k];
      value = std::clamp(value, axis.lower, axis.upper);
      ++k;
    }
  }
  return effects;
}

double Coordinates::Difference(std::size_t i, double x) const {
  const double step = std::max(1e-5 * std::max(1.0, std::abs(x)), axes_[i].least);
  return x + step <= upper(i) ? step : -step;
}

double Coordinates::To(std::size_t i, double value) const {
  return axes_[i].log ? std::log(value) : (value - axes_[i].origin) / axes_[i].scale;
}

}  // namespace dynoproof::identification
