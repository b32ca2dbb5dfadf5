// The error budget of a clock under given conditions, and the limits that its parts must keep for a
// smaller error, as text and JSON.
#pragma once

#include "goingrate/drive/error_budget.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// The parts of the error, and for each quantity its value and its limit; if the error is too
/// large, also the values to which all its causes together would have to shrink.
std::string error_budget_text(const ErrorBudget& budget, const std::vector<Requirement>& needed,
                              double most_s);
/// {"after_s", "most_s", "error_s", "share_below", "parts": [{cause, key, size, rms_s}],
/// "requirements": [{key, present, limit}]}; a limit that does not exist is null.
std::string error_budget_json(const ErrorBudget& budget, const std::vector<Requirement>& needed,
                              double most_s);

} // namespace goingrate
