// By how much a dated change moved the rate for good. Private to the library.
#pragma once

#include "goingrate/causes/diary.hpp"

#include <cmath>

namespace goingrate {

struct RateStep {
  double rate = 0.0, sigma = 0.0; ///< rate excess after minus before; NaN where it is not known
};

/// The jump itself, where its sigma is known; otherwise the difference of the mean rates before and
/// after, to which weather and wandering add their parts.
inline RateStep step_of(const Change& change) {
  if (change.rate_change_sigma > 0.0) // 0: not judged
    return {change.rate_change, change.rate_change_sigma};
  return {change.rate_after - change.rate_before,
          std::hypot(change.rate_before_sigma, change.rate_after_sigma)};
}

} // namespace goingrate
