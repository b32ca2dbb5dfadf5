// What follows from the parameters of a fit: its rate, Q, decay time, gains. Private to the fit
// room.
#pragma once

#include "inference.hpp"

namespace goingrate::timing_model {

/// Puts rate, derived quantities and combinations at the place x into `summary`, whose parameters
/// are stated already. T0 becomes undetermined where the escapement error is.
void state_derived(const FitProblem& problem, std::span<const double> x, const Certainty& known,
                   const Rivals& rivals, double nominal_period_s, FitSummary& summary);

} // namespace goingrate::timing_model
