// Clocks that the paper mentions but does not compute. Private to the report room.
#pragma once

#include "goingrate/dynamics/custom_pendulum.hpp"

namespace goingrate::paper {

/// A cycle that repeats.
struct Cycle {
  double velocity = 0.0; ///< phi' at the upward crossing
  double rate = 0.0;     ///< excess
};
/// The cycle under any laws, by secant steps from `start`; rate to some 1e-11.
Cycle cycle_of(const CustomLaws& laws, double start);

/// C with one more torque of size mu, cos n psi or sin n psi, psi being the pendulum's own phase.
Cycle with_harmonic(int n, bool sine);

/// C with gravity over length (1 + change) times smaller, all else being as it was.
struct Lengthened {
  double rate = 0.0;      ///< excess
  double amplitude = 0.0; ///< lambda: lambda^2 is the mean of phi^2 + phi'^2 over a cycle
  double angle = 0.0;     ///< the largest
};
Lengthened lengthened(double change);

/// A single impulse of C's friction and of its energy a period times `energy`.
ClockParameters single_impulse(double energy, double angle);

/// A push both ways, `width` wide, its middle `centre` beyond the vertical, of constant torque and
/// of C's work at C's amplitude: its friction and gravity are C's too.
ClockParameters push(double centre, double width);
/// The rate that such a push makes: the limit cycle's, less that of a free swing as fast at the
/// vertical.
double escapement_error_of(const ClockParameters& clock);

/// The clock that has C's two moments at C's amplitude: a push this wide, or for 0 an impulse.
ClockParameters same_moments(double width);

} // namespace goingrate::paper
