// Moves the dates of a fit. Private to the fit room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// Moves the dates that may move, and the fit with them, as long as the likelihood gains by it. New
/// dates are looked for with the averaged clock, and taken if the dynamics of the fit prefer them.
void move_dates(Fitted& fitted, FitOptions& options);

} // namespace goingrate::timing_model
