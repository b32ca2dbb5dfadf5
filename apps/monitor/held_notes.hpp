// Comments of events that are no events of the archive, or not yet.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <string>
#include <vector>

namespace goingrate::apps {

/// Of an event behind a gap, which waits until others go on from it.
std::string waiting_note(const Beat& event);
/// Of an event that is not believed, as nothing goes on from it: then nothing waits any more.
std::string left_out_note(const Beat& event);
/// Of an event whose date is so many seconds from the computer's.
std::string misdated_note(const Beat& event, double error_s);
/// The events that still waited at the end of a day, by its comments behind the last event. Their
/// times are the source's own.
std::vector<Beat> still_waiting(const std::vector<std::string>& notes);

} // namespace goingrate::apps
