// An effect: one physical change of a model, by name and place. It edits a Plan and never sees TOML or a solver.
// Hidden truth, fit and extended run share this route.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/params.h"
#include "model/plan.h"

namespace dynoproof {

/// Where an effect can sit: kind:name[@quantity], such as "inertia:I5", "shaft:k3", "output:T_shaft".
struct Place {
  std::string kind, name, quantity;

  std::string ToString() const;
  friend bool operator==(const Place&, const Place&) = default;
};
std::optional<Place> ParsePlace(std::string_view text);

/// One parameter of an effect as a fit needs it.
struct EffectParameter {
  std::string name, unit, description;
  double lower, upper;  // bounds
  double neutral;       // the effect vanishes here (for the strength); NaN for a shape parameter
  double start;         // where a search begins, within the bounds
};

struct EffectInfo {
  std::string name, law, description;
  std::vector<EffectParameter> parameters;
};

class Effect {
 public:
  virtual ~Effect() = default;

  const EffectInfo& info() const { return info_; }

  /// All places of this plan where the effect can sit.
  virtual std::vector<Place> Places(const Plan& plan) const = 0;
  /// Changes the plan. `parameters` has exactly the effect's parameters, checked against the bounds by ApplyEffect.
  virtual void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const = 0;

 protected:
  EffectInfo info_;
};

class Registry;

/// Checks name, place and parameters and applies the effect; faults become diagnostics at `use.where`.
bool ApplyEffect(const Registry& registry, const EffectUse& use, Plan& plan, Diagnostics& diagnostics);
/// Applies every [[effect]] of the plan, in order, and removes the section.
bool ApplyEffects(const Registry& registry, Plan& plan, Diagnostics& diagnostics);

}  // namespace dynoproof
