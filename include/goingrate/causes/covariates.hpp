// Whether the rate answers to temperature or pressure, and whether compensating for it would help.
//
// rate(t) = a + drift t + b c(t) + noise, where c is the covariate, perhaps seen through a
// first-order lag (a case that warms up). b is found by generalised least squares in noise that is
// white, flicker and random walk of the rate, whose sizes are fitted too: two independent wanders
// that look alike by chance then give no significant coefficient. A coefficient that lowers the
// scatter may still increase the time error; so each half of the log is compensated with the
// coefficient found in the other half, and the time errors are compared. Limit: a covariate that
// only drifts through the log cannot be distinguished from a drift of the clock.
//
// Interpolation errors add noise, which the fit includes. So far as they are errors of the readings
// they also make the coefficient too small, by the share that they have in the variance of the
// covariate: that much is added to sigma. Gaps are bridged by lines; sigma is raised accordingly.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace goingrate {

/// The effect of one covariate on the rate.
struct CovariateEffect {
  std::string name, unit;   ///< unit of the coefficient: 1/K, 1/mbar, m^3/kg
  double coefficient = 0.0; ///< b, relative rate per unit of the covariate, in `unit`
  double sigma = 0.0;       ///< of it, in `unit`, with what interpolating the covariate may add
  double lag_s = 0.0;       ///< time constant of the lag, s; 0 if the log shows none
  double without_s = 0.0;   ///< rms time error over the other half, its mean rate removed, s
  double with_s = 0.0;      ///< the same with the coefficient, s
  /// Of a value between two readings, in the unit of the covariate (K, mbar, kg/m^3); 0 if there is
  /// a reading at each beat.
  double interpolation_sigma = 0.0;
  double step_s = 0.0;      ///< between two readings, s; 0 if there is one at each beat
  double known_share = 1.0; ///< of the log, 0 to 1; the rest is left out
  /// Whether the coefficient is beyond three sigma.
  [[nodiscard]] bool significant() const { return std::abs(coefficient) > 3.0 * sigma; }
  /// Whether compensating lowers the time error over the half that the coefficient was not fitted
  /// to.
  [[nodiscard]] bool helps() const { return significant() && with_s < without_s; }
};

/// The effects of the data's terms other than "drift". Terms that do not vary, or only along a
/// straight line, are left out; a log
/// of fewer than 256 beats gives none. CovariateTest.FindsACoefficientWithItsSigma,
/// CovariateTest.AWanderSharedByChanceIsNotTakenForAnAnswer. Cost: O(N).
std::vector<CovariateEffect> covariate_effects(const TimingData& data);

/// What one quantity does to the rate beside the others.
struct WeatherPart {
  std::string name, unit;
  double coefficient = 0.0, sigma = 0.0; ///< relative rate per unit
};

/// The coefficients of temperature, pressure and humidity, as many as the data have, found together
/// (without lags), so that none stands for another. Nothing for data that have none, or with fewer
/// than 256 beats. (CovariateTest.PartsAreFoundTogether)
std::vector<WeatherPart> weather_parts(const TimingData& data);

/// A sentence about one covariate.
std::string covariate_text(const CovariateEffect& effect);

} // namespace goingrate
