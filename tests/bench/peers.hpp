// Widely used integrators, as methods of the speed-accuracy chart.
//
// Each is used as its manual shows and as fast as possible: phi and phi' as plain doubles, adaptive
// steps at a relative tolerance (the absolute one is the relative one times the initial phi' of a
// scene, scaled with the motion as the manuals ask), a stop at each switching angle and at each
// upward crossing, and time within the period as a sum that starts at 0 every period. Bench only.
#pragma once

#include "base/scaled_time.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/clock/parameters.hpp"
#include "goingrate/dynamics/chart.hpp"
#include "goingrate/dynamics/period_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace goingrate::bench {

/// Boost.odeint: Fehlberg 7(8) at 1e-12 and 1e-15, Bulirsch-Stoer at 1e-14; Newton to the stops.
std::vector<ChartMethod> odeint_peers();

/// GSL: Prince-Dormand 8(9) (rk8pd) at 1e-12 and 1e-14; Newton to the stops.
std::vector<ChartMethod> gsl_peers();

/// SUNDIALS: CVODE's Adams method at 1e-12 and 1e-14, with its own root finder, which does not see
/// a torque that switches and a pendulum that turns back within one of its steps of some 0.05.
std::vector<ChartMethod> sundials_peers();

/// phi and phi'.
using Motion = std::array<double, 2>;

/// The equation of motion while the torque stays as it is.
struct SwingLaw {
  double epsilon = 0.0;
  double torque = 0.0;

  [[nodiscard]] double acceleration(double angle, double speed) const {
    return torque - 2.0 * epsilon * speed - std::sin(angle);
  }
  /// As odeint asks for it.
  void operator()(const Motion& x, Motion& dxdt, double /*t*/) const {
    dxdt[0] = x[1];
    dxdt[1] = acceleration(x[0], x[1]);
  }
};

/// Throws ArgumentError unless the clock is one with linear friction and constant torque or none.
inline void check_peer_clock(const ClockParameters& clock) {
  check(clock);
  if (!clock.is_plain())
    throw ArgumentError("clock", "another law", "constant torque or none, with linear friction");
}

/// The start of a scene, an upward crossing; throws ArgumentError unless 0 < velocity < 2.
inline Motion start_of(double velocity) {
  if (!(velocity > 0.0 && velocity < 2.0))
    throw ArgumentError("velocity", velocity, "greater than 0 and less than 2");
  return {0.0, velocity};
}

/// What a library is asked for: errors per step below `absolute` + `relative` times the variable.
struct Tolerance {
  double absolute, relative;
};

/// No period lasts longer than this (32 nominal periods) unless the clock has stalled.
inline constexpr double longest_period = 200.0;

/// A quarter swing: no step up to that can miss the vertical by passing it twice.
inline constexpr double longest_step = 0.5 * std::numbers::pi;

/// What a period of length `time` did that ended with phi' = `speed`. A motion below the absolute
/// tolerance is noise, whose crossings mean nothing: it counts as stalled.
inline PeriodStep period_end(double time, double speed, double absolute_tolerance) {
  if (!(speed > absolute_tolerance)) return {SwingStatus::stalled};
  return {SwingStatus::crossed, 0.0, (time - two_pi) - two_pi_low};
}

/// A clock on any one-step method. `Stepper(Tolerance)` has
///   double step(law, from, slope, to): an adaptive step of its own choice up to longest_step;
///     returns its length, or 0 when it cannot go on;
///   void step_by(h, law, from, slope, to): a step of length h, a length it chose or less,
/// where slope is the derivative of `from`.
template <class Stepper> class SteppedPendulum {
public:
  SteppedPendulum(const ClockParameters& clock, double velocity, double tolerance)
      : absolute_tolerance_(tolerance * velocity), stepper_({absolute_tolerance_, tolerance}),
        now_(start_of(velocity)) {
    set_clock(clock);
  }

  void set_clock(const ClockParameters& clock) {
    check_peer_clock(clock);
    clock_ = clock;
    switches_ = clock.acting_torque() > 0.0;
    if (!switches_) direction_ = 1.0;
  }

  PeriodStep advance(double factor);

private:
  bool cut_at_turn(double sign, double angle, double& h, Motion& next);
  bool stop_at_switch(double& h, Motion& next);
  double stop_at(double angle, double h, Motion& at);
  double turning_point(double h, Motion& at);
  [[nodiscard]] double acceleration(const Motion& x) const { return law_.acceleration(x[0], x[1]); }

  double absolute_tolerance_;
  Stepper stepper_;
  ClockParameters clock_;
  bool switches_ = false;  // a free pendulum has no reason to stop at phi0
  double direction_ = 1.0; // of the torque
  SwingLaw law_;
  Motion now_;
  Motion slope_{}; // at now_
};

// The switch comes before a downward crossing in the same step and after an upward one, so the end
// of the period is looked for first.
template <class Stepper> PeriodStep SteppedPendulum<Stepper>::advance(double factor) {
  const double mu = factor * clock_.acting_torque();
  law_ = {clock_.epsilon, direction_ * mu};
  double time = 0.0;
  double side = 1.0; // of the vertical: +1 right, -1 left
  bool returning = false;
  while (time < longest_period) {
    law_(now_, slope_, time);
    Motion next;
    double h = stepper_.step(law_, now_, slope_, next);
    if (!(h > 0.0 && std::isfinite(next[0] + next[1]))) return {SwingStatus::not_finite};
    cut_at_turn(-side, 0.0, h, next);
    if (side < 0.0 && next[0] >= 0.0) {
      time += stop_at(0.0, h, next);
      now_ = next;
      return period_end(time, next[1], absolute_tolerance_);
    }
    if (switches_ && stop_at_switch(h, next)) {
      direction_ = -direction_;
      law_.torque = direction_ * mu;
    }
    if (std::abs(next[0]) >= std::numbers::pi) return {SwingStatus::overturned};
    if (side > 0.0 && next[0] <= 0.0) {
      side = -1.0;
      returning = false;
    } else {
      const bool outwards = side * next[1] >= 0.0;
      if (returning && outwards) return {SwingStatus::stalled};
      returning = !outwards;
    }
    now_ = next;
    time += h;
  }
  return {SwingStatus::stalled};
}

// Whether sign * phi passes `angle` in the step, turns and comes back; if so the step is cut where
// it turns. Near stall that happens, and costs nothing elsewhere.
template <class Stepper>
bool SteppedPendulum<Stepper>::cut_at_turn(double sign, double angle, double& h, Motion& next) {
  const bool turned = sign * now_[1] > 0.0 && sign * next[1] < 0.0;
  if (!turned || sign * next[0] >= angle) return false;
  Motion top = next;
  const double to_top = turning_point(h, top);
  if (sign * top[0] < angle) return false;
  next = top;
  h = to_top;
  return true;
}

// Whether the torque switches in the step; if so it is cut there.
template <class Stepper> bool SteppedPendulum<Stepper>::stop_at_switch(double& h, Motion& next) {
  const bool passes = direction_ * next[0] >= clock_.phi0;
  if (!passes && !cut_at_turn(direction_, clock_.phi0, h, next)) return false;
  h = stop_at(direction_ * clock_.phi0, h, next);
  return true;
}

// Steps from now_ to where phi passes `angle`, outwards or through 0; `at` is where a step of
// length h > that leads. Returns the length. The parabola with phi'' in hand saves one step of
// Newton's three, and finds the first of two passages. The library's step is not repeated for a
// correction whose square is below the rounding.
template <class Stepper>
double SteppedPendulum<Stepper>::stop_at(double angle, double h, Motion& at) {
  const double longest = h;
  const double sign = now_[0] < angle ? 1.0 : -1.0;
  for (int i = 0; i < 30; ++i) {
    const double beyond = sign * (at[0] - angle);
    const double speed = sign * at[1];
    const double a = acceleration(at);
    const double root = std::sqrt(std::max(0.0, speed * speed - 2.0 * sign * a * beyond));
    const double change =
        speed > 0.0 ? -2.0 * beyond / (speed + root) : (root - speed) / (sign * a);
    if (std::abs(change) < 1e-8) {
      h += change;
      at = {angle, at[1] + a * change};
      break;
    }
    h = std::clamp(h + change, 0.0, longest);
    stepper_.step_by(h, law_, now_, slope_, at);
  }
  return h;
}

// The same for the turning point, to within what tells a switch from none.
template <class Stepper> double SteppedPendulum<Stepper>::turning_point(double h, Motion& at) {
  const double longest = h;
  for (int i = 0; i < 30; ++i) {
    const double change = -at[1] / acceleration(at);
    if (std::abs(change) < 1e-10) break;
    h = std::clamp(h + change, 0.0, longest);
    stepper_.step_by(h, law_, now_, slope_, at);
  }
  return h;
}

} // namespace goingrate::bench
