// What could be wrong: every registered effect at every place of the plan, with the points a search starts from.
// Effects take them from the record's own magnitudes, because their bounds span machines of all sizes.
#pragma once

#include <algorithm>
#include <vector>

#include "diagnosis/terms.h"
#include "identification/estimation_problem.h"

namespace dynoproof::diagnosis {

struct Candidate {
  const Effect* effect = nullptr;
  Place place;
  /// Points in the effect's parameters; of each, the strengths are sizes to be scaled, the others are tried as they
  /// are.
  std::vector<std::vector<double>> starts;
  /// Parameters in which the effect is about linear near its neutral value; empty: only a search tells.
  std::vector<std::size_t> strengths;
  /// Tried only where a relative of it gains something: its family at its place, or a harmonic elsewhere.
  bool refinement = false;
  std::string family = {};  // its own, or that of the effect it refines

  std::string ToString() const { return effect->info().name + "@" + place.ToString(); }
  EffectInstance At(std::vector<double> parameters) const { return {effect, place, std::move(parameters)}; }
};

/// Whether records can show an effect at a place: a sensor that no record has, and an input that no record drives, cannot be
/// seen. `channels`: of the records' outputs, by `name`.
template <class Channels>
bool CanBeSeen(const Place& place, const Channels& channels, const MappedRecord& first) {
  if (place.kind == "output")
    return std::ranges::any_of(channels, [&](const auto& channel) { return channel.name == place.name; });
  return place.kind != "input" || first.inputs.contains(place.name);
}

/// Parameters that scale an effect about linearly from its neutral value, where that value is finite and within reach.
std::vector<std::size_t> StrengthsOf(const Effect& effect);

/// Of the first record.
Magnitudes MagnitudesOf(const EstimationProblem& problem);

std::vector<Candidate> CandidatesFor(const EstimationProblem& problem, const Magnitudes& magnitudes);

/// The plainest law of dry friction, which the others refine; null where no effect is one.
const Effect* PlainFriction(const Registry& registry);

}  // namespace dynoproof::diagnosis
