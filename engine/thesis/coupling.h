// Hydrodynamic couplings in a drive line (thesis chapter 4): the choice of a Kelvin-Voigt model for it, and its steady
// values beside a data sheet and the oil model.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "linear/network.h"
#include "model/value.h"
#include "plugins/law/hydrodynamic_coupling/oil_coupling.h"

namespace dynoproof {

/// Reads a data sheet: a text file of columns nu, k and c, units in the second row; converted to SI.
Result<mechanics::CouplingTable> ReadCouplingTable(const std::string& file);

/// One mode as the choice sees it.
struct CouplingMode {
  double nu_rad_per_s;
  double share;  // of the coupling's twist in the sum of the twists of all shafts
};
/// The choice of Sec. 4.2: the coupling as a spring of its static stiffness without damping, nothing controlled; all
/// modes scaled to the same sum of absolute twists; nu_0 is the mode in which the coupling twists most.
struct CouplingChoice {
  double static_stiffness, nu_0;    // [N m/rad], [rad/s]
  std::vector<CouplingMode> modes;  // elastic ones, rising
};
/// Fails (exit code 2) when there is no such shaft or no elastic mode.
Result<CouplingChoice> ChooseCouplingMode(const mechanics::Network& network, const std::string& shaft,
                                          double static_stiffness);

/// Steady stiffness and damping of the coupling that the plan has, at nu: kelvin_voigt, spring_damper or oil_coupling;
/// nothing for another law.
std::optional<mechanics::DynamicValues> SteadyValues(const Value& shaft, double nu_rad_per_s);

}  // namespace dynoproof
