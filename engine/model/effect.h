// An effect: one physical change of a model, by name and place. It edits a Plan and never sees TOML or a solver.
// Hidden truth, fit and extended run share this route.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/params.h"
#include "model/place.h"
#include "model/plan.h"
#include "model/plant_traits.h"

namespace dynoproof {

/// One parameter of an effect as a fit needs it.
struct EffectParameter {
  std::string name, unit, description;
  double lower, upper;     // bounds
  double neutral;          // the effect vanishes here (for the strength); NaN for a shape parameter
  double start;            // where a search begins, within the bounds
  bool of_signal = false;  // in the unit of the signal that is its place, or, of unit 1/s, in that per second
};

/// What kind of change an effect is, for whoever searches for one: a search asks for these and knows no effect by name.
struct EffectTraits {
  /// Dry friction: not smooth, the force jumps or sticks where the speed changes its sign.
  bool dry_friction = false;
  /// A harmonic of an angle, A sin(n phi + theta), with the parameters A, n, theta in this order.
  bool harmonic = false;
  /// Effects of one family explain much of each other's error at the same place; empty: a family of its own.
  std::string family = {};
  /// The effects of which this one is a refinement: of two the plainer one is named where it explains as much.
  std::vector<std::string> refines = {};
};

struct EffectInfo {
  std::string name, law, description;
  std::vector<EffectParameter> parameters;
  EffectTraits traits = {};
};

/// Usual magnitudes of a record's signals, in the units of the scenario.
struct Magnitudes {
  double input = 0.0;                // RMS of the largest input, without inputs of another unit
  double speed = 1.0, torque = 1.0;  // RMS of the measured outputs of that unit; the inputs' where there is none
  double duration_s = 1.0, step_s = 1e-4;
  std::map<std::string, double> input_rms, input_peak, output_spread;  // by name; spread: standard deviation

  /// The entry of one of these maps; 1 where there is none or it is 0.
  static double Of(const std::map<std::string, double>& sizes, const std::string& name) {
    const auto found = sizes.find(name);
    return found != sizes.end() && found->second > 0.0 ? found->second : 1.0;
  }
};

/// Points in the parameters of an effect, in its order.
using Points = std::vector<std::vector<double>>;

class Effect {
 public:
  virtual ~Effect() = default;

  const EffectInfo& info() const { return info_; }

  /// All places of this plan where the effect can sit.
  virtual std::vector<Place> Places(const Plan& plan) const = 0;
  /// Changes the plan. `parameters` has exactly the effect's parameters, checked against the bounds by ApplyEffect.
  virtual void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const = 0;

  /// Where a search begins at this place of the nominal plan, for a record of these magnitudes; values beyond the
  /// bounds are clamped. By default the parameters' own starts.
  virtual Points Starts(const Plan& plan, const Place& place, const Magnitudes& magnitudes) const;
  /// The path of the number that becomes nominal (1 + first parameter) and is all that changes; empty: there is none.
  virtual std::string ScaledParameter(const Place& /*place*/) const { return ""; }
  /// That path as this plan writes it, whose bodies may slide.
  std::string ScaledIn(const Plan& plan, const Place& place) const;

  /// The unit of a parameter at a place of this plan, which tells those of signals and whether its bodies turn or slide.
  std::string UnitAt(std::size_t parameter, const Place& place, const Plan& plan) const;

 protected:
  /// What the plant of a plan declares, by which an effect finds its places.
  const PlantTraits& PlantOf(const Plan& plan) const;

  EffectInfo info_;

 private:
  friend class Registry;
  std::shared_ptr<const PlantCatalogue> plants_;  // of the registry that it belongs to
};

class Registry;

/// Checks name, place and parameters and applies the effect; faults become diagnostics at `use.where`.
bool ApplyEffect(const Registry& registry, const EffectUse& use, Plan& plan, Diagnostics& diagnostics);
/// Applies every [[effect]] of the plan, in order, and removes the section.
bool ApplyEffects(const Registry& registry, Plan& plan, Diagnostics& diagnostics);

}  // namespace dynoproof
