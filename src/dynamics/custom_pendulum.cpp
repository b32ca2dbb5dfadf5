#include "goingrate/dynamics/custom_pendulum.hpp"

#include "base/special_values.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <numbers>

namespace goingrate {

CustomPendulum::CustomPendulum(CustomLaws laws, double velocity)
    : laws_(std::move(laws)), state_{0.0, velocity} {
  if (!(velocity > 0.0 && velocity < 2.0))
    throw ArgumentError("velocity", velocity,
                        "above 0 and below 2 (where the pendulum turns over)");
}

double CustomPendulum::acceleration(const State& state) const {
  const double phi = state[0];
  // Up to the apex the laws for the direction of approach hold, also in stages just beyond it.
  constexpr double smallest_speed = 1e-300;
  const double w = !laws_.jumps_with_direction ? state[1]
                   : rightwards_               ? std::max(state[1], smallest_speed)
                                               : std::min(state[1], -smallest_speed);
  // A stage at the end of a step may lie a rounding beyond the jump that ends it.
  const double at = std::clamp(phi, low_, high_);
  return laws_.torque(at, w) - laws_.friction(at, w) - std::sin(phi);
}

// The stretch between two jumps in which the pendulum is, or which it enters.
void CustomPendulum::enter_stretch(bool rightwards) {
  low_ = -infinite;
  high_ = infinite;
  for (const double jump : laws_.jumps) {
    const bool is_behind = state_[0] > jump || (state_[0] == jump && rightwards);
    if (is_behind)
      low_ = std::max(low_, std::nextafter(jump, infinite));
    else
      high_ = std::min(high_, std::nextafter(jump, -infinite));
  }
}

CustomPendulum::State CustomPendulum::step(const State& from, double h) const {
  // One step of the 8th-order formula; `to_vertical` keeps h short enough for 1e-14.
  boost::numeric::odeint::runge_kutta_fehlberg78<State> formula;
  State to;
  formula.do_step(
      [this](const State& s, State& slope, double) {
        slope = {s[1], acceleration(s)};
      },
      from, 0.0, to, h);
  return to;
}

// The time within the step h at which component `of` of the state reaches the target.
double CustomPendulum::time_to(double target, std::size_t of, double h) const {
  double low = 0.0, high = h, t = 0.5 * h;
  const double start = state_[of] - target;
  for (int i = 0; i < 60; ++i) {
    const State at = step(state_, t);
    const double off = at[of] - target;
    ((off > 0.0) == (start > 0.0) && off != 0.0 ? low : high) = t;
    const double newton = t - off / (of == 0 ? at[1] : acceleration(at));
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(next - t) < 1e-15) return next;
    t = next;
  }
  return t;
}

SwingStatus CustomPendulum::to_vertical(bool upward, double& excess) {
  constexpr double h = 0.05;               // (h^8/9!) of the motion: 1e-16 a step
  const double sign = upward ? 1.0 : -1.0; // of phi in this half swing
  double duration = 0.0;
  rightwards_ = upward;
  for (bool turned = false; duration < 200.0;) {
    enter_stretch(rightwards_);
    State ahead = step(state_, h);
    if (!std::isfinite(ahead[0] + ahead[1])) return SwingStatus::not_finite;
    if (std::abs(ahead[0]) >= std::numbers::pi) return SwingStatus::overturned;
    double t = h;
    std::size_t of = 2; // the component that ends the step early, none so far
    double target = 0.0;
    const auto ends_at = [&](double value, std::size_t component) {
      const double at = time_to(value, component, t);
      if (at < t) {
        t = at;
        of = component;
        target = value;
      }
    };
    const auto passes = [&](double angle) {
      return (state_[0] - angle) * (ahead[0] - angle) < 0.0;
    };
    if (!turned && laws_.jumps_with_direction && state_[1] * ahead[1] < 0.0) {
      ends_at(0.0, 1);
      ahead = step(state_, t); // a jump may lie before the apex even if none lies before the end
    }
    for (const double jump : laws_.jumps)
      if (jump != 0.0 && passes(jump)) ends_at(jump, 0);
    const bool back = sign * ahead[0] <= 0.0 && (turned || sign * ahead[1] < 0.0);
    if (back) ends_at(0.0, 0);
    state_ = step(state_, t);
    if (of < 2) state_[of] = target;
    duration += t;
    if (of == 0 && target == 0.0) {
      excess += duration - std::numbers::pi;
      return SwingStatus::crossed;
    }
    if (!turned && sign * state_[1] <= 0.0) {
      turned = true;
      rightwards_ = !upward;
    } else if (turned && sign * state_[1] > 0.0) {
      return SwingStatus::stalled;
    }
  }
  return SwingStatus::stalled;
}

PeriodStep CustomPendulum::advance() {
  PeriodStep result;
  for (const bool upward : {true, false}) {
    result.status = to_vertical(upward, result.excess);
    if (result.status != SwingStatus::crossed) return result;
    if (upward) result.half_excess = result.excess;
  }
  return result;
}

} // namespace goingrate
