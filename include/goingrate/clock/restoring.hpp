// The torque that returns the pendulum to the vertical: of gravity, a spring, or both.
//
// The torque is (1 - s) phi + s sin phi with s = gravity_share, so that T0 is the period of small
// swings for any s. The pull ends where it is 0 again, at the top: pi under gravity, below pi for s
// above 1, between pi and 1.43 pi for s from 1 down to 0.8215, and nowhere for less. A suspension
// spring of stiffness k adds k phi to gravity's m g l sin phi: s = m g l / (m g l + k). Cheeks that
// shorten the pendulum as it swings out reduce the cubic term of the sine and may make s 0 or
// negative. A torsion clock has s = 0.
#pragma once

#include "goingrate/clock/parameters.hpp"

#include <string_view>

namespace goingrate {

/// The angle at which the pull towards the vertical ends, rad; where it never does, 4 pi, two
/// turns, beyond which nothing here is tested (RestoringTest.TheTopIsWhereThePullEnds).
double top_angle(double gravity_share);

/// phi' at the vertical (scaled) of the free pendulum that turns at `angle`, 0 to the top:
/// sqrt((1 - s) angle^2 + 4 s sin^2(angle/2)).
double velocity_of_turning_angle(double gravity_share, double angle);

/// The turning angle of the free pendulum that passes the vertical with phi' = `velocity`, the
/// inverse of the above to rounding (RestoringTest.AngleAndVelocityAreInverse); 2 asin(v/2) under
/// gravity. NaN beyond top_velocity.
double turning_angle_of_velocity(double gravity_share, double velocity);

/// The velocity with which the pendulum just reaches top_angle: 2 under gravity, 4 pi for torsion.
double top_velocity(double gravity_share);

/// Throws ArgumentError naming `name` for a velocity that is not above 0 and below top_velocity.
void check_velocity(const ClockParameters& clock, double velocity, std::string_view name);

/// The period of the free pendulum that turns at `angle` (above 0, below the top) over that of
/// small swings, to 1e-13: the energy integral
///   T/T0 = (2/pi) int_0^(pi/2) du / sqrt(r),  r = 2 (V(angle) - V(x)) / (angle^2 - x^2),
/// x = angle sin u; 2 K/pi under gravity (RestoringTest.PeriodUnderGravityIsTheEllipticIntegral).
/// Throws ArgumentError for other angles.
double free_period_ratio(double gravity_share, double angle);

/// Scaled time that the free pendulum that turns at `angle` takes from -half to +half of its way (0
/// < half < angle, below the top), to 1e-13: 2 int_0^asin(half/angle) du / sqrt(r) with the r
/// above; 2 F(asin(sin(half/2)/k), k), k = sin(angle/2), under gravity
/// (RestoringTest.PassageUnderGravityIsTheEllipticIntegral). NaN beyond the top.
double free_passage_time(double gravity_share, double angle, double half);

} // namespace goingrate
