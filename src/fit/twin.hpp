// The other clocks that fit a stationary log with a noisy drive. Private to the fit room.
//
// Such a log shows only the spectral density of its rate. Per cycle, with the relaxation
// a = 4 pi eps, b that of the slow drive, R the slow gain over the fast one, and d and s the sizes
// of fast and slow drive, the density is
//   fast^2 d^2 (w^2 + a^2 R^2) (w^2 + b^2 (1 + 2 s^2/(b d^2))) / ((w^2 + a^2) (w^2 + b^2)):
// a level, two poles and two zeros. It does not show which pole and which zero are the clock's, or
// the sign of R. With u = 1/sqrt(q^2 - 1), q = lambda/phi0 and the mean rate r,
//   R = u^2/2 + (r/eps) u - 1/2
// (from eqs. statam, statrate). Each other choice that has a u > 0 is a twin of the clock, with the
// same mean period and density, but another amplitude and drive.
#pragma once

#include "likelihood.hpp"

namespace goingrate::timing_model {

/// The coordinates of the twins of the clock at x; a twin that does not exist is nullopt, so that a
/// place in the list means the same choice for the same model. Empty unless the model has constant
/// torque, drive noise, free mu, phi0 and lambda0, and no events but those that change T0 alone.
std::vector<std::optional<std::vector<double>>> twins_of(const FitProblem& problem,
                                                         std::span<const double> x);

} // namespace goingrate::timing_model
