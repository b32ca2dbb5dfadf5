// Changes that may have been: whether a fit without them asks for them. Private to the fit room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// Two lists of events as one, in order of cycle; of two at one cycle the first list's stays.
std::vector<FitEvent> joined(const std::vector<FitEvent>& events,
                             const std::vector<FitEvent>& more);

/// What a step of scoring promises L would gain if what the events of `wider` name changed with
/// them, beside what the fit has already; its noise stays as it is, which has had to stand in for
/// them: the promise is less than what is gained.
double promised_gain(const Fitted& fitted, const FitOptions& wider);

} // namespace goingrate::timing_model
