// Following a log that is still being written.
#pragma once

#include "common.hpp"

namespace goingrate::apps {

/// Prints the row of each beat as it arrives, and says on standard error when none has come for
/// `alarm_s` seconds (0: five periods), and when they come again. Ends with the pipe, or never.
void follow(const LogOptions& options, double alarm_s, const GlobalOptions& global);

} // namespace goingrate::apps
