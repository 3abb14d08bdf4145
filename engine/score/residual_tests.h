// What is left when no other candidate of explain.h holds: noise or a divergence. Internal to the layer.
#pragma once

#include <span>
#include <string>

#include "score/candidates.h"

namespace dynoproof::score {

/// White noise, and a divergence that starts at a moment. Only asked when nothing else explains the difference.
void AddNoise(const Pair& pair, const std::string& unit, Candidates& out);
void AddDivergence(const Pair& pair, Candidates& out);

/// How far the autocorrelation of a centred record over `lags` exceeds chance (Ljung-Box), as a score of the normal
/// distribution: white records exceed 3.1 once in a thousand.
double WhitenessScore(std::span<const double> centred, std::size_t lags);

}  // namespace dynoproof::score
