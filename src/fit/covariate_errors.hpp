// The effect that errors of a covariate's readings have on a fit. Private to the fit room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// Adds the errors of the weather readings, RateTerm::sigma, to the uncertainty of the coordinates.
///
/// Independent errors of variance s^2, one every `step`, are a sum of cos(pi k t/T), each of
/// variance 2 s^2 step/T. Each cosine shifts the times by its integral, and one scoring step gives
/// the shift of the minimum. For values interpolated between readings, `step` is the time between
/// readings. At most 16 cosines are used: the strongest of the covariate, as long as they exceed
/// the errors. The weaker ones are not in the term: add_readings() (causes/reading_errors.hpp) has
/// removed them. WeatherTest.TheErrorsOfAThermometerAreInTheSigmas
void widen_by_readings(const Fitted& fitted, Certainty& known);

} // namespace goingrate::timing_model
