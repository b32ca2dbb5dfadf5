// Parameters of a clock that change at a known or found time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace goingrate {

/// A change that somebody made on purpose: the intended ratio of the new value to the old, and its
/// standard deviation.
struct PlannedRatio {
  double ratio = 1.0;
  double sigma = 0.0; ///< above 0
};

/// Parameters that change at a cycle.
struct FitEvent {
  std::int64_t cycle = 0;         ///< counted from the first beat of the data
  std::vector<std::string> names; ///< of mu, epsilon, phi0, T0 (or impulse, impulse_angle)
  bool movable = false; ///< found by a search or given by time: the fit may shift it by some cycles
  /// The planned ratio of the first of `names`: its value after the event over that before.
  std::optional<PlannedRatio> planned{};
  /// The change takes effect exactly at that crossing, as a simulated one does. Otherwise, or if
  /// the event is movable, it may have come at any moment of the neighbouring swings.
  bool at_crossing = true;

  /// Whether the change is known to have come exactly at the crossing.
  [[nodiscard]] bool has_known_moment() const { return at_crossing && !movable; }
};

} // namespace goingrate
