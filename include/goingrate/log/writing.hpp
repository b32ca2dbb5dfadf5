// Writing logs.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <optional>
#include <string>

namespace goingrate {

/// The native text of a log: '#' header lines, a row of column names (time_s, and edge and
/// amplitude_rad where the log has them), one row an event with `decimals` digits of the second.
/// read_log gives back the same events (WritingTest.ReadsBackWhatWasWritten).
std::string native_log_text(const ClockLog& log, int decimals);

/// The same, piece by piece, for logs that are written as they grow.
struct NativeColumns {
  bool edge = false, amplitude = false;
  int decimals = 9;
};
std::string native_log_header(const NativeColumns& columns, std::optional<double> nominal_period_s);
void append_native_line(std::string& text, const Beat& event, const NativeColumns& columns);

} // namespace goingrate
