// Moves the dates of a fit. Private to the fit room.
#pragma once

#include "model_fit.hpp"

namespace goingrate::timing_model {

/// Moves the dates that may move, and the fit with them, while that pays.
void move_dates(Fitted& fitted, FitOptions& options);

} // namespace goingrate::timing_model
