// Clocks that the paper mentions but does not compute. Private to the report room.
#pragma once

#include "goingrate/dynamics/custom_pendulum.hpp"

namespace goingrate::paper {

/// A limit cycle.
struct Cycle {
  double velocity = 0.0; ///< phi' at the upward crossing
  double rate = 0.0;     ///< excess
};
/// The limit cycle under any laws, by secant steps from the velocity `start`; rate to some 1e-11.
Cycle cycle_of(const CustomLaws& laws, double start);

/// C with an additional torque mu cos n psi or mu sin n psi, where psi is the pendulum's own phase.
Cycle with_harmonic(int n, bool sine);

/// C with gravity over length (1 + change) times smaller, and everything else unchanged.
struct Lengthened {
  double rate = 0.0;      ///< excess
  double amplitude = 0.0; ///< lambda: lambda^2 is the mean of phi^2 + phi'^2 over a cycle
  double angle = 0.0;     ///< the largest angle
};
Lengthened lengthened(double change);

/// A single-impulse clock with C's friction, given `energy` times C's energy per period.
ClockParameters single_impulse(double energy, double angle);

/// A clock with C's friction and gravity, pushed in both directions by a constant torque over
/// `width`, with its middle `centre` past the vertical. At C's amplitude the push does C's work.
ClockParameters push(double centre, double width);
/// The rate due to the push: the rate of the limit cycle minus that of a free swing with the same
/// speed at the vertical.
double escapement_error_of(const ClockParameters& clock);

/// The clock whose drive has C's two moments at C's amplitude: a push `width` wide, or an impulse
/// if `width` is 0.
ClockParameters same_moments(double width);

} // namespace goingrate::paper
