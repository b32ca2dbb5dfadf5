// Comments on events that do not belong to the archive, or not yet.
#pragma once

#include "arrivals.hpp"

#include <string>
#include <vector>

namespace goingrate::apps {

/// Note on an event after a gap, which waits until others follow on from it.
std::string waiting_note(const HeardEvent& event);
/// Note on an event that is not accepted, because no other follows on from it; after it no event
/// waits any longer.
std::string left_out_note(const HeardEvent& event);
/// Note on an event whose date is `error_s` seconds from the computer's.
std::string misdated_note(const HeardEvent& event, double error_s);
/// The known values other than the time as NAME=VALUE, each after a blank.
std::string words_of(const EventValues& values);
/// The events that were still waiting at the end of a day, from its comments after the last event.
/// Their times are the source's own.
std::vector<HeardEvent> still_waiting(const std::vector<std::string>& notes);

} // namespace goingrate::apps
