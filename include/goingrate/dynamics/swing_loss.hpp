// What friction takes from a free swing: the quality factor and the decay time at an amplitude.
#pragma once

#include <array>

namespace goingrate {

/// Friction of a pendulum, 2 epsilon phi' + quadratic |phi'| phi' + dry sign(phi'), in scaled time
/// (small swings take 2 pi); none of the three below 0.
struct Friction {
  double epsilon = 0.0;
  double quadratic = 0.0;
  double dry = 0.0;
};

/// 1/Q = (loss of each kind of friction) . (epsilon, quadratic, dry) at the turning angle A, rad,
/// above 0 and below pi.
///
/// A free swing has phi'^2 = 2 (cos phi - cos A) and the energy 1 - cos A = 2 k^2, k = sin(A/2). In
/// one period friction takes the integral of its force over the way,
///   dE = 32 epsilon (E(k) - (1 - k^2) K(k)) + 8 quadratic (sin A - A cos A) + 4 dry A,
/// with the complete elliptic integrals K and E (for instance Landau and Lifshitz, Mechanics, 11),
/// and Q = 2 pi (1 - cos A)/dE. For small swings 1/Q = 2 epsilon + (8/3 pi) quadratic A +
/// (4/pi) dry/A: linear friction alone has one Q at all amplitudes.
///
/// Accuracy: of first order in 1/Q, at every amplitude (SwingLossTest.IsWhatThePendulumLoses, which
/// integrates the equation of motion). Throws ArgumentError for an amplitude out of range.
std::array<double, 3> inverse_q_per_friction(double amplitude_rad);

/// Q at the turning angle A; infinite without friction.
double quality_factor(const Friction& friction, double amplitude_rad);

/// The time A/(-dA/dt), in which the amplitude would fall by a factor e if it went on at the rate
/// it has at A, over Q and over the period T0 of small swings:
///   tau = Q T0 A sin A K(k)/(2 pi^2 k^2),
/// which is Q T0/pi for small swings, and T0/(2 pi epsilon) if friction is linear.
double decay_periods_per_q(double amplitude_rad);

/// Period of a free swing over that of small ones, 2 K(sin(A/2))/pi = 1 + A^2/16 + ...
double circular_period_ratio(double amplitude_rad);

} // namespace goingrate
