// A contest carries on the first `kept` candidates of its first look, which `ranked` holds with the best one first. Each function here adds
// candidates to them and returns the new number; the others move back. `first`: the level of the look.
#pragma once

#include <span>
#include <vector>

#include "diagnosis/contestant.h"

namespace dynoproof::diagnosis {

/// A law is carried with the plainer one that it refines at its place, from the same values: of the two the plainer one is
/// named where it does. Both stand among the first, of which there are as many as is told.
std::size_t WithPlainerLaws(std::vector<Contestant>& ranked, std::size_t kept, std::size_t first);

/// What removes most at one place may sit at another one, whose own fit has come nowhere from its own start, as beside a gap: there the
/// effect is fitted once more from the numbers of the first, and carried where it is not far behind.
std::size_t WithItsOtherPlaces(std::vector<Contestant>& ranked, std::size_t kept, const Contestant& null,
                               const Levels& levels, std::size_t first, const Magnitudes& magnitudes);

/// A null that was let go has swallowed some of its missing effect: at the short memory of a first look another one may remove more of what
/// is left. What was admitted beside the nominal values is compared in any case.
std::size_t WithAdmitted(std::vector<Contestant>& ranked, std::size_t kept, std::span<const Contestant> admitted,
                         const Contestant& null, const Levels& levels, std::size_t first, const Magnitudes& magnitudes);

}  // namespace dynoproof::diagnosis
