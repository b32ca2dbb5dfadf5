// Tests possible changes: whether a fit without them needs them, and whether a fit with them can do
// without. Private to the fit room.
#pragma once

#include "fitted.hpp"

#include <optional>

namespace goingrate::timing_model {

/// Merges two lists of events in order of cycle; of two events at one cycle the first list's is
/// kept.
std::vector<FitEvent> joined(const std::vector<FitEvent>& events,
                             const std::vector<FitEvent>& more);

/// The gain of L that a step of scoring promises if the parameters named by the events of `wider`
/// changed there, in addition to the changes of the fit. The noise, which has had to stand in for
/// these changes, is not refitted, so the real gain is larger.
double promised_gain(const Fitted& fitted, const FitOptions& wider);

/// The options without one change, and with the dates of the others moved, if the log does not
/// demand that change: the fit without it has the better BIC, with the date counted as a parameter.
/// Changes with a given date and planned changes stay. A change is tried if it is smaller than BIC
/// asks for, or if another of its kind comes before the swing has responded to the first: one
/// change with two dates about it, neither of them right, looks like that. In a log longer than
/// 9000 beats, 3000 of them are used.
std::optional<FitOptions> without_needless_change(const Fitted& fitted, const FitOptions& options);

} // namespace goingrate::timing_model
