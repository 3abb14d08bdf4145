#pragma once
// Constants that several studies, checks and drawings share.

#include <limits>
#include <numbers>

namespace dynoproof {

inline constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
inline constexpr double kPeriod_s = 1e-4;                // of the control loop: 10 kHz
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace dynoproof
