// What may be missing in a model: each effect at each place where these records could show it, with the sizes to begin at.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "diagnosis/levels.h"
#include "diagnosis/terms.h"
#include "estimation/hypothesis.h"
#include "identification/estimation_problem.h"

namespace dynoproof::diagnosis {

/// Whether records can show an effect at a place: a sensor that no record has, and an input that no record drives, cannot be
/// seen. `channels`: of the records' outputs, by `name`.
template <class Channels>
bool CanBeSeen(const Place& place, const Channels& channels, const MappedRecord& first) {
  if (place.kind == "output")
    return std::ranges::any_of(channels, [&](const auto& channel) { return channel.name == place.name; });
  return place.kind != "input" || first.inputs.contains(place.name);
}

/// Of the first record.
Magnitudes MagnitudesOf(const EstimationProblem& problem);

/// A hypothesis without its start: the effect at a place, to be sized by the record.
struct Trial {
  const Effect* effect;
  Place place;
  estimation::Hypothesis hypothesis;
  std::vector<Eigen::VectorXd> starts;  // coordinates of the effect alone
  std::vector<std::size_t> strengths;   // of its parameters, with what grows with them

  /// Where the numbers of the effect itself begin among the coordinates.
  Eigen::Index own() const {
    return static_cast<Eigen::Index>(hypothesis.of_effects() - effect->info().parameters.size());
  }
};

/// Which of the null's numbers a candidate changes and nothing else; -1: none.
Eigen::Index NumberChanged(const Trial& trial, const estimation::Hypothesis& null);

/// On top of `base`, without what it has already. `magnitudes`: of the first record.
std::vector<Trial> TrialsOf(const estimation::Hypothesis& base, const Levels& levels, const Magnitudes& magnitudes,
                            const Registry& registry);

}  // namespace dynoproof::diagnosis
