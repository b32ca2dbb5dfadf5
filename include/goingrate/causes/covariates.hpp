// Whether the rate answers to temperature or pressure, and whether compensating for it would help.
//
// rate(t) = a + drift t + b c(t) + noise, where c is the covariate, perhaps seen through a
// first-order lag (a case that warms up). b is found by generalised least squares in noise that is
// white, flicker and random walk of the rate, sized along with it, so that a wander shared by
// chance is not taken for an answer. A coefficient that lowers the scatter may still throw the
// hands off: so the log is cut in halves, each half judges the coefficient found in the other by
// the time error it leaves. Where this means little: a covariate that only drifts through the log
// cannot be told from the clock's own drift.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace goingrate {

/// What one covariate does to the rate.
struct CovariateEffect {
  std::string name, unit;   ///< unit of the coefficient: 1/K, 1/mbar, m^3/kg
  double coefficient = 0.0; ///< b, relative rate per unit
  double sigma = 0.0;
  double lag_s = 0.0;     ///< time constant of the lag; 0 if none is demanded
  double without_s = 0.0; ///< rms time error over the halves not seen, by their mean rate alone, s
  double with_s = 0.0;    ///< the same with the coefficient
  /// Whether the coefficient is beyond three sigma.
  [[nodiscard]] bool significant() const { return std::abs(coefficient) > 3.0 * sigma; }
  /// Whether compensating would have helped on data it did not see.
  [[nodiscard]] bool helps() const { return significant() && with_s < without_s; }
};

/// The effect of each of the data's terms but "drift"; terms that do not vary are left out, and all
/// of a log below 256 beats. CovariateTest.FindsACoefficientWithItsSigma,
/// CovariateTest.AWanderSharedByChanceIsNotTakenForAnAnswer. Cost: O(N).
std::vector<CovariateEffect> covariate_effects(const TimingData& data);

/// One line a covariate, in words.
std::string covariate_text(const CovariateEffect& effect);

} // namespace goingrate
