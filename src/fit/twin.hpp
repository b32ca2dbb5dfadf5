// The other clocks that a stationary log with a noisy drive fits. Private to the fit room.
//
// Such a log shows the density of its rate. Per cycle, with a = 4 pi eps the relaxation, b that of
// the slow drive, R the slow gain over the fast one, d and s the sizes of fast and slow drive,
//   fast^2 d^2 (w^2 + a^2 R^2) (w^2 + b^2 (1 + 2 s^2/(b d^2))) / ((w^2 + a^2) (w^2 + b^2)):
// a level, two poles and two zeros. Which pole and which zero is the clock's it does not show, nor
// the sign of R. With u = 1/sqrt(q^2 - 1), q = lambda/phi0 and the mean rate r,
//   R = u^2/2 + (r/eps) u - 1/2
// (from eqs. statam, statrate). Each other choice that has a u > 0 is a twin of the clock, with the
// same mean period and density, but another amplitude and drive.
#pragma once

#include "likelihood.hpp"

namespace goingrate::timing_model {

/// The coordinates of the twins of the clock at x; nothing in the place of one that does not exist,
/// so that places in the list mean the same choice for the same model. Empty unless there are
/// constant torque, drive noise, events that change T0 alone, and mu, phi0 and lambda0 free.
std::vector<std::optional<std::vector<double>>> twins_of(const FitProblem& problem,
                                                         std::span<const double> x);

} // namespace goingrate::timing_model
