#include "goingrate/dynamics/rk4.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/errors.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace goingrate {

namespace {

constexpr double shortest_step = 1e-6;
constexpr double longest_step = 1.0;
constexpr double longest_period = 200.0; // 32 nominal periods; 80 suffice a whisker below the top

// +1 or -1 as the torque acts to the right or to the left, in the quadrant of (phi, phi') and by
// phi against +-phi0, as a code without memory decides it (Hoyng, Appendix D).
double quadrant_direction(double angle, double speed, double phi0) {
  const bool to_the_right = speed >= 0.0 ? angle < phi0 : angle <= -phi0;
  return to_the_right ? 1.0 : -1.0;
}

} // namespace

Rk4Pendulum::Rk4Pendulum(double velocity, double dt, TorqueTiming timing)
    : now_{0.0, velocity}, dt_(dt), timing_(timing), velocity_(velocity) {
  if (!(velocity > 0.0 && velocity < 2.0))
    throw ArgumentError("velocity", velocity, "greater than 0 and less than 2");
  if (!(dt >= shortest_step && dt <= longest_step)) throw ArgumentError("dt", dt, "1e-6 to 1");
}

// One classical step; `torque` is a function of angle and speed, called in each of the four stages.
template <class Torque>
Rk4Pendulum::State Rk4Pendulum::runge_kutta(const State& from, double h, double epsilon,
                                            Torque torque) {
  const auto acceleration = [&](double angle, double speed) {
    return torque(angle, speed) - 2.0 * epsilon * speed - std::sin(angle);
  };
  const double half = 0.5 * h;
  const double a1 = acceleration(from.angle, from.speed);
  const double w2 = from.speed + half * a1;
  const double a2 = acceleration(from.angle + half * from.speed, w2);
  const double w3 = from.speed + half * a2;
  const double a3 = acceleration(from.angle + half * w2, w3);
  const double w4 = from.speed + h * a3;
  const double a4 = acceleration(from.angle + h * w3, w4);
  return {from.angle + h / 6.0 * (from.speed + 2.0 * (w2 + w3) + w4),
          from.speed + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)};
}

// The state at the switch inside a step that ends `beyond` it. Newton on the length of the step,
// kept inside a bracket; phi' stands for the slope, from which it differs by O(h^4).
Rk4Pendulum::State Rk4Pendulum::step_to_switch(const State& beyond, const Forces& forces,
                                               double& h) const {
  const double torque = direction_ * forces.mu;
  const double target = direction_ * forces.phi0;
  double low = 0.0;
  double high = dt_;
  h = dt_ * (target - now_.angle) / (beyond.angle - now_.angle);
  State at;
  for (int i = 0; i < 60; ++i) { // bisection alone would need 53
    at = runge_kutta(now_, h, forces.epsilon, [&](double, double) { return torque; });
    const double excess = direction_ * (at.angle - target);
    (excess > 0.0 ? high : low) = h;
    const double step = direction_ * excess / at.speed;
    if (std::abs(step) <= 1e-15 * dt_) break; // below the rounding of the angle
    const double next = h - step;
    h = next > low && next < high ? next : 0.5 * (low + high);
  }
  at.angle = target;
  return at;
}

// Moves now_ by one step and returns its length: dt, or less where a switch cuts it.
double Rk4Pendulum::step_on(const Forces& f) {
  if (timing_ == TorqueTiming::per_stage) {
    now_ = runge_kutta(now_, dt_, f.epsilon, [&](double angle, double speed) {
      return f.mu * quadrant_direction(angle, speed, f.phi0);
    });
    return dt_;
  }
  if (timing_ == TorqueTiming::per_step)
    direction_ = quadrant_direction(now_.angle, now_.speed, f.phi0);
  else if (direction_ * now_.angle >= f.phi0) // phi0 was lowered below the present angle
    direction_ = -direction_;
  const double torque = direction_ * f.mu;
  const State next = runge_kutta(now_, dt_, f.epsilon, [&](double, double) { return torque; });
  if (timing_ == TorqueTiming::per_step || !(direction_ * next.angle >= f.phi0)) {
    now_ = next;
    return dt_;
  }
  double h = dt_;
  now_ = step_to_switch(next, f, h);
  direction_ = -direction_;
  return h;
}

Rk4Pendulum::Step Rk4Pendulum::advance(double epsilon, double mu, double phi0) {
  Step result{status_};
  double time = lead_;
  double side = 1.0; // the half swing: +1 to the right of the vertical, -1 to the left
  bool returning = false;
  const auto end = [&](SwingStatus status) {
    status_ = status;
    return Step{status};
  };
  const auto bound = static_cast<std::int64_t>(longest_period / dt_);
  for (std::int64_t i = 0; status_ == SwingStatus::crossed && i < bound; ++i) {
    const State before = now_;
    const double h = step_on({epsilon, mu, phi0});
    if (!std::isfinite(now_.angle + now_.speed)) return end(SwingStatus::not_finite);
    if (std::abs(now_.angle) >= std::numbers::pi) return end(SwingStatus::overturned);
    if (side * before.angle > 0.0 && side * now_.angle <= 0.0) {
      const double share = before.angle / (before.angle - now_.angle);
      (side > 0.0 ? result.down : result.full) = time + share * h;
      if (side < 0.0) {
        lead_ = (1.0 - share) * h;
        velocity_ = before.speed + share * (now_.speed - before.speed);
        return result;
      }
      side = -1.0;
      returning = false;
    } else if (side * now_.angle > 0.0) {
      const bool outwards = side * now_.speed >= 0.0;
      if (returning && outwards) return end(SwingStatus::stalled);
      returning = !outwards;
    }
    time += h;
  }
  return end(status_ == SwingStatus::crossed ? SwingStatus::stalled : status_);
}

Rk4Clock::Rk4Clock(const ClockParameters& clock, double velocity, double dt, TorqueTiming timing)
    : pendulum_(velocity, dt, timing) {
  set_clock(clock);
}

void Rk4Clock::set_clock(const ClockParameters& clock) {
  check(clock);
  if (!clock.is_plain())
    throw ArgumentError("method", "rk4",
                        "constant torque or none, with linear friction and gravity");
  clock_ = clock;
}

PeriodStep Rk4Clock::advance(double factor) {
  const double mu = clock_.acting_torque() * factor;
  const double phi0 = mu == 0.0 ? 3.0 : clock_.phi0; // without torque there is nothing to switch
  const auto period = pendulum_.advance(clock_.epsilon, mu, phi0);
  return {period.status, period.down - 0.5 * two_pi, period.full - two_pi};
}

} // namespace goingrate
