// What could be wrong: every registered effect at every place of the plan, with the points a search starts from. Starts
// are taken from the record's own magnitudes, because an effect's bounds span machines of all sizes.
#pragma once

#include <vector>

#include "diagnosis/study.h"

namespace dynoproof::diagnosis {

struct Candidate {
  const Effect* effect = nullptr;
  Place place;
  /// Points in the effect's parameters; of each, the strengths are sizes to be scaled, the others are tried as they
  /// are.
  std::vector<std::vector<double>> starts;
  /// Parameters in which the effect is about linear near its neutral value; empty: only a search tells.
  std::vector<std::size_t> strengths;
  /// Tried only where a relative of it gains something: the plain frictions at its place, or a ripple elsewhere.
  bool refinement = false;

  std::string ToString() const { return effect->info().name + "@" + place.ToString(); }
  Assumed At(std::vector<double> parameters) const { return {effect, place, std::move(parameters)}; }
};

/// Usual magnitudes of a record.
struct Magnitudes {
  double input = 0.0;                // RMS of the largest input, without inputs of another unit
  double speed = 1.0, torque = 1.0;  // RMS of the measured outputs of that unit; the inputs' where there is none
  double duration_s = 1.0;
  std::map<std::string, double> input_rms, input_peak, output_spread;
};
Magnitudes MagnitudesOf(const Study& study);

std::vector<Candidate> CandidatesFor(const Study& study, const Magnitudes& magnitudes);

/// Whether an effect is the dead time, or the first-order lag, of an input or output.
bool IsDelay(const Effect& effect);
bool IsLag(const Effect& effect);
/// Whether an effect is a law of dry friction.
bool IsDryFriction(const Effect& effect);
/// Whether it is one of those that fall with speed or differ with direction.
bool FallsOrDiffers(const Effect& friction);

}  // namespace dynoproof::diagnosis
