// From the averaged model of first order to dynamics that are nearer the clock. Private to the fit
// room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// Makes the problem one of second order about a place.
void extend(FitProblem& problem, std::span<const double> x);

/// Makes it the fit of other dynamics, by adding what they differ by until that stands still; false
/// (and nothing changed) if they cannot be run there.
bool refine(Fitted& fitted, FitDynamics dynamics);

/// Whether a fit of first order under jitter alone misses the times by ten times what second order
/// would add to them, so that no refinement makes it explain the log.
bool is_hopeless(const Fitted& fitted);

/// The same from every place where the search came to rest: the best of them, the others as rivals
/// if they are nearly as good.
bool refine_every_end(Fitted& fitted, FitDynamics dynamics);

} // namespace goingrate::timing_model
