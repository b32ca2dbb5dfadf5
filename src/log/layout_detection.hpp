// Detection of the layout of a log.
#pragma once

#include "log_head.hpp"

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/reading.hpp"

namespace goingrate {

/// The layout of the log whose beginning is `head`. Assumptions are appended to `log.assumptions`,
/// a header that does not match the columns to `log.issues`.
/// Throws InputError if the beginning resembles no known log.
Layout detect_layout(const LogHead& head, const ReadingOptions& options, ClockLog& log);

/// Sets columns as the user specifies: ROLE=PLACE[:UNIT], with the place a number from 1 or a name
/// in `head`.
/// Throws ArgumentError for a role, place or unit that does not exist.
void apply_columns(const std::vector<std::string>& columns, const LogHead& head, Layout& layout);

} // namespace goingrate
