// Options given to a reader that do not apply to this kind of log.
#pragma once

#include "goingrate/log/reading.hpp"

namespace goingrate {

/// Says in `log.assumptions` which of `told` was not used, since this kind of log has nothing to
/// use it for: somebody takes the log for what it is not.
void tell_unused(ClockLog& log, const ReadingOptions& told);

} // namespace goingrate
