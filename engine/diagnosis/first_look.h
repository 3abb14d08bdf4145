// Every effect at every place that the record can show, run beside the null at the size that the record asks for, and those that
// promise most fitted once, cheaply: which share of what the null leaves they remove.
#pragma once

#include <vector>

#include "diagnosis/conduct.h"
#include "diagnosis/contestant.h"

namespace dynoproof::diagnosis {

/// On top of the null, at `level` and the next one, those that remove most first; where the conduct ends it, of those that were
/// looked at by then. The null holds at `level`. `magnitudes`: of the first record.
std::vector<Contestant> FirstLook(const Contestant& null, const Levels& levels, std::size_t level,
                                  const Magnitudes& magnitudes, const Registry& registry, const Conduct& conduct);

}  // namespace dynoproof::diagnosis
