// The averaged equations as a clock that advances period by period.
#pragma once

#include "goingrate/clock/parameters.hpp"
#include "goingrate/dynamics/intermittent.hpp"
#include "goingrate/dynamics/period_step.hpp"

#include <optional>

namespace goingrate {

/// The averaged equations to use.
enum class AveragedOrder {
  first,         ///< dotl3, dotpsi3, circular error -lambda^2/16 (Hoyng)
  first_in_full, ///< the same with the circular error to all orders, J1(lambda)/lambda - 1/2 (ce3)
  second,        ///< averaged2.hpp
};

/// Whether AveragedOrder::second covers the clock: constant torque, a single impulse or none, with
/// linear friction, under gravity alone.
bool knows_second_order(const ClockParameters& clock);

/// A pendulum that obeys the averaged equations.
///
/// First order works for every clock law, its moments from moments.hpp; with constant torque and
/// linear friction lambda^2 is advanced in closed form (eq. l2jump) and the phase by Simpson's rule
/// over the period, otherwise both by one Runge-Kutta step of a period (the equations vary slowly:
/// 1e-13 of the phase, AveragedPendulumTest.OnePeriodAgreesWithFineSteps). Second order is for
/// the clocks of knows_second_order. Other restoring torques scale the circular error, to first
/// order in what they differ from a harmonic one.
///
/// In first order the velocity is lambda, the cycle average of the amplitude; in second order it is
/// phi' at the upward crossing. The downward crossing is put in the middle of the period, where it
/// is to first order for symmetric escapements. The errors of the equations, compared with the full
/// pendulum, are listed in averaged.hpp and averaged2.hpp. Takes 20 to 50 ns per period.
class AveragedPendulum {
public:
  /// Starts at an upward crossing. Throws ArgumentError as check_velocity does, for clock
  /// parameters out of range, and laws that the second order does not know.
  AveragedPendulum(const ClockParameters& clock, double velocity, AveragedOrder order);

  /// From the present crossing on the clock has these parameters.
  void set_clock(const ClockParameters& clock);
  /// One period with the torque times `factor`. Status stalled once the amplitude does not reach
  /// the switching angle.
  PeriodStep advance(double factor = 1.0);

  /// Velocity at the last crossing, as the order defines it.
  [[nodiscard]] double velocity() const;
  /// Restates the velocity for a nominal period changed by the factor `ratio`.
  void rescale(double ratio) { amplitude2_ *= ratio * ratio; }

private:
  PeriodStep first_order(double factor);
  PeriodStep first_order_any_law(double factor);
  PeriodStep second_order(double factor);
  [[nodiscard]] double circular(double amplitude2) const;

  ClockParameters clock_;
  AveragedOrder order_;
  std::optional<ActionParts> parts_; // of an action that crossings cut in two, with
  double begun_ = 0.0;               // the factor of the one that goes on from the period before
  double amplitude2_;
  double kept_ = 0.0, kept_half_ = 0.0; // exp(-4 pi eps) - 1 and the same for half a period
};

} // namespace goingrate
