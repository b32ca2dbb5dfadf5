// Follows a clock's beats through noise, to a millisecond.
#pragma once

#include "loudness.hpp"
#include "tick_period.hpp"

#include <vector>

namespace goingrate {

/// A beat found in the loudness.
struct RoughTick {
  double bin = 0.0; ///< where it begins
  bool is_tock = false;
  double score = 0.0;     ///< ln(likelihood with a beat / without), at the best of the places tried
  bool clock_goes = true; ///< the beats around it are heard
  bool stands_out = true; ///< from the noise, while the clock goes; else only expected there
};

/// The result of following a clock.
struct TickTrack {
  std::vector<RoughTick> ticks;
  TickPattern pattern; ///< refined
};

/// Follows the beats: the likeliest course of the phase under a likelihood of the loudness given a
/// beat that sounds like the mean, learnt on the way, with small steps from period to period and
/// rare jumps (Viterbi).
TickTrack track_ticks(const Loudness& loudness, TickPattern pattern);

} // namespace goingrate
