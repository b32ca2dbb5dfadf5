// Describes a log in several parts. Private to the report.
#pragma once

#include "wording.hpp"

#include <string>

namespace goingrate {

/// Why the log is in parts, which of them the report is about, and what to do with the others;
/// empty if the log is in one piece.
std::string which_part(const Analysis& data, const Wording& words);

/// Whether which_part() mentions the stop of the clock, so that it needs no sentence as a cause.
bool stop_is_told(const Analysis& data);

} // namespace goingrate
