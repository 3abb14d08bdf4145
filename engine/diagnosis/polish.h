// A model that is named, fitted to the minimum itself, and to all of the records.
#pragma once

#include <vector>

#include "diagnosis/contestant.h"

namespace dynoproof::diagnosis {

/// Fits a model that leaves nothing but noise to the minimum itself at a level, as exactly as the scenario `as` is simulated. A contest
/// ends its fits where what a step would still gain tells no model from another, up to a standard deviation before it, and
/// simulates in substeps and modes in which nobody sees the nominal model change, but a lag or a delay does. Whether the fit
/// is exact there; otherwise nothing changes.
bool Polish(Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level, const Plan& as);

/// Fits a model that is named to all of what models are fitted to, `records`, or to ten times the part that the search has looked at: an order
/// of an angle is told by the whole of a record only. From where it was, over ever longer parts, for the error of a longer run has more
/// minima. One that leaves nothing but noise in its free run goes on while it does so, any other while its free run leaves no more than before; else
/// it stays as it was. Returns the simulations beside those of `levels`, of as much as these simulate.
double FitToAll(Contestant& contestant, const Levels& levels, std::size_t level,
                const std::vector<MappedRecord>& records, const Plan& plan, const Registry& registry);

/// Half of the 95 % interval of each coordinate of a fit: of its scatter from block to block, and of its curvature where that is more.
Eigen::VectorXd HalfIntervalOf(const estimation::Estimate& fit, const estimation::DataSet& data,
                               const estimation::Hypothesis& hypothesis);

}  // namespace dynoproof::diagnosis
