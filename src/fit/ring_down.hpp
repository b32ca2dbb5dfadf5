// From the fit of a free pendulum to how its swing dies away. Private to the fit room.
#pragma once

#include "fitted.hpp"

#include "goingrate/fit/decay.hpp"

#include <optional>

namespace goingrate::timing_model {

/// The decay, whichever law of friction the fit has; nothing for a driven clock, for a pendulum
/// whose friction changed, or where the model does not hold.
std::optional<Decay> decay_of(const Fitted& fitted, const FitOptions& options);

} // namespace goingrate::timing_model
