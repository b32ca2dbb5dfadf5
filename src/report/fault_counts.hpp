// Counts of missed beats and of events that are not beats. Private to the report.
#pragma once

#include "goingrate/log/beats.hpp"
#include "goingrate/log/clock_log.hpp"

#include <string>

namespace goingrate {

/// "3 missed, 0 spurious", bounces and displaced beats where there are any, and of a log of both
/// directions also the downward passages that are missing. A displaced beat comes too early or too
/// late to be used, and alone in its period; it counts neither as missed nor as spurious. Of a log
/// that is split they are those of its longest part, which alone is analysed.
std::string fault_counts(const Beats& beats);

/// What the events of a log are: "values" where they have no period, "readings" where they are
/// further apart than any swings are, else "beats".
std::string event_word(bool no_period, double nominal_period_s);

/// Whether a log holds values at equal intervals of a clock whose period is not known.
bool has_no_period(const ClockLog& log);

} // namespace goingrate
