// Changes that may have been: whether a fit without them asks for them, and whether one with them
// can do without. Private to the fit room.
#pragma once

#include "fitted.hpp"

#include <optional>

namespace goingrate::timing_model {

/// Two lists of events as one, in order of cycle; of two at one cycle the first list's stays.
std::vector<FitEvent> joined(const std::vector<FitEvent>& events,
                             const std::vector<FitEvent>& more);

/// What a step of scoring promises L would gain if what the events of `wider` name changed with
/// them, besides what the fit has already; its noise stays as it is, which has had to stand in for
/// them: the promise is less than what is gained.
double promised_gain(const Fitted& fitted, const FitOptions& wider);

/// The options without one change, the dates of the others moved, if the log does not demand that
/// change: the fit without it has the better BIC, its date counted as a parameter. Changes whose
/// date is given, or that were planned, stay. Tried are those smaller than BIC asks for, and those
/// so near another of their kind that the swing has not answered to the first when the second
/// comes: two dates about one change, neither of them right, look so. In a log longer than 9000
/// beats, 3000 of them are looked at.
std::optional<FitOptions> without_needless_change(const Fitted& fitted, const FitOptions& options);

} // namespace goingrate::timing_model
