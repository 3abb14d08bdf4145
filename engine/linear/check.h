// Refuses a network that the analysis cannot mean anything for, before any matrix is built from it.
#pragma once

#include "base/status.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

/// Every inertia finite and positive, every stiffness and damping finite and not negative, every edge between two
/// different existing nodes or a node and the ground, at least one node. The failure names the first offender.
Status CheckNetwork(const Network& network);

}  // namespace dynoproof::mechanics
