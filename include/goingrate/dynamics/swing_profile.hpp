// A clock's escapement as the two half swings of a period meet it.
#pragma once

#include "goingrate/clock/parameters.hpp"
#include "goingrate/dynamics/half_swing.hpp"

namespace goingrate {

/// The half swings to the right and to the left (mirrored: phi and m change sign), both in the
/// canonical form of half_swing.
struct PeriodProfile {
  SwingProfile<double> right, left;
};

/// The profile of a clock with a single impulse or a tabulated torque (or none); an impulse at the
/// vertical itself comes right after the upward crossing that opens the period.
PeriodProfile period_profile(const ClockParameters& clock);

} // namespace goingrate
