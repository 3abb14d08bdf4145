// Computations behind the claims of thesis chapter 4; see studies.h.
#pragma once

#include "base/status.h"
#include "experiment/checks.h"
#include "model/registry.h"

namespace dynoproof {

/// The coupling's steady `quantity` (stiffness, damping) at `nu`; shaft "coupling" of `scenario`.
Result<Figure> CouplingSteady(const Registry& registry, const Value& parameters);
/// nu_0 of the choice of Sec. 4.2 for `scenario` with `static_stiffness`; with `shaft` as if the coupling sat there and
/// a shaft of `rigid_stiffness` in its place.
Result<Figure> CouplingFrequency(const Registry& registry, const Value& parameters);
/// k_p of (4.3): `form` integral (the printed integrand, by quadrature), printed (2 l r) or power (from the displaced
/// oil), over the derived one (l r).
Result<Figure> CouplingLever(const Registry& registry, const Value& parameters);
/// Reynolds number of the gap: `velocity`, `gap_height`, `width`, `viscosity`.
Result<Figure> CouplingReynolds(const Registry& registry, const Value& parameters);
/// The angle 2 beta / kappa_w that a chamber spans by (4.18), for the printed kappa_w of `scenario` and `bulk_modulus`.
Result<Figure> CouplingChamberAngle(const Registry& registry, const Value& parameters);
/// Frequency of the slowest oscillation of `scenario` with its speed control: dynamometer and engine each one inertia,
/// the control taken as continuous; eigenvalues of six equations written down by hand. With `figure`, a frequency that
/// the checks of `kind` find out: how far the run's peak is from it, in half power half widths of that oscillation.
Result<Figure> CouplingClosedLoop(const Registry& registry, const Value& parameters);
/// Runs `scenario`, then with its coupling replaced by `first` and by `second` (tables of law and parameters): NRMSE of
/// `signal` with the first over that with the second, during `during_s`.
Result<Figure> CouplingRivals(const Registry& registry, const Value& parameters);

}  // namespace dynoproof
