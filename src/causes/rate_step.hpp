// The lasting effect of a dated change on the rate. Private to the library.
#pragma once

#include "goingrate/causes/diary.hpp"

#include <cmath>
#include <optional>

namespace goingrate {

struct RateStep {
  double rate = 0.0, sigma = 0.0; ///< rate excess after minus before; NaN where it is not known
};

/// The jump at the change, if its sigma is known. Weather and wander do not affect it.
inline std::optional<RateStep> known_jump(const Change& change) {
  if (!(change.rate_change_sigma > 0.0)) return {}; // 0: not judged
  return RateStep{change.rate_change, change.rate_change_sigma};
}

/// The known jump, or else the difference of the mean rates before and after, which may include
/// weather and wander.
inline RateStep step_of(const Change& change) {
  return known_jump(change).value_or(
      RateStep{change.rate_after - change.rate_before,
               std::hypot(change.rate_before_sigma, change.rate_after_sigma)});
}

} // namespace goingrate
