// Writing logs.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <string>

namespace goingrate {

/// The native text of a log: '#' header lines, a row of column names (time_s, and edge and
/// amplitude_rad where the log has them), one row an event with `decimals` digits of the second.
/// read_log gives back the same events (WritingTest.ReadsBackWhatWasWritten).
std::string native_log_text(const ClockLog& log, int decimals);

} // namespace goingrate
