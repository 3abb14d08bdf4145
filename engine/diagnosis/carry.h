// Candidates from their first look through all levels, side by side.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "diagnosis/conduct.h"
#include "diagnosis/contestant.h"

namespace dynoproof::diagnosis {

/// Fits a model at one level with columns of another fit, as far as they lead: of the null's those of the effect are new, one run for each of its
/// numbers.
estimation::Estimate FitRoughly(const Contestant& contestant, const Contestant& null, const Levels& levels,
                                std::size_t level, const Eigen::VectorXd& from,
                                const std::optional<estimation::KnownColumns>& known);
/// The same with columns of its own.
estimation::Estimate FitFully(const Contestant& contestant, const Contestant& null, const Levels& levels,
                              std::size_t level, const Eigen::VectorXd& from);
/// Whether a fit leaves so much more than the best one that its last digits decide nothing.
bool IsFarBehind(const estimation::Estimate& estimate, const Contestant* leader, const Levels& levels,
                 std::size_t level);

/// Why a model is not fitted at a level that only leads to the exact minimum of the free run: it is far from the noise before, and
/// has no such minimum, or there already. Empty: it is fitted.
std::string SteppedOver(const Contestant& contestant, const Levels& levels, std::size_t level);

/// `contestants`: the null first, which is fitted at all levels already; each of the others holds at `first` or at the next
/// level. At each level all are fitted once more from the values of the one that leaves least, the null too. Nobody is
/// followed further who removes next to nothing where another removes most, or whom a model beats that leaves nothing but
/// noise. False where the conduct has ended it before the free run.
bool Carry(std::span<Contestant> contestants, const Levels& levels, std::size_t first, const Conduct& conduct);

}  // namespace dynoproof::diagnosis
