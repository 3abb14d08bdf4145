// Every effect at every place that the record can show, fitted once, cheaply: which share of what the null leaves it removes.
#pragma once

#include <functional>
#include <vector>

#include "diagnosis/contestant.h"

namespace dynoproof::diagnosis {

/// On top of the null, at `level` and the next one, those that remove most first. The null holds at `level`. `magnitudes`: of
/// the first record. `progress`: a share of the work.
std::vector<Contestant> FirstLook(const Contestant& null, const Levels& levels, std::size_t level,
                                  const Magnitudes& magnitudes, const Registry& registry,
                                  const std::function<void(double)>& progress);

}  // namespace dynoproof::diagnosis
