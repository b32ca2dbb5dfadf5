// The steps of load() that its parts share. Private to the analysis room.
#pragma once

#include "goingrate/analysis/load.hpp"

namespace goingrate {

/// Numbers and corrects what was read.
NumberedLog loaded_from(ClockLog log, const LoadRequest& request);

/// Selects the good beats of the longest segment, without a copy where every event is good.
void choose_good(NumberedLog& loaded);

/// Reads and numbers a log from one file; if it has more events than `request.part_events`, part by
/// part.
NumberedLog load_in_parts(const LoadRequest& request, const LogVisitor& visit);

} // namespace goingrate
