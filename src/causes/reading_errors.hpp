// What of a covariate's readings is the covariate. Private to the causes room.
#pragma once

#include <span>
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

} // namespace goingrate::timing_model
