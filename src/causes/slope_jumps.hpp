// Where the slope of a series jumps. Private to the causes room.
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
/// of the stretch: in prefix sums over a year a window of a minute would be lost to rounding
/// (SlopeJumpsTest.ACenturyIsAsGoodAsAnHour).
double slope_of(const Track& track, std::size_t from, std::size_t to);

/// Slope jump at every point (0 within a window of the ends) and its robust scatter over the log.
struct Jumps {
  std::vector<double> jump;
  double scatter = 0.0;
  [[nodiscard]] double score(std::size_t i) const { return std::abs(jump[i]) / scatter; }
};

/// The jumps of a track between the `window` points before and after each one, with what a smooth
/// bend makes taken off. Their scatter is at least `least_scatter`.
Jumps slope_jumps(const Track& track, std::size_t window, double least_scatter);

} // namespace goingrate::timing_model
