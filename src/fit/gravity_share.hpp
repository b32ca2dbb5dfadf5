// Gravity's share of the restoring torque, as a fit has it. For the rooms above.
#pragma once

#include "goingrate/fit/clock_fit.hpp"

#include <cmath>

namespace goingrate {

/// The share that was fitted or given; 1, gravity alone, where neither was.
inline double gravity_share_of(const FitSummary& fit) {
  const FittedParameter* share = fit.find("gravity_share");
  return share != nullptr && std::isfinite(share->value) ? share->value : 1.0;
}

} // namespace goingrate
