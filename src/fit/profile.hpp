// Intervals of the profile likelihood. Private to the fit room.
#pragma once

#include "ridge.hpp"

namespace goingrate::timing_model {

/// Where L, minimised over all other coordinates, has risen by q^2/2 (q = 1 and 1.96, times the
/// widening) on either side of the minimum. One look at 1.96 sigma, corrected by a scoring step in
/// the other coordinates, tells whether the parabola holds: then, within a tenth, it is taken;
/// where it rises faster the root of the rise is taken for one, where it rises more slowly or much
/// faster the ridge is followed (or, if the model does not hold or the parameter is hardly
/// determined, the root is taken for a parabola, and the ends are open where it is none).
/// Infinite where L does not rise far enough within thirty sigma. Coordinates that are not
/// determined anyway get infinite ends. `few`, if given, is the same fit on beats that stand for
/// all: looks and ridges are those there, in units of sigma, if every sigma is the same there
/// within a fifth, or small.
std::vector<Interval> intervals(const ProfiledPlace& all, const ProfiledPlace* few,
                                bool model_holds);

/// Points of the profile of one parameter between its interval's ends and a little beyond, or three
/// sigma where an end is open: on the root that told the ends, so that they cost no look at the
/// log, and along the ridge where an end is open
/// (ClockFitTest.AProfileIsThatOfFitsWithTheParameterHeld). `few` as for intervals().
std::vector<ProfilePoint> profile_points(const ProfiledPlace& all, const ProfiledPlace* few,
                                         const Slot& slot, const Interval& interval);

/// What is stated of the coordinates.
struct Stated {
  Certainty known;
  std::vector<Interval> ends;
};

/// Widens sigmas and intervals to where the ridge of the most open coordinate leads. Where it
/// folds, the other coordinates turn back on the way, so that the curvature gives them a sigma that
/// is far too small. A foot of the ridge at a rise of L by r belongs within sqrt(2 r) sigma.
void reach_along_the_ridge(const ProfiledPlace& place, std::span<const double> x, Stated& stated);

} // namespace goingrate::timing_model
