// What errors of a covariate's readings do to a fit. Private to the fit room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// Adds to what is known of the coordinates how far they may be off by errors of the readings of
/// the weather, RateTerm::sigma.
///
/// Independent errors of variance s^2, one each `step`, are a sum of cos(pi k t/T), each of
/// variance 2 s^2 step/T; the times are off by its integral, and the minimum moves by one step of
/// scoring. Values interpolated between readings err likewise, their step being that of the
/// readings. Taken are the strongest cosines of the covariate, those that stand out of the errors:
/// what does not is not in a term whose readings were freed of their errors.
/// WeatherTest.TheErrorsOfAThermometerAreInTheSigmas
void widen_by_readings(const Fitted& fitted, Certainty& known);

} // namespace goingrate::timing_model
