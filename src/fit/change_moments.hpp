// When, within a swing, a change came. Private to the fit room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// Looks for the best moments of the changes that did not come at a crossing, from every place
/// where this search and another came to rest: the likelihood has several peaks within a swing. The
/// dynamics are those of first order.
void scan_moments(Fitted& fitted, const Fitted& other, const FitOptions& options);

/// Whether the times leap at changes that allow no leap, being at a crossing: a step of scoring
/// with leaps left free promises more than `beyond_chance` of 2 log L for each change.
bool leaps_at_changes(const Fitted& fitted, const FitOptions& options, double beyond_chance);

} // namespace goingrate::timing_model
