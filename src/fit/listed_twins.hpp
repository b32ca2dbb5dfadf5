// Lists the clocks that explain a log, if there are several. Private to the fit room.
#pragma once

#include "fitted.hpp"

#include "goingrate/fit/clock_fit.hpp"

namespace goingrate::timing_model {

/// The rivals that are a different clock, more than 3.5 sigma away in a parameter other than T0,
/// each with the parameters that the log gives it, and a note that there are such.
void list_twins(const Fitted& fitted, FitSummary& summary);

} // namespace goingrate::timing_model
