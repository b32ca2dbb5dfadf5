// Possible changes: whether a fit without them calls for them, and whether a fit with them can do
// without. Private to the fit room.
#pragma once

#include "fitted.hpp"

#include <optional>

namespace goingrate::timing_model {

/// Two lists of events as one, in order of cycle; of two at one cycle the first list's stays.
std::vector<FitEvent> joined(const std::vector<FitEvent>& events,
                             const std::vector<FitEvent>& more);

/// What a step of scoring promises L would gain if the parameters that the events of `wider` name
/// changed there, besides what the fit has already. Its noise, which has had to stand in for these
/// changes, stays as it is: the real gain is larger.
double promised_gain(const Fitted& fitted, const FitOptions& wider);

/// The options without one change, the dates of the others moved, if the log does not demand that
/// change: the fit without it has the better BIC, its date counted as a parameter. Changes whose
/// date is given, or that were planned, stay. Those tried are smaller than BIC asks for, or so near
/// another of their kind that the swing has not answered to the first when the second comes: two
/// dates about one change, neither of them right, look like that. In a log longer than 9000 beats,
/// 3000 of them are looked at.
std::optional<FitOptions> without_needless_change(const Fitted& fitted, const FitOptions& options);

} // namespace goingrate::timing_model
