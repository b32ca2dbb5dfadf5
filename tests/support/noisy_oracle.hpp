// Crossing times under a noisy drive, compared with 64-bit integration.
#pragma once

#include "goingrate/base/random.hpp"
#include "goingrate/dynamics/direct.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate::test {

/// How far a sum of excesses is from the exact one.
inline double error_of(const TwoPart<double>& time, long double exact) {
  return static_cast<double>(std::abs(static_cast<long double>(time.hi) - exact + time.lo));
}

/// The largest error of a crossing time of `pendulum` over `periods` with 30 % white noise in the
/// drive; infinite if the clock misses a switch.
template <class Pendulum>
double worst_noisy_error(Pendulum pendulum, const ClockParameters& clock, int periods) {
  RandomStream random(3, StreamPurpose::fast_drive);
  long double speed2 = static_cast<long double>(pendulum.speed2().hi) + pendulum.speed2().lo;
  long double exact = 0.0L;
  TwoPart<double> excess;
  double worst = 0.0;
  for (int cycle = 0; cycle < periods; ++cycle) {
    const double factor = 1.0 + 0.3 * random.normal();
    excess += pendulum.advance(factor).excess;
    const auto period = regular_period<Wide>(clock, speed2, factor);
    if (!period.regular) return INFINITY;
    speed2 += period.speed2_change;
    exact += period.excess;
    worst = std::max(worst, error_of(excess, exact));
  }
  return worst;
}

} // namespace goingrate::test
