// Parsing of dates and times of day.
#pragma once

#include "goingrate/base/instant.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace goingrate {

/// A date with a time of day, or a time of day alone.
struct CalendarTime {
  Instant time; ///< with a date: s since 1970-01-01 UTC; without: s since midnight, in its own zone
  bool has_date = false;
  double zone_s = 0.0;   ///< east of Greenwich
  bool has_zone = false; ///< the text names a zone; a date without one is taken as UTC
};

/// Behind a date alone: its time of day.
inline constexpr std::string_view midnight = " 0:00";

/// Which number of 03/04/2013 is the day.
enum class DateOrder : std::uint8_t {
  either, ///< the first, or, if that gives no date, the second
  day_first,
  month_first,
};

/// Parses a timestamp such as 2013-02-22 23:38:00.2279906, which consists of:
/// - a date: year, month and day separated by '-', '_', '/' or '.', or in the forms 22.02.2013
///   and 22/02/2013, or 02/22/2013, as `order` says, or 22 Feb 2013 with the English name of the
///   month or its first three letters;
/// - a blank, 'T', '_' or '-';
/// - hours, minutes and, optionally, seconds, separated by ':', '-' or '_', and AM or PM if hours
///   are counted to twelve;
/// - optionally a zone: 'Z', 'UTC', 'GMT' or an offset such as +hh:mm or -hhmm.
/// A time of day alone, separated by ':', is accepted too. `point` is the decimal separator. The
/// fraction of the second keeps all its digits (CalendarTest.ReadsWhatLoggersWrite). Returns
/// nullopt if `text` has any other form.
std::optional<CalendarTime> parse_calendar(std::string_view text, char point = '.',
                                           DateOrder order = DateOrder::either);

/// Seconds east of Greenwich of "Z", "UTC", "GMT", "+01:00", "-0530" or "+01"; nothing for other
/// text.
std::optional<std::int64_t> zone_named(std::string_view text);

} // namespace goingrate
