// Intervals of the profile likelihood. Private to the fit room.
#pragma once

#include "inference.hpp"

namespace goingrate::timing_model {

/// Where L, minimised over all other coordinates, has risen by q^2/2 (q = 1 and 1.96, times the
/// widening) on either side of the minimum. One look at 1.96 sigma, corrected by a scoring step in
/// the other coordinates, tells whether the parabola holds: then, within a tenth, it is taken;
/// where it is bent the root of the rise is taken for one, where it is broken from searches with
/// the coordinate held (or are open, if the model does not hold or the parameter is hardly
/// determined). Infinite where L does not rise far enough within eight sigma. Coordinates that are
/// not determined anyway get infinite ends.
std::vector<Interval> intervals(const FitProblem& problem, const Minimum& minimum,
                                const Certainty& known, bool model_holds);

/// Points of the profile of one parameter between its interval's ends and a little beyond, or three
/// sigma where an end is open: each by a look at the ridge and a scoring step of the others, or by
/// a search where that step gains much.
std::vector<ProfilePoint> profile_points(const FitProblem& problem, const Minimum& minimum,
                                         const Certainty& known, const Slot& slot,
                                         const Interval& interval);

/// The problem with one coordinate held; its priors on that coordinate are dropped.
FitProblem with_held(const FitProblem& problem, std::size_t index, double coordinate);

} // namespace goingrate::timing_model
