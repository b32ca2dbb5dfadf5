// The columns of a light gate that counts how long each of an oscillation's four intervals lasts.
#pragma once

#include "goingrate/log/layout.hpp"

#include <algorithm>
#include <array>

namespace goingrate {

/// In the order of TickTock's header: tick, tick_block, tock, tock_block. In time each dark
/// interval comes before the light one next to it.
inline constexpr std::array gate_intervals{ColumnRole::tick_light, ColumnRole::tick_dark,
                                           ColumnRole::tock_light, ColumnRole::tock_dark};

/// Hz, of an Arduino Nano Every and most of its kin.
inline constexpr double usual_counter_hz = 16e6;

inline bool is_gate_interval(ColumnRole role) {
  return std::find(gate_intervals.begin(), gate_intervals.end(), role) != gate_intervals.end();
}

} // namespace goingrate
