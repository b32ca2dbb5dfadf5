// Intervals of the profile likelihood. Private to the fit room.
#pragma once

#include "ridge.hpp"

namespace goingrate::timing_model {

/// The 68 % and 95 % interval of each coordinate, from the profile: L minimised over all other
/// coordinates. An interval ends where the profile has risen by (q w)^2/2, with q = 1 and 1.96 and
/// w the widening (stated sigma over the curvature's). On each side, L is first evaluated at 1.96
/// stated sigma, after one scoring step in the other coordinates, and compared with the parabola:
/// - within a tenth of it, the ends are those of the parabola;
/// - up to 1.5 times as high, sqrt(2 rise) is taken as a second-order polynomial of the
///   distance, through that value;
/// - lower or higher, the ridge (ridge.hpp) is followed to the ends.
/// Where the ridge is not followed (the model does not hold, or the coordinate is hardly
/// determined) or is lost on the way, that polynomial serves for rises of 0.65 to 1.5 times the
/// parabola's, and other ends are infinite. An end is also infinite where the ridge does not rise
/// far enough within thirty sigma, and for a coordinate that the log does not determine.
///
/// `few` is the same fit on fewer beats, or null. It is evaluated instead of `all`, to save time,
/// if it gives every coordinate the same sigma of curvature within a fifth, or one below 0.05; a
/// jitter known to 1.5 % need not agree, as its interval is that of the curvature.
std::vector<Interval> intervals(const ProfiledPlace& all, const ProfiledPlace* few,
                                bool model_holds);

/// Points of the profile of one parameter, from below its 95 % interval to above it: to 15 % beyond
/// an end, or to three sigma if the end is open. They are interpolated between the values that
/// intervals() left in `interval` and cost no evaluation of L; if it left none, the ridge is
/// followed. ClockFitTest.AProfileIsThatOfFitsWithTheParameterHeld. `few` as for intervals().
std::vector<ProfilePoint> profile_points(const ProfiledPlace& all, const ProfiledPlace* few,
                                         const Slot& slot, const Interval& interval);

/// The sigmas and intervals of the coordinates that the fit states.
struct Stated {
  Certainty known;
  std::vector<Interval> ends;
};

/// Widens the sigmas and intervals of all coordinates to contain the ridge of the one that the log
/// determines least: a point of the ridge where L has risen by r must lie within sqrt(2 r) sigma.
/// Where the ridge folds, the other coordinates turn back along it, and their curvature at the
/// minimum gives a sigma that is far too small.
void reach_along_the_ridge(const ProfiledPlace& place, std::span<const double> x, Stated& stated);

} // namespace goingrate::timing_model
