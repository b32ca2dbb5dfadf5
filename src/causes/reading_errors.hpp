// What of a covariate's readings is the covariate. Private to the library.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <span>
#include <string>
#include <vector>

namespace goingrate::timing_model {

/// The share of each cosine of a covariate that is no error of its readings, 0 to 1.
///
/// Readings err from beat to beat, so their errors have a flat spectrum, while weather has little
/// at high frequencies: the level of the upper half of the spectrum is taken for that of the
/// errors. Expected of a cosine c that is signal of power S and errors of power E is the share
/// S/(S + E) of it (Wiener); so weighted, errors neither weaken a coefficient nor tell anything of
/// an answer at frequencies at which the covariate does not vary (regression calibration: Carroll
/// et al. 2006, ch. 4). S + E is the mean over neighbouring frequencies; where it does not stand
/// out of E, S is 0.
/// CovariateTest.ErrorsOfAThermometerTellNothing
std::vector<double> signal_shares(std::span<const double> cosines);

/// Adds the term of a covariate that was read at each beat (NaN where unknown) without the errors
/// of its readings: each cosine times its share. As it was read where that explains the rate
/// better, as of a series that was made up, which the clock follows to the last digit; and where
/// there are fewer than 256. ReadingErrorsTest.SmoothWeatherIsFoundInNoisyReadings
void add_readings(std::string name, std::string unit, std::span<const double> readings,
                  TimingData& data);

} // namespace goingrate::timing_model
