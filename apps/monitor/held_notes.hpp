// Comments on events that are not events of the archive, or not yet.
#pragma once

#include "arrivals.hpp"

#include <string>
#include <vector>

namespace goingrate::apps {

/// Note on an event behind a gap, which waits until others go on from it.
std::string waiting_note(const HeardEvent& event);
/// Note on an event that is not believed, as nothing goes on from it: nothing waits any more then.
std::string left_out_note(const HeardEvent& event);
/// Note on an event whose date is `error_s` seconds from the computer's.
std::string misdated_note(const HeardEvent& event, double error_s);
/// Values other than the time as NAME=VALUE, each after a blank; only those that are known.
std::string words_of(const EventValues& values);
/// The events that still waited at the end of a day, by its comments behind the last event. Their
/// times are the source's own.
std::vector<HeardEvent> still_waiting(const std::vector<std::string>& notes);

} // namespace goingrate::apps
