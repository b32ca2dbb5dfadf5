// From the user's options to a parametrised problem, and where to start. Private to the fit room.
#pragma once

#include "fit_problem.hpp"

namespace goingrate::timing_model {

/// The slots for a clock with (`driven`) or without an escapement. Throws ArgumentError for fixed
/// names that do not exist, values out of range and events that make no sense.
Parameters make_parameters(const FitOptions& options, const TimingData& data, bool driven);

/// The name a result has: "epsilon", "mu@1".
std::string name_of(const Slot& slot);

/// Weak priors about a start, and those the user states. A logarithm may move by e^5, T0 by 1 %, a
/// changed torque by five times the first: wide beside anything a log determines.
std::vector<CoordinatePrior> make_priors(const FitOptions& options, const Parameters& parameters,
                                         std::span<const double> start);

/// Starting points that cover the clocks people have: friction from 1e-5 to 3e-3, amplitudes from
/// 0.02 to 0.2 rad (or the log's own), one to four times the switching angle, at rest in its
/// stationary swing or half or one and a half times it. Events start from the jump seen in the
/// rate.
std::vector<std::vector<double>> starting_points(const Parameters& parameters,
                                                 const TimingData& data);

/// At most `count` beats, evenly spread but denser just after events and at both ends.
TimingData thinned(const TimingData& data, const Parameters& parameters, std::size_t count);

} // namespace goingrate::timing_model
