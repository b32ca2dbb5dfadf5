// Finds the period of a clock from the repetition of its loudness.
#pragma once

#include "loudness.hpp"

#include <optional>

namespace goingrate {

/// The pattern in which beats follow each other, in bins of the loudness.
struct TickPattern {
  double period = 0.0;     ///< of the oscillation
  bool has_tocks = true;   ///< false: one sound per period
  bool is_even = false;    ///< one sound repeats, and is taken for both
  double tock_after = 0.0; ///< from a tick to its tock
};

/// The pattern, by the autocorrelation of the loudness; nullopt if it does not repeat. The lag at
/// which it repeats best is a period, or half of one if there is only one sound in it. `nominal`,
/// in bins, is taken to be right to 3 %.
std::optional<TickPattern> find_pattern(const Loudness& loudness, double bins_a_second,
                                        std::optional<double> nominal);

} // namespace goingrate
