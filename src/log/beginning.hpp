// The steps of reading a log, whether it is one file, several, or one that grows.
#pragma once

#include "lines.hpp"
#include "row_reader.hpp"

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/reading.hpp"

#include <functional>
#include <string_view>

namespace goingrate {

inline constexpr std::size_t head_lines = 400; ///< settle formats and units

/// Throws ArgumentError for options that are invalid for any file.
void check(const ReadingOptions& options);

/// Determines the layout from the first lines, which are not needed any more then; `whole` if they
/// are all of it. What was assumed is added to `log`. Throws InputError if they are not a log.
Layout settle_layout(std::string_view text, bool whole, ClockLog& log,
                     const ReadingOptions& options);

/// Whether the rows of one may be read as those of the other.
bool is_same(const Layout& a, const Layout& b);

/// Whether times are calendar times: dates, MJD, or seconds since 1970, which seconds above 1e8 are
/// taken for. That is 1973; a logger's own counter would have to run for three years to reach it.
/// `first` is one of the times.
bool are_dates(const Layout& layout, const Instant& first);
/// What the times count from.
TimeOrigin origin_of(const Layout& layout, const Instant& first);

/// Lines to make room for.
std::size_t room_for(std::size_t lines_expected);

/// Adds all lines that are left of a text. `progress` receives the share read.
void add_rows(LineReader& lines, RowReader& rows, const std::function<void(double)>& progress);

/// What can be found, mended or refused only when all lines have been read: `log` is ready then.
void complete(ClockLog& log, RowReader& rows, const Layout& layout, const ReadingOptions& options);

} // namespace goingrate
