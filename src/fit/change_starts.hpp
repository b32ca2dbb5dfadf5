// Clocks to start from that a change at a known cycle tells of. Private to the fit room.
//
// With lambda^2 = X = 2 mu phi0/(pi epsilon) at rest, S = X/phi0^2, u = sqrt(S - 1) and kappa =
// phi0^2/16 the rate at rest is r = epsilon u - kappa S (eq. statrate). One change at m = 0 from
// rest to rest makes
//   r(m) = J + (D - J)(1 - exp(-4 pi epsilon m)) + what is bent,
// so the log knows epsilon, the jump J and the difference in the end D, and all clocks of one u
// that share them lie in a valley:
//   mu by f:       f = 1 + J/(epsilon u), kappa = (epsilon (sqrt(f S - 1) - u) - D)/((f - 1) S)
//   phi0 by g:     g^2 = S - (u + J/epsilon)^2, kappa = (epsilon (sqrt(S/g - 1) - u) - D)/((g - 1)
//   S) epsilon by h:  J = 0, kappa = (epsilon (h sqrt(S/h - 1) - u) - D)/((1/h - 1) S)
#pragma once

#include "fit_setup.hpp"

namespace goingrate::timing_model {

/// Starting points along that valley, each with the noise and the terms of `otherwise`; none where
/// the model has not exactly one change, of one of these, in a clock of linear friction and
/// constant torque that is free, or where no clock has such a change.
std::vector<std::vector<double>> starts_by_change(const Parameters& parameters,
                                                  const TimingData& data,
                                                  std::span<const double> otherwise);

} // namespace goingrate::timing_model
