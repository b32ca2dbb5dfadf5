// The moment at which something is heard.
#pragma once

#include "goingrate/log/clock_log.hpp"

namespace goingrate::apps {

/// A moment by two clocks: the computer's calendar, which may be set, and one that only runs on.
/// Durations are measured by the second.
struct Moment {
  Instant wall;          ///< since 1970
  double steady_s = 0.0; ///< since any time

  /// The moment by a calendar that cannot be set.
  Moment(const Instant& at) : wall(at), steady_s(at.to_double()) {}
  Moment(const Instant& at, double steady) : wall(at), steady_s(steady) {}

  /// How far the calendar is ahead of the steady clock: constant unless it is set.
  [[nodiscard]] double wall_less_steady_s() const { return wall - Instant::from_seconds(steady_s); }
};

} // namespace goingrate::apps
