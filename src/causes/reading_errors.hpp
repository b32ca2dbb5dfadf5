// Separates a covariate from the errors of its readings. Private to the library.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <span>
#include <string>
#include <vector>

namespace goingrate::timing_model {

/// The share of each cosine coefficient of a covariate that is signal and not an error of its
/// readings, 0 to 1.
///
/// The errors are independent from beat to beat and have a flat spectrum, while weather has little
/// power at high frequencies: the level of the upper half of the spectrum is taken as that of the
/// errors. If a coefficient has signal of power S and errors of power E, the expected signal in it
/// is S/(S + E) of the coefficient (Wiener). With these weights, errors do not weaken a regression
/// coefficient, and frequencies at which the covariate does not vary do not count (regression
/// calibration: Carroll et al. 2006, ch. 4). S + E is the mean over neighbouring frequencies; where
/// it is not significantly above E, S is 0. CovariateTest.ErrorsOfAThermometerTellNothing
std::vector<double> signal_shares(std::span<const double> cosines);

/// Adds the term of a covariate that was read at each beat (NaN where unknown), with the errors of
/// the readings reduced: each cosine coefficient times its share. The readings are used unchanged
/// if they explain the rate better, as with simulated weather that the clock follows to the last
/// digit, and if there are fewer than 256.
/// ReadingErrorsTest.SmoothWeatherIsFoundInNoisyReadings
void add_readings(std::string name, std::string unit, std::span<const double> readings,
                  TimingData& data);

} // namespace goingrate::timing_model
