// The time that the pendulum takes from the vertical to a small angle, as seen by a sensor off the
// vertical or by the edges of a flag.
#pragma once

#include "goingrate/clock/parameters.hpp"

namespace goingrate {

/// Scaled time at which a pendulum passes `angle` (rad), counted from its passage through the
/// vertical with speed `speed` = |phi'| > 0; negative for angles passed before. NaN for angles that
/// a free pendulum of that speed does not reach.
///
/// `rising`: phi grows. `factor` multiplies the drive, as in DirectPendulum::advance.
/// Integrates d(phi'^2/2)/dphi = m(phi) - friction(phi') - sin phi and dt/dphi = 1/phi' with the
/// escapement's laws near the vertical, to 1e-13 (PassageTest.AgreesWithTheEquationOfMotion).
/// Without forces it is the elliptic integral of the free pendulum
/// (PassageTest.FreeSwingIsTheEllipticIntegral). About 2 us.
double time_from_vertical(const ClockParameters& clock, double speed, bool rising, double factor,
                          double angle);

} // namespace goingrate
