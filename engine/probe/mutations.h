// The ways in which the model of a scenario may be wrong: every effect at every place, in both directions, and changes that
// have no size, as a turned sign or a dropped term.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "model/effect.h"
#include "model/plan.h"
#include "model/registry.h"
#include "sim/rig.h"
#include "sim/simulate.h"

namespace dynoproof::probe {

/// Names of changes that are no effects.
inline constexpr const char* kTurnedSign = "turned_sign";
inline constexpr const char* kDroppedTerm = "dropped_term";

using EffectValues = std::vector<std::pair<std::string, double>>;  // by name

/// One way. Its size is 1 where it is as large as such errors usually are (the start of the effect's search), 0 where it is not
/// there.
struct Mutation {
  std::string name = {};   // of the effect, or one of the names above
  std::string place = {};  // "shaft:k3", or the path of a number
  std::string unit = {};   // of the strength
  int sign = 1;            // of the strength: an effect with two directions is two mutations
  /// The strength at size 1, in that unit and without the sign: |value - neutral| of the effect's first strength. 0: it has no
  /// size, it is there or not.
  double usual = 0.0;
  double largest = 1.0;  // size at which a bound of the effect is reached
  /// A limit rather than a growth, as of a saturation: at size s the value is neutral^(1 - s) start^s.
  bool falling = false;
  double neutral = 0.0, start = 0.0;  // of that
  std::function<void(Plan&, double size)> apply = {};
  /// The effect's parameters at a size, as an [[effect]] takes them; empty for what is no effect.
  std::function<EffectValues(double size)> parameters = [](double) { return EffectValues(); };

  bool sized() const { return usual > 0.0; }
  /// The strength at a size, in the unit: with its sign, or the value itself where it is a limit.
  double StrengthAt(double size) const;
  /// "stiffness_change@shaft:k3 +"
  std::string Key() const;
};

/// Usual magnitudes of a run, as a search for an effect asks for them.
Magnitudes MagnitudesOf(const Rig& rig, const Samples& samples);

/// All of them, by name and place. Shape parameters of an effect, as the order of a ripple, are those of its first start.
std::vector<Mutation> MutationsOf(const Plan& plan, const Registry& registry, const Magnitudes& magnitudes);

}  // namespace dynoproof::probe
