// The paper's own integrator, kept as a baseline: classical Runge-Kutta on an equidistant grid.
//
// Equation (Hoyng, eq. ddt1), scaled time: phi'' + 2 eps phi' + sin phi = m, with the model
// escapement: m = +mu until phi rises through phi0, then -mu until phi falls through -phi0. The
// crossings phi = 0 are found by linear interpolation between grid points (Appendix D).
//
// The appendix leaves open when a step learns that the torque has switched. Rate error (rate excess
// minus the exact 1.844e-8) at the paper's point C, eps 1.167245e-4, mu 1.5e-5, phi0 0.03:
//
//   torque chosen      dt = 0.03     dt = 0.01     the rate converges
//   once a step        -5.44e-6      -1.81e-6      as dt: the switch comes dt/2 late on average
//   in every stage     -7.09e-9      +9.75e-10     not as a power of dt, see below
//   at the switches    -6.45e-9      -8.22e-11     as dt^4; -dt^4/120 is that of a free RK4 swing
//
// (Rk4RateTest.RateErrorAtPointC, Rk4OrderTest.OncePerStepIsOfFirstOrder,
// Rk4OrderTest.FourthOrderIsKeptByCuttingAtTheSwitches.)
//
// Chosen in every stage, the torque of the step that holds the switch is weighted 1/6 : 5/6 or
// 5/6 : 1/6 wherever in the step the switch lies. Each switch is so displaced by up to dt/3, a
// first-order error (Rk4OrderTest.ASingleSwitchPerStageIsOfFirstOrder) whose mean over all places
// is zero. The mean rate gains from that only as far as the places are spread evenly, and they are
// not: the clock locks to the grid. At C it is 9.754e-10 off at dt = 0.02, 0.01 and 0.005 alike,
// because 135 periods stay exactly 848.23 long, a whole or half number of steps
// (Rk4OrderTest.PerStageTheClockLocksToTheGrid). Over 24 step sizes within 10 % of each other the
// stages add an rms rate error of 1.2e-8 at 0.08, 2.4e-9 at 0.027, 1.6e-9 at 0.009 and 1.5e-9 at
// 0.003: no order is to be seen, though it is bounded by the displacement of a switch.
//
// Cost: 4 sines a step, about 35 ns; a period at dt = 0.03 is 7 us, whichever variant.
#pragma once

#include "goingrate/clock/scenario.hpp"
#include "goingrate/dynamics/period_step.hpp"
#include "goingrate/dynamics/swing_status.hpp"

namespace goingrate {

/// The way in which a step of Rk4Pendulum decides the sign of the torque: once, from quadrant and
/// angle at the start of the step; in each of the four stages, from quadrant and angle there; or
/// the sign is remembered, and a step that passes the switching angle is cut there.
using TorqueTiming = Rk4Torque;

/// The pendulum on the paper's grid, period by period, in scaled time.
///
/// The grid runs on through the crossings; with at_switches it goes on with full steps from each
/// cut. A crossing time is off by up to 0.016 dt^3 + dt^2/8 (mu/phi' + 2 eps) by its interpolation,
/// 5e-7 at C and dt = 0.03 (Rk4FreeTest.InterpolationErrorOfACrossing); that is not part of the
/// state and does not accumulate, so rates are best taken over many periods. The free pendulum
/// loses a share 2 pi dt^5 / 144 of phi' a period (Rk4FreeTest.VelocityIsLostAtFifthOrder).
class Rk4Pendulum {
public:
  /// Starts at an upward crossing with phi' = `velocity` (scaled, 0 < velocity < 2), on a grid
  /// point, the torque helping. 1e-6 <= dt <= 1: RK4 is unstable from dt = 2.8, and steps below
  /// 1e-6 only add rounding. Throws ArgumentError naming velocity or dt.
  Rk4Pendulum(double velocity, double dt, TorqueTiming timing);

  /// The result of one period. The times are 0 unless the status is crossed.
  struct Step {
    SwingStatus status = SwingStatus::crossed;
    double down = 0.0; ///< from the last upward crossing to the downward one
    double full = 0.0; ///< from the last upward crossing to the next
  };

  /// Advances one period under torque `mu`, switching angle `phi0` (rad) and friction `epsilon`.
  ///
  /// They act from the first step after the crossing, so up to dt late: a drive that is renewed at
  /// every crossing is first order in all three variants. stalled: the pendulum turned before it
  /// reached the vertical, or took longer than 200 (32 nominal periods) to come back; overturned:
  /// |phi| reached pi; not_finite: so are the numbers given. Anything but crossed is final.
  ///
  /// Without memory of the last switch (per_step, per_stage) an amplitude below phi0 does not
  /// stall: the torque then switches at the turning point, always helps, and the clock starts
  /// itself (Rk4StatusTest.WithoutMemoryTheClockStartsItself). A clock that rises above phi0 and
  /// falls back within one step misses the switch.
  Step advance(double epsilon, double mu, double phi0);

  /// phi' at the last upward crossing, interpolated linearly like its time: within dt^2/8 of
  /// itself.
  [[nodiscard]] double velocity() const { return velocity_; }
  /// Restates the velocity for a nominal period changed by the factor `ratio`.
  void rescale(double ratio) {
    now_.speed *= ratio;
    velocity_ *= ratio;
  }

private:
  struct State {
    double angle = 0.0;
    double speed = 0.0;
  };
  struct Forces {
    double epsilon, mu, phi0;
  };

  template <class Torque>
  static State runge_kutta(const State& from, double h, double epsilon, Torque torque);
  [[nodiscard]] State step_to_switch(const State& beyond, const Forces& forces, double& h) const;
  double step_on(const Forces& forces);

  State now_; // on the grid, up to a step after the crossing
  double dt_;
  TorqueTiming timing_;
  double direction_ = 1.0; // of the torque: +1 or -1
  double lead_ = 0.0;      // time from the last upward crossing to now_
  double velocity_;
  SwingStatus status_ = SwingStatus::crossed;
};

/// The same as a clock that ClockRun can advance; constant torque or none, linear friction.
class Rk4Clock {
public:
  /// Throws ArgumentError for other laws too.
  Rk4Clock(const ClockParameters& clock, double velocity, double dt, TorqueTiming timing);

  /// From the present crossing on the clock has these parameters.
  void set_clock(const ClockParameters& clock);
  /// One period with the torque times `factor`.
  PeriodStep advance(double factor = 1.0);
  /// phi' at the last crossing.
  [[nodiscard]] double velocity() const { return pendulum_.velocity(); }
  /// The grid is in scaled time: a change of the nominal period rescales the state's speed.
  void rescale(double ratio) { pendulum_.rescale(ratio); }

private:
  Rk4Pendulum pendulum_;
  ClockParameters clock_;
};

} // namespace goingrate
