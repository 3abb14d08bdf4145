// What may be missing in a model: each effect at each place where these records could show it, with the sizes to begin at.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "diagnosis/levels.h"
#include "estimation/hypothesis.h"

namespace dynoproof::diagnosis {

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

/// On top of `base`, without what it has already. `magnitudes`: of the first record.
std::vector<Trial> TrialsOf(const estimation::Hypothesis& base, const Levels& levels, const Magnitudes& magnitudes,
                            const Registry& registry);

}  // namespace dynoproof::diagnosis
