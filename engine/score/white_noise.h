// The white noise on a signal.
#pragma once

#include <vector>

namespace dynoproof::score {

/// Standard deviation of the white noise on a signal. Differences of the sixth order leave next to nothing of motion below
/// a tenth of the sampling rate; their median does not see impacts. 0 for fewer than seven samples.
double WhiteNoise(const std::vector<double>& values);

}  // namespace dynoproof::score
