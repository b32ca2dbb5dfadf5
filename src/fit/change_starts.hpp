// Starting clocks inferred from a change at a known cycle. Private to the fit room.
//
// With lambda^2 = X = 2 mu phi0/(pi epsilon) at rest, S = X/phi0^2, u = sqrt(S - 1) and kappa =
// phi0^2/16, the rate at rest is r = epsilon u - kappa S (eq. statrate). A change at m = 0 that
// takes a clock from rest to rest changes its rate by
//   r(m) = J + (D - J)(1 - exp(-4 pi epsilon m)) + (nonlinear terms),
// so the log determines epsilon, the jump J and the final difference D. The clocks that share these
// form a valley along u, in which a factor changes
//   mu by f:       f = 1 + J/(epsilon u), kappa = (epsilon (sqrt(f S - 1) - u) - D)/((f - 1) S)
//   phi0 by g:     g^2 = S - (u + J/epsilon)^2,
//                  kappa = (epsilon (sqrt(S/g - 1) - u) - D)/((g - 1) S)
//   epsilon by h:  J = 0, kappa = (epsilon (h sqrt(S/h - 1) - u) - D)/((1/h - 1) S)
#pragma once

#include "fit_setup.hpp"

namespace goingrate::timing_model {

/// Starting points along that valley, in stretches of which each is to give one, by the equations
/// for linear friction; all other coordinates are those of `otherwise`. Empty unless the model has
/// exactly one change, of mu, phi0 or epsilon, in a constant-torque clock with all of these and
/// lambda0 free, and some clock has such a change.
std::vector<std::vector<std::vector<double>>>
starts_by_change(const Parameters& parameters, const TimingData& data,
                 std::span<const double> otherwise);

} // namespace goingrate::timing_model
