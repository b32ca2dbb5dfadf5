// Dates and times of day as text.
#pragma once

#include "goingrate/base/instant.hpp"

#include <optional>
#include <string_view>

namespace goingrate {

/// A date with a time of day, s since 1970-01-01 UTC, or a time of day alone, s since midnight.
struct CalendarTime {
  Instant time;
  bool has_date = false;
  bool has_zone = false;
};

/// Reads 2013-02-22 23:38:00.2279906: date in the order year, month, day with '-', '_', '/' or '.'
/// between; a blank, 'T', '_' or '-'; hours, minutes, seconds with ':', '-' or '_' between; then
/// nothing, 'Z', 'UTC' or +hh:mm. Or a time of day alone, with ':' between. The fraction of the
/// second loses nothing (CalendarTest.ReadsWhatLoggersWrite). Nothing if `text` is something else.
std::optional<CalendarTime> parse_calendar(std::string_view text, char point = '.');

} // namespace goingrate
