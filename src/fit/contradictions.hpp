// Finds what a log contradicts in its fit: the model itself, or a prior. Private to the fit room.
#pragma once

#include "fitted.hpp"
#include "inference.hpp"

#include <vector>

namespace goingrate::timing_model {

/// Notes on the evidence that the log does not come from the clock that fits it best; empty if
/// there is none. `ends`: the interval of each coordinate.
std::vector<FitNote> model_contradictions(const Fitted& fitted, const FitQuality& quality,
                                          const std::vector<Interval>& ends);

/// Whether the model does not explain the log, and the beats of some stretch scatter far more than
/// elsewhere: no noise that is alike throughout the log explains that.
bool scatters_unevenly(const Fitted& fitted);

/// Notes the priors from which the log has pulled its parameters far away.
void note_contradicted_priors(const Fitted& fitted, FitSummary& summary);

} // namespace goingrate::timing_model
