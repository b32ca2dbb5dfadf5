// Quantities that follow from the parameters of a fit: rate, Q, decay time, gains. Private to the
// fit room.
#pragma once

#include "inference.hpp"

namespace goingrate::timing_model {

/// Puts rate, derived quantities and combinations at the point x into `summary`, whose parameters
/// have been stated before. T0 becomes undetermined if the escapement error is.
void state_derived(const FitProblem& problem, std::span<const double> x, const Certainty& known,
                   const Rivals& rivals, double nominal_period_s, FitSummary& summary);

} // namespace goingrate::timing_model
