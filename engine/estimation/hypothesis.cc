#include "estimation/hypothesis.h"

#include <algorithm>
#include <cmath>

#include "experiment/drive_by_record.h"
#include "model/kept_modes.h"
#include "model/prior.h"

namespace dynoproof::estimation {
namespace {

constexpr double kBound = 3.0;      // deviations: 0.3 % of sound values lie beyond
constexpr double kReleased = 10.0;  // times a nominal value, up and down

/// The size of a number that starts at its neutral value, and of a shape that starts at 0 [of its bounds' width].
constexpr double kLeastSize = 1e-6, kOfShape = 0.1;

/// By coordinate, what `pick` takes of those of both bounds: of a negative number the upper one is the smaller.
Eigen::VectorXd BoundsOf(const std::vector<Parameter>& parameters, double (*pick)(double, double)) {
  Eigen::VectorXd bounds(std::ssize(parameters));
  for (Eigen::Index i = 0; i < bounds.size(); ++i) {
    const Parameter& parameter = parameters[static_cast<std::size_t>(i)];
    bounds[i] = pick(parameter.CoordinateOf(parameter.lower), parameter.CoordinateOf(parameter.upper));
  }
  return bounds;
}

/// Without a prior, anywhere within a decade of its nominal value.
void Release(Parameter& parameter, double nominal) {
  const double far = kReleased * std::abs(nominal);
  parameter.prior = false;
  parameter.lower = parameter.logarithmic ? std::min(nominal / kReleased, nominal * kReleased) : -far;
  parameter.upper = parameter.logarithmic ? std::max(nominal / kReleased, nominal * kReleased) : far;
}

}  // namespace

void Hypothesis::Insert(std::size_t at, Parameter parameter, double value) {
  Eigen::VectorXd start(start_.size() + 1);
  const auto k = static_cast<Eigen::Index>(at);
  start.head(k) = start_.head(k);
  start[k] = parameter.CoordinateOf(value);
  start.tail(start_.size() - k) = start_.tail(start_.size() - k);
  start_ = start;
  parameters_.insert(parameters_.begin() + k, std::move(parameter));
}

Hypothesis Hypothesis::WithFree(Parameter parameter) const {
  Hypothesis more = *this;
  const Value* value = nominal_.root.FindPath(parameter.name);
  const double start = value != nullptr && value->is_number() ? value->number() : parameter.reference;
  more.Insert(parameters_.size(), std::move(parameter), start);
  return more;
}

Hypothesis Hypothesis::WithNominalValuesFree(const Registry& registry) const {
  return WithNominalValues(registry, false);
}

Hypothesis Hypothesis::WithNominalValuesReleased(const Registry& registry) const {
  return WithNominalValues(registry, true);
}

Hypothesis Hypothesis::WithNominalValues(const Registry& registry, bool released) const {
  Hypothesis more = *this;
  const PlantTraits& plant = registry.PlantOf(nominal_);
  for (const NuisanceParameter& known : NuisancesWithPriors(plant, nominal_)) {
    const Value* value = nominal_.root.FindPath(known.path);
    // A start belongs to a record, which corrects it; what is written as 0 is no nominal value.
    if (known.initial || (known.only_released && !released) || value == nullptr || !value->is_number()) continue;
    if (known.relative && !(value->number() != 0.0)) continue;
    const bool free = known.spread == kNoPrior, stated = PriorIsStated(nominal_, known.path);
    Parameter parameter{known.path, "",  known.relative, value->number(), free ? 1.0 : known.spread, 0.0, 0.0, true, {},
                        1e-3,       2e-2};
    parameter.lower = parameter.ValueAt(-kBound);
    parameter.upper = parameter.ValueAt(kBound);
    if (free || (released && !stated)) {
      Release(parameter, value->number());
      if (!(parameter.lower < parameter.upper)) continue;
    }
    more.Insert(more.parameters_.size(), std::move(parameter), value->number());
  }
  return more;
}

Hypothesis Hypothesis::WithReleased(const std::string& name) const {
  Hypothesis more = *this;
  const auto own = std::ranges::find(more.parameters_, name, &Parameter::name);
  if (own != more.parameters_.end()) Release(*own, nominal_.root.NumberOr(name, own->reference));
  return more;
}

Hypothesis Hypothesis::AsExactAs(const Plan& plan) const {
  Hypothesis exact = *this;
  SetSubsteps(exact.nominal_, SubstepsOf(plan));
  if (RotorModes(exact.nominal_) != RotorModes(plan)) SetRotorModes(exact.nominal_, RotorModes(plan));
  return exact;
}

Hypothesis Hypothesis::WithStartFree(std::size_t record, const Registry& registry) const {
  Hypothesis more = *this;
  const PlantTraits& plant = registry.PlantOf(nominal_);
  if (!plant.nuisances) return more;
  for (const NuisanceParameter& known : plant.nuisances(nominal_)) {
    const std::string path = StartOfRecord(record) + "." + known.path;
    const Value* value = nominal_.root.FindPath(path);
    if (!known.initial || value == nullptr || !value->is_number()) continue;
    Parameter parameter{path, "", known.relative, value->number(), known.spread, 0.0, 0.0, true, {}, 1e-5, 1e-3};
    parameter.lower = parameter.ValueAt(-kBound);
    parameter.upper = parameter.ValueAt(kBound);
    more.Insert(more.parameters_.size(), std::move(parameter), value->number());
  }
  return more;
}

Hypothesis Hypothesis::WithDifferencesFree(std::size_t records) const {
  Hypothesis more = *this;
  if (records < 2) return more;
  for (const NumberThatDiffers& number : NumbersThatDiffer(nominal_)) {
    for (std::size_t r = 0; r < records; ++r) {
      const std::string path = DifferenceOfRecord(r) + "." + number.path;
      WriteNumber(more.nominal_.root, path, 1.0);
      Parameter parameter{path, "1", true, 1.0, number.spread, 0.0, 0.0, true, {}, 1e-3, 2e-2};
      parameter.lower = parameter.ValueAt(-kBound);
      parameter.upper = parameter.ValueAt(kBound);
      more.Insert(more.parameters_.size(), std::move(parameter), 1.0);
    }
  }
  return more;
}

Hypothesis Hypothesis::With(const Effect& effect, const Place& place, const Magnitudes& magnitudes) const {
  Hypothesis more = *this;
  const std::string scaled = effect.ScaledIn(nominal_, place);
  for (std::size_t i = 0; i < more.parameters_.size(); ++i) {
    if (scaled.empty() || more.parameters_[i].name != scaled) continue;
    const auto k = static_cast<Eigen::Index>(i);
    Eigen::VectorXd start(more.start_.size() - 1);
    start << more.start_.head(k), more.start_.tail(more.start_.size() - k - 1);
    more.start_ = start;
    more.parameters_.erase(more.parameters_.begin() + k);
    break;
  }
  std::size_t at = more.of_effects();
  const std::vector<double> start = effect.Starts(nominal_, place, magnitudes).front();
  for (std::size_t i = 0; i < start.size(); ++i) {
    const EffectParameter& known = effect.info().parameters[i];
    const double value = std::clamp(start[i], known.lower, known.upper);
    const double neutral = std::isfinite(known.neutral) ? known.neutral : 0.0;
    // Bounds may be as wide as physics goes: a start, where it is one, tells the size, however small it is beside them.
    // A shape's bounds are where it lies, as a phase lies on its circle.
    const double of_bounds = std::isfinite(known.neutral) ? kLeastSize : kOfShape;
    const double size = value != neutral ? std::abs(value - neutral) : of_bounds * (known.upper - known.lower);
    // What does nothing at a bound that is as large as numbers go, as a limit or a joint's stiffness, is told from there by
    // its logarithm: beside the bound a start has no size.
    const bool logarithmic = known.lower > 0.0 && known.neutral == known.upper;
    Parameter parameter{effect.info().name + "@" + place.ToString() + " " + known.name,
                        effect.UnitAt(i, place, nominal_),
                        logarithmic,
                        logarithmic ? value : neutral,
                        logarithmic ? 1.0 : size,
                        known.lower,
                        known.upper,
                        false,
                        {},
                        1e-4,
                        1e-2};
    if (std::isfinite(known.neutral)) parameter.neutral = known.neutral;
    more.Insert(at++, std::move(parameter), value);
  }
  more.effects_.push_back({&effect, place});
  return more;
}

Eigen::VectorXd Hypothesis::lower() const {
  return BoundsOf(parameters_, [](double a, double b) { return std::min(a, b); });
}

Eigen::VectorXd Hypothesis::upper() const {
  return BoundsOf(parameters_, [](double a, double b) { return std::max(a, b); });
}

Plan Hypothesis::At(const Eigen::VectorXd& q) const {
  Plan plan = nominal_;
  for (std::size_t i = of_effects(); i < parameters_.size(); ++i) {
    Value* value = plan.root.FindPath(parameters_[i].name);
    if (value != nullptr) *value = Value(parameters_[i].ValueAt(q[static_cast<Eigen::Index>(i)]));
  }
  std::size_t next = 0;
  for (const Applied& applied : effects_) {
    std::vector<double> values;
    for (const EffectParameter& known : applied.effect->info().parameters) {
      const double value = parameters_[next].ValueAt(q[static_cast<Eigen::Index>(next)]);
      values.push_back(std::clamp(value, known.lower, known.upper));
      ++next;
    }
    applied.effect->Apply(plan, applied.place, values);
  }
  return plan;
}

std::size_t Hypothesis::of_effects() const {
  std::size_t count = 0;
  for (const Applied& applied : effects_) count += applied.effect->info().parameters.size();
  return count;
}

std::string Hypothesis::Name() const {
  std::string name;
  for (const Applied& applied : effects_)
    name += (name.empty() ? "" : " + ") + applied.effect->info().name + "@" + applied.place.ToString();
  return name.empty() ? "nominal" : name;
}

}  // namespace dynoproof::estimation
