// Refines a fit of the averaged model of first order by more exact dynamics. Private to the fit
// room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// Makes the problem one of second order about a point.
void extend(FitProblem& problem, std::span<const double> x);

/// Makes it the fit of other dynamics, by adding their difference until that no longer changes;
/// false, with nothing changed, if they cannot be run there.
bool refine(Fitted& fitted, FitDynamics dynamics);

/// Whether a fit of first order with no noise but jitter misses the times by ten times the
/// correction of second order, so that no refinement can make it explain the log.
bool is_hopeless(const Fitted& fitted);

/// The refinement from every point at which the search ended: the best result, with the others as
/// rivals if they are nearly as good.
bool refine_every_end(Fitted& fitted, FitDynamics dynamics);

} // namespace goingrate::timing_model
