// The steps of reading a log, whether it is one file, several, or one that grows.
#pragma once

#include "lines.hpp"
#include "row_reader.hpp"

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/reading.hpp"

#include <functional>
#include <limits>
#include <string_view>

namespace goingrate {

inline constexpr std::size_t head_lines = 400; ///< settle formats and units

/// Throws ArgumentError for options that are invalid for any file.
void check(const ReadingOptions& options);

/// Throws InputError if a format was given, and the file is a recording of `sound` and should not
/// be, or is none and should be.
void refuse_another_format(bool sound, const std::string& name, const ReadingOptions& options);

/// Determines the layout from the first lines, which are no longer needed afterwards; `whole` if
/// the log has no others. Assumptions are added to `log`. Throws InputError if they are not a log.
Layout settle_layout(std::string_view text, bool whole, ClockLog& log,
                     const ReadingOptions& options);

/// Whether the rows of one layout may be read as those of the other.
bool is_same(const Layout& a, const Layout& b);

/// Whether times are calendar times: dates, MJD, or seconds since 1970. Seconds above 1e8, which is
/// 1973, count as such; a logger's own counter would have to run for three years to reach that.
/// `first` is one of the times.
bool are_dates(const Layout& layout, const Instant& first);
/// The origin from which the times count.
TimeOrigin origin_of(const Layout& layout, const Instant& first);

/// The number of lines to make room for.
std::size_t room_for(std::size_t lines_expected);

/// Adds the lines that are left of a text, or, if they give more events than `most_events`, some of
/// them. `progress` receives the share read. Returns whether the text has ended.
bool add_rows(LineReader& lines, RowReader& rows, const std::function<void(double)>& progress,
              std::size_t most_events = std::numeric_limits<std::size_t>::max());

/// Does what is possible only after all lines have been read: finds, repairs or refuses. `log` is
/// then ready.
void complete(ClockLog& log, RowReader& rows, const Layout& layout, const ReadingOptions& options);

} // namespace goingrate
