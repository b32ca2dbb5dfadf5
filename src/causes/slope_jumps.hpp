// Jumps of the slope of a series. Private to the causes room.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace goingrate::timing_model {

/// A series against time.
struct Track {
  std::vector<double> time;
  std::vector<double> value;
};

/// Least-squares slope of the points [from, to). Cost: O(to - from). Sums are taken from the middle
/// of the stretch; prefix sums over a year would lose a window of a minute to rounding
/// (SlopeJumpsTest.ACenturyIsAsGoodAsAnHour).
double slope_of(const Track& track, std::size_t from, std::size_t to);

/// Slope jump at every point (0 within a window of the ends) and its robust scatter over the log.
struct Jumps {
  std::vector<double> jump;
  double scatter = 0.0;
  [[nodiscard]] double score(std::size_t i) const { return std::abs(jump[i]) / scatter; }
};

/// The jump of the slope at each point: that of the `window` points after it less that of those
/// before it, less the part that a smooth bend explains. The scatter is at least `least_scatter`.
Jumps slope_jumps(const Track& track, std::size_t window, double least_scatter);

} // namespace goingrate::timing_model
