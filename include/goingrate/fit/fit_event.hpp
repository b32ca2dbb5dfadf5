// Parameters of a clock that change at a known or found time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace goingrate {

/// A change that somebody made on purpose: new over old, as intended, and how well it was done.
struct PlannedRatio {
  double ratio = 1.0;
  double sigma = 0.0; ///< above 0
};

/// Parameters that change at a cycle.
struct FitEvent {
  std::int64_t cycle = 0;         ///< counted from the first beat of the data
  std::vector<std::string> names; ///< of mu, epsilon, phi0, T0 (or impulse, impulse_angle)
  bool movable = false;           ///< found by a search: the fit may shift it by some cycles
  /// What is known beforehand of the first of `names`: its value after the event over that before.
  std::optional<PlannedRatio> planned{};
  /// It takes effect at that crossing, as a simulated change does. Otherwise, and where it is
  /// movable, it may have come at any moment of the neighbouring swings.
  bool at_crossing = true;

  /// Whether it came just at the crossing.
  [[nodiscard]] bool has_known_moment() const { return at_crossing && !movable; }
};

} // namespace goingrate
