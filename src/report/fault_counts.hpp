// Counts of missed beats and of events that are not beats. Private to the report.
#pragma once

#include "goingrate/log/beats.hpp"

#include <string>

namespace goingrate {

/// "3 missed, 0 spurious", bounces where there are any, and of a log of both directions also the
/// downward passages that are missing. Of a log that is split they are those of its longest part,
/// which alone is analysed.
std::string fault_counts(const Beats& beats);

} // namespace goingrate
