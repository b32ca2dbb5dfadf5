// The averages over a swing that appear in the averaged equations.
//
//   lambda' = -(friction) + a,                 a = (1/2pi) int m cos psi dpsi   (Hoyng, dotl3, ca1)
//   psi' - 1 = (circular error) - b / lambda,  b = (1/2pi) int m sin psi dpsi   (dotpsi3, cb1)
// with phi = lambda sin psi. a is the work of the torque over a period divided by 2 pi lambda.
// Friction: -epsilon lambda, quadratic drag -(4/3pi) k lambda^2, dry friction -(2/pi) c; none of
// these shifts the phase to first order.
#pragma once

#include "goingrate/clock/parameters.hpp"

#include <functional>
#include <vector>

namespace goingrate {

/// The two moments of a torque, scaled as mu.
struct DriveMoments {
  double a = 0.0; ///< along phi': drives the amplitude
  double b = 0.0; ///< along phi: shifts the phase
};

/// The moments of a clock's escapement at amplitude lambda (rad, > 0), in closed form: eqs. ca2 and
/// cb1 (constant torque), blow3 (single impulse), exact integrals of a piecewise linear profile.
/// A constant torque whose switch is beyond lambda, or an impulse beyond it, gives a = 0 and b = 0:
/// a torque that is never switched does nothing on average.
/// They agree with quadrature to 1e-14 (MomentsTest.ClosedFormsAgreeWithQuadrature).
DriveMoments drive_moments(const ClockParameters& clock, double lambda);

/// -lambda' by friction: epsilon lambda + (4/3pi) k lambda^2 + (2/pi) c.
double friction_moment(const ClockParameters& clock, double lambda);

/// J1(lambda)/lambda - 1/2 (eq. ce3): the circular error of the rate in full, for any lambda; its
/// first term is -lambda^2/16. Without cancellation (MomentsTest.CircularErrorInFull).
double circular_error(double lambda);

/// A torque, or a friction force (positive when it opposes phi' > 0), of any shape.
using ForceLaw = std::function<double(double phi, double velocity)>;

/// Moments of any torque by quadrature. `jumps`: the angles at which it jumps; without them the
/// result is only as good as the quadrature of a discontinuous function. To 1e-12 for smooth
/// stretches (MomentsTest.ClosedFormsAgreeWithQuadrature).
DriveMoments drive_moments(const ForceLaw& torque, double lambda,
                           const std::vector<double>& jumps = {});

} // namespace goingrate
