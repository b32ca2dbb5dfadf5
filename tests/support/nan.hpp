// A value that is not known.
#pragma once

#include <limits>

namespace goingrate::test {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

} // namespace goingrate::test
