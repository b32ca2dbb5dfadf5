// A free pendulum by the obvious method.
#pragma once

#include "goingrate/dynamics/swing_loss.hpp"

#include <cmath>

namespace goingrate::test {

/// The equation of motion by the classical Runge-Kutta method, in scaled time.
struct Swinging {
  double angle = 0.0, speed = 0.0;

  /// In steps of a four hundredth of a swing; of a two thousandth with dry friction, which jumps
  /// where the pendulum turns, so that no step meets it exactly.
  void go_on(const Friction& friction, double time) {
    const double longest = 6.28 / (friction.dry > 0.0 ? 2000.0 : 400.0);
    const int steps = static_cast<int>(std::ceil(time / longest));
    for (int k = 0; k < steps; ++k)
      step(friction, time / steps);
  }

private:
  [[nodiscard]] Swinging slope(const Friction& f) const {
    const double sign = speed > 0.0 ? 1.0 : speed < 0.0 ? -1.0 : 0.0;
    return {speed, -std::sin(angle) - 2.0 * f.epsilon * speed -
                       f.quadratic * std::abs(speed) * speed - f.dry * sign};
  }
  [[nodiscard]] Swinging after(const Swinging& rate, double dt) const {
    return {angle + dt * rate.angle, speed + dt * rate.speed};
  }
  void step(const Friction& f, double dt) {
    const Swinging a = slope(f), b = after(a, 0.5 * dt).slope(f), c = after(b, 0.5 * dt).slope(f),
                   d = after(c, dt).slope(f);
    angle += dt / 6.0 * (a.angle + 2.0 * b.angle + 2.0 * c.angle + d.angle);
    speed += dt / 6.0 * (a.speed + 2.0 * b.speed + 2.0 * c.speed + d.speed);
  }
};

} // namespace goingrate::test
