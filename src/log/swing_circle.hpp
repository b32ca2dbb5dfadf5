// The circle on which the bob of a pendulum moves. Private to the log room.
#pragma once

#include <optional>
#include <span>

namespace goingrate {

/// Centre and radius in the unit of the places. `radius_sigma` is that of the radius under the
/// scatter of the places about the circle.
struct SwingCircle {
  double x = 0.0, y = 0.0, radius = 0.0;
  double radius_sigma = 0.0;

  /// The angle from the line through the centre along y, on the side of the arc; rad.
  [[nodiscard]] double angle_of(double place_x, double place_y) const;
  bool hangs_below = true; ///< the arc lies at smaller y than the centre
};

/// The circle of least squared distance to the places. nullopt if there are fewer than ten, or if
/// the arc is too flat to determine the radius to a fifth.
/// (SwingCircleTest.FindsLengthAndCentre)
std::optional<SwingCircle> circle_through(std::span<const double> x, std::span<const double> y);

} // namespace goingrate
