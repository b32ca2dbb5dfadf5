// Counts of missed beats and of events that are not beats. Private to the report.
#pragma once

#include "goingrate/log/beats.hpp"

#include <string>

namespace goingrate {

/// "3 missed, 0 spurious", with bounces if there are any, and for a log of both directions also
/// with the downward passages that are missing.
std::string fault_counts(const Beats& beats);

} // namespace goingrate
