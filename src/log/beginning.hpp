// What a log's beginning tells, whether it is read as a whole or as it grows.
#pragma once

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/reading.hpp"

#include <string_view>

namespace goingrate {

/// Throws ArgumentError for what could not be counted with, however the file looks.
void check(const ReadingOptions& options);

/// What the log is, from its first lines, which are not needed any more then; `whole` if they are
/// all of it. What was assumed is added to `log`. Throws InputError if they are no log.
Layout settle_layout(std::string_view text, bool whole, ClockLog& log,
                     const ReadingOptions& options);

} // namespace goingrate
