// Where the beats begin, or go on after they were lost.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <optional>
#include <span>

namespace goingrate {

/// The first event at or after `from` that stands on one grid of the period with most of the events
/// of the next dozen periods. Each event is tried: a missed or false one among them does not make
/// the others bad. `tolerance_s` is how far a beat may be off the grid. Downward crossings are
/// passed over. Nothing if fewer than four events agree (fewer are enough at the end of the log).
std::optional<std::size_t> find_steady_beat(std::span<const Beat> events, std::size_t from,
                                            double period_s, double tolerance_s);

/// The period of the beats from index `from` on, within a dozen periods: the median of the steps
/// that are within a tenth of `period_s`, which of a clock that rings down may be some per cent
/// off; `period_s` itself if there are not four of them or the median is not beyond four of its
/// standard errors from it.
double local_period(std::span<const Beat> events, std::size_t from, double period_s);

} // namespace goingrate
