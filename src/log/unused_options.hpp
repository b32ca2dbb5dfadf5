// Options given to a reader that do not apply to this kind of log.
#pragma once

#include "goingrate/log/reading.hpp"

namespace goingrate {

/// Says in `log.assumptions` which of `told` were not used because they do not apply to this kind
/// of log: the user takes it for something else.
void tell_unused(ClockLog& log, const ReadingOptions& told);

} // namespace goingrate
