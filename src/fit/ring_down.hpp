// Describes how the swing of a fitted free pendulum dies away. Private to the fit room.
#pragma once

#include "fitted.hpp"

#include "goingrate/fit/decay.hpp"

#include <optional>

namespace goingrate::timing_model {

/// The decay, whichever law of friction the fit has; nullopt for a driven clock, for a pendulum
/// whose friction changed, or if the model does not hold.
std::optional<Decay> decay_of(const Fitted& fitted, const FitOptions& options);

} // namespace goingrate::timing_model
