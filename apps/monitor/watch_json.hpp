// What a monitor answers with.
#pragma once

#include "clock_watch.hpp"

#include <string>

namespace goingrate::apps {

/// The answers of a monitor at one moment.
struct WatchAnswers {
  std::string now, minutes, hours, days, alarms, breaks; ///< JSON
  std::string metrics;                                   ///< for Prometheus
};

/// `name`: of the clock. Rates in s/day, amplitudes in rad, times in seconds since 1970; what is
/// not known is null.
WatchAnswers answers_of(const ClockWatch& watch, const std::string& name, const Instant& now);

} // namespace goingrate::apps
