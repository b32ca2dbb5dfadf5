// Values that stand for numbers that are not there.
#pragma once

#include <limits>

namespace goingrate {

/// Stands for a number that is not known.
inline constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
/// Above every number: no limit.
inline constexpr double infinite = std::numeric_limits<double>::infinity();

} // namespace goingrate
