// The other clock that a stationary log with a noisy drive fits. Private to the fit room.
//
// Such a log shows |H|^2, the response to drive noise, and so the ratio of the slow gain to the
// fast one but for its sign. With u = 1/sqrt(q^2 - 1), q = lambda/phi0 and the mean rate r,
//   slow/fast = u^2/2 + (r/eps) u - 1/2
// (from eqs. statam, statrate), which takes the opposite value at another u > 0. There stands a
// twin of the clock, with the same friction, mean rate and spectrum, but another amplitude and
// drive.
#pragma once

#include "likelihood.hpp"

namespace goingrate::timing_model {

/// The coordinates of the twin of the clock at x, where there is one: constant torque, no events,
/// drive noise, and mu, phi0 and lambda0 free.
std::optional<std::vector<double>> twin_of(const FitProblem& problem, std::span<const double> x);

} // namespace goingrate::timing_model
