// How well the beats of a made recording are found.
#pragma once

#include "sound/recordings.hpp"

#include <cstddef>

namespace goingrate::test {

struct TickScore {
  std::size_t beats = 0, found = 0, false_beats = 0;
  std::size_t within68 = 0, within95 = 0; ///< of those found, from the median error of their kind
  double bias_s[2] = {0.0, 0.0};          ///< median error of ticks, of tocks
  double scatter_s = 0.0;                 ///< 1.48 times the median size of what is left
  double sigma_s = 0.0;                   ///< the median of those stated
  double period_s = 0.0;
  bool swaps = false; ///< a tick becomes a tock on the way

  [[nodiscard]] double recall() const {
    return static_cast<double>(found) / static_cast<double>(beats);
  }
};

/// A beat counts as found if one, and only one, is told within 5 ms of it.
TickScore score(const ClockSound& clock, std::optional<double> nominal_period_s = {});

} // namespace goingrate::test
