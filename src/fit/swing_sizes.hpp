// Ends of a search for clocks that swing far and clocks that swing little. Private to the fit room.
#pragma once

#include "search.hpp"

namespace goingrate::timing_model {

/// The ends of searches for clocks of every size of swing, from the best end of an earlier search.
/// If T0 is open, times alone show the size of a swing only by its circular error; with a varying
/// drive, clocks of several sizes explain a change about equally well, and no search crosses the
/// hills between them. So each size is searched for, at first with the size held. Empty if the log
/// determines the size.
std::vector<Minimum> ends_of_every_size(const FitProblem& problem, const Minimum& best);

} // namespace goingrate::timing_model
