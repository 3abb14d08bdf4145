// The oscillation at which the torque feedthrough ends when nothing suppresses it (Figs. 2.4, 5.1), by its describing
// function: the limit of the torque lets through the share N(a) of a sine of a times the limit, so that the loop
// oscillates steadily where it is on the brink of stability with the gain k_V N(a) in the place of k_V.
#pragma once

#include <functional>
#include <vector>

#include "base/status.h"
#include "thesis/suppression_loop.h"

namespace dynoproof {

/// N(a) = (2/pi) (asin(1/a) + sqrt(1 - 1/a^2)/a): fundamental behind a limit of 1 over the sine's amplitude a before it;
/// 1 up to a = 1.
double SaturationGain(double a);

struct LimitCycle {
  double frequency_Hz, T_shaft_Nm;  // amplitude
  double border_gain;               // k_V at which the loop neither falls nor grows
};

/// `modes`: of the linear loop by its gain, as FilteredLoopModes gives them. The fastest mode within 20 Hz of `near_Hz` must
/// grow at k_V and fall with the gain; else fails (exit code 2). T_limit [N m]: of the command.
Result<LimitCycle> PredictLimitCycle(const std::function<Result<std::vector<FilteredLoopMode>>(double k_V)>& modes,
                                     double k_V, double near_Hz, double T_limit_Nm);

}  // namespace dynoproof
