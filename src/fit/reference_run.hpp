// The error of first-order averaging, found by running other dynamics once. Private to the fit
// room.
#pragma once

#include "likelihood.hpp"

#include "goingrate/fit/clock_fit.hpp"

namespace goingrate::timing_model {

/// Velocity at the crossing over averaged amplitude in the limit cycle of the first clock; 1 if it
/// has none.
double limit_cycle_ratio(const Parameters& parameters, std::span<const double> x);

/// The difference between the crossings of `dynamics` (averaged2 or map) and the averaged ones at
/// x, both undisturbed; nullopt if that clock stops before the log ends, or if those dynamics do
/// not support the laws. Cost: 40 to 600 ns per period until the clock has settled, none after.
std::optional<Correction> difference_to(FitDynamics dynamics, const FitProblem& problem,
                                        std::span<const double> x);

/// How that difference changes with each coordinate of the clock, by finite differences: one more
/// run for each. nullopt if the clock, or one close to it, does not run.
std::optional<Correction::Slopes> slopes_of_difference(FitDynamics dynamics,
                                                       const FitProblem& problem,
                                                       std::span<const double> x);

} // namespace goingrate::timing_model
