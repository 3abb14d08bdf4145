// The white noise on a signal.
#pragma once

#include <vector>

namespace dynoproof::score {

/// Standard deviation of the white noise on a signal with equal steps. Differences of the sixth order leave next to nothing of motion
/// below a tenth of the sampling rate; their median does not see impacts. What moves faster they take for noise, but noise is there at
/// all frequencies: where an eighth of them has less than half that power, in at least 2000 samples, that is the noise. 0 for fewer
/// than seven samples.
double WhiteNoise(const std::vector<double>& values);

}  // namespace dynoproof::score
