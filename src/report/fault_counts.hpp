// How many events were not one beat each. Private to the report.
#pragma once

#include "goingrate/log/beats.hpp"

#include <string>

namespace goingrate {

/// "3 missed, 0 spurious", bounces where there are any, and of a log of both directions also the
/// downward passages that are missing. Of a log that is split they are those of its longest part,
/// which alone is analysed.
std::string fault_counts(const Beats& beats);

/// What the events of a log are: "values" of data on a grid, "readings" where they are further
/// apart than any swings are, else "beats".
std::string event_word(bool on_grid, double nominal_period_s);

} // namespace goingrate
