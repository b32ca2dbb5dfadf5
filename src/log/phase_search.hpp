// Finds where the beats begin, or where they continue after they were lost.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <optional>
#include <span>

namespace goingrate {

/// The criteria by which beats are looked for.
struct PhaseSearch {
  double period_s = 0.0;
  double tolerance_s = 0.0; ///< how far a beat may be off the grid
  double window = 12.5; ///< periods looked at: enough to outvote a tenth of false or missed ones
  double absence = 8.0; ///< periods without an event after which nothing is looked for
};

/// The first event at or after `from` that stands on one grid of the period with most of the events
/// of the window. Each event is tried: a missed or false one among them does not make the others
/// bad. Downward crossings and bounces are passed over. Nothing if fewer than four events agree, or
/// fewer than there are before an absence or the end of the log.
std::optional<std::size_t> find_steady_beat(std::span<const Beat> events, std::size_t from,
                                            const PhaseSearch& search);

/// The events from `from` on, at most four, up to an absence.
int events_before_absence(std::span<const Beat> events, std::size_t from,
                          const PhaseSearch& search);

/// The period of the first beats from index `from` on: the median of the first five steps of the
/// commonest length in the window, between two thirds and one and a half of `period_s`, which of a
/// clock that rings down from a wide swing may be far off; `period_s` itself if there are not four
/// of them or the median is not beyond four of its standard errors from it.
double local_period(std::span<const Beat> events, std::size_t from, const PhaseSearch& search);

} // namespace goingrate
