// The result of one period, in the form that all methods return.
#pragma once

#include "goingrate/dynamics/swing_status.hpp"

namespace goingrate {

/// One period, from an upward crossing to the next, in scaled time.
struct PeriodStep {
  SwingStatus status = SwingStatus::crossed;
  double half_excess = 0.0; ///< from the start of the period to the downward crossing, minus pi
  double excess = 0.0;      ///< from the start to the next upward crossing, minus 2 pi
};

} // namespace goingrate
