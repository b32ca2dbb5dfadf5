// What a reader says that it assumed.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <algorithm>
#include <string_view>

namespace goingrate::test {

inline bool says(const ClockLog& log, std::string_view part) {
  return std::any_of(log.assumptions.begin(), log.assumptions.end(),
                     [&](const Assumption& a) { return a.text.find(part) != a.text.npos; });
}

} // namespace goingrate::test
