// Reports options given to a reader that do not apply to this kind of log.
#pragma once

#include "goingrate/log/reading.hpp"

namespace goingrate {

/// Lists in `log.assumptions` which of `told` were not used because they do not apply to this kind
/// of log, so that the user notices if the log was taken for another kind.
void tell_unused(ClockLog& log, const ReadingOptions& told);

} // namespace goingrate
