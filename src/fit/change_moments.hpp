// Finds the moment within a swing at which a change came. Private to the fit room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// Fits the moments of the changes that did not come at a crossing. The likelihood has several
/// peaks within a swing, so the moments are scanned from every point at which the searches for
/// `fitted` and `other` ended. Uses the first-order dynamics. Leaves `fitted` unchanged if no
/// usable fit is found.
void scan_moments(Fitted& fitted, const Fitted& other, const FitOptions& options);

/// Whether the times leap at changes that the fit puts at a crossing, where a change causes no
/// leap: true if a scoring step with the leaps free promises more than `beyond_chance` of 2 log L
/// for each change.
bool leaps_at_changes(const Fitted& fitted, const FitOptions& options, double beyond_chance);

} // namespace goingrate::timing_model
