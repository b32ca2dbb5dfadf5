// Whether the rate answers to temperature or pressure, and whether compensating for it would help.
//
// rate(t) = a + drift t + b c(t) + noise, where c is the covariate, perhaps seen through a
// first-order lag (a case that warms up). b is found by generalised least squares in noise that is
// white, flicker and random walk of the rate, whose sizes are fitted too: two independent wanders
// that look alike by chance then give no significant coefficient. A coefficient that lowers the
// scatter may still increase the time error; so each half of the log is compensated with the
// coefficient found in the other half, and the time errors are compared. Limit: a covariate that
// only drifts through the log cannot be distinguished from a drift of the clock.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace goingrate {

/// The effect of one covariate on the rate.
struct CovariateEffect {
  std::string name, unit;   ///< unit of the coefficient: 1/K, 1/mbar, m^3/kg
  double coefficient = 0.0; ///< b, relative rate per unit
  double sigma = 0.0;
  double lag_s = 0.0;     ///< time constant of the lag; 0 if the log shows none
  double without_s = 0.0; ///< rms time error over the other half, its mean rate removed, s
  double with_s = 0.0;    ///< the same with the coefficient
  /// Whether the coefficient is beyond three sigma.
  [[nodiscard]] bool significant() const { return std::abs(coefficient) > 3.0 * sigma; }
  /// Whether compensating lowers the time error over the half that the coefficient was not fitted
  /// to.
  [[nodiscard]] bool helps() const { return significant() && with_s < without_s; }
};

/// The effects of the data's terms other than "drift". Terms that do not vary are left out; a log
/// of fewer than 256 beats gives none. CovariateTest.FindsACoefficientWithItsSigma,
/// CovariateTest.AWanderSharedByChanceIsNotTakenForAnAnswer. Cost: O(N).
std::vector<CovariateEffect> covariate_effects(const TimingData& data);

/// A sentence about one covariate.
std::string covariate_text(const CovariateEffect& effect);

} // namespace goingrate
