// The logbook of a clock's keeper: when the clock was regulated, wound, stopped, cleaned.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// What was done to a clock, and the meaning of the entry's value.
enum class LogbookWord : std::uint8_t {
  rate,   ///< regulated, by the nut or on the tray: the change of the rate, s/day, positive: faster
  weight, ///< another driving weight: the relative change of the drive
  clean,  ///< cleaned or oiled: the relative change of the friction
  set,    ///< the hands were set: by this many s, positive: forward
  wind,   ///< wound: no value
  stop,   ///< the clock stopped
  start,  ///< the clock was started again
  note,   ///< anything else
};
std::string_view name_of(LogbookWord word);

/// One entry.
struct LogbookEntry {
  Instant time; ///< counted as the log's times are
  bool whole_day = false; ///< only the date is given; `time` is its first moment
  bool has_zone = false;  ///< the date names its zone; else it is that of the log's dates
  LogbookWord what = LogbookWord::note;
  double value = std::numeric_limits<double>::quiet_NaN(); ///< as planned; NaN: none
  double sigma = 0.0;                                       ///< of the planned value
  std::string note;
  std::uint32_t line = 0;
};

/// The entries of one file, in order of time.
struct Logbook {
  std::string source;
  TimeOrigin origin = TimeOrigin::none;
  std::vector<LogbookEntry> entries; ///< may be none
};

/// Reads a table with the columns time, what, value, sigma and note in any order, separated by
/// commas, semicolons or tabs; only time and what are needed, fields may be quoted, '#' begins a
/// comment. Times are dates (with the time of day or alone), or seconds as in a log without
/// dates. Throws InputError (file, line, column) for anything else: the table was written by hand,
/// and no part of it is skipped silently.
Logbook read_logbook(const std::string& path);

/// The same from a text.
Logbook parse_logbook(std::string_view text, const std::string& source);

/// The same with times counted as those of `log` are: dates that name no zone are in that of the
/// log's dates, or in UTC where these name none either. Throws InputError if one has dates and the
/// other has none.
Logbook brought_to(const ClockLog& log, Logbook logbook);

/// The text of such a file, times as the origin has them: dates to the second, with a Z for UTC
/// where an entry has a zone, or seconds.
std::string logbook_text(const Logbook& logbook);

} // namespace goingrate
