// Point C of the paper, with T0 = 2 pi s: the clock, and its limit cycle in 128-bit arithmetic.
#pragma once

#include "base/scaled_time.hpp"
#include "goingrate/clock/parameters.hpp"

namespace goingrate::test {

inline const ClockParameters clock_c{two_pi, 1.167245e-4, 1.5e-5, 0.03};
inline constexpr double velocity_c = 0.0495414393471760923604; ///< at the lowest point
inline constexpr long double excess_c = ///< of its period over 2 pi
    6.28318519131337413067658L - 6.28318530717958647692529L;

} // namespace goingrate::test
