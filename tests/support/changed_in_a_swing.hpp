// A clock that changes at any moment of a swing, by the obvious method: with none of the
// simulator's methods and none of the fit's approximations.
#pragma once

#include "goingrate/base/random.hpp"
#include "goingrate/clock/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace goingrate::test {

/// phi'' = -w^2 sin phi - 2 eps w phi' +- w^2 mu, w = 2 pi/T0, in seconds, by the classical
/// Runge-Kutta method. The torque turns round where phi passes +-phi0.
class DrivenPendulum {
public:
  DrivenPendulum(const ClockParameters& clock, double amplitude)
      : clock_(clock), now_{0.0, frequency() * amplitude} {}

  void change(const ClockParameters& clock) { clock_ = clock; }

  /// Runs on, and adds the times of upward crossings on the way.
  void run_for(double duration_s, std::vector<double>& crossings_s) {
    run_until(time_s_ + duration_s, crossings_s);
  }
  void run_until(double until_s, std::vector<double>& crossings_s) {
    const double step_s = clock_.nominal_period_s / 1000.0;
    while (time_s_ < until_s)
      step(std::min(step_s, until_s - time_s_), crossings_s);
  }

private:
  struct State {
    double angle, speed;
  };
  [[nodiscard]] double frequency() const {
    return 2.0 * std::numbers::pi / clock_.nominal_period_s;
  }
  [[nodiscard]] State slope(const State& at) const {
    const double w = frequency();
    return {at.speed,
            w * w * (clock_.mu * side_ - std::sin(at.angle)) - 2.0 * clock_.epsilon * w * at.speed};
  }
  [[nodiscard]] State after(double h) const {
    const auto along = [&](const State& rate, double t) {
      return State{now_.angle + t * rate.angle, now_.speed + t * rate.speed};
    };
    const State a = slope(now_), b = slope(along(a, 0.5 * h)), c = slope(along(b, 0.5 * h)),
                d = slope(along(c, h));
    return {now_.angle + h / 6.0 * (a.angle + 2.0 * (b.angle + c.angle) + d.angle),
            now_.speed + h / 6.0 * (a.speed + 2.0 * (b.speed + c.speed) + d.speed)};
  }
  // When within a step the angle is `angle`, by bisection.
  [[nodiscard]] double when(double angle, double h) const {
    double low = 0.0, high = h;
    const bool below = now_.angle < angle;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      ((after(middle).angle < angle) == below ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  void step(double h, std::vector<double>& crossings_s) {
    State next = after(h);
    const bool turns = side_ * next.angle >= clock_.phi0;
    if (turns && side_ * now_.angle < clock_.phi0) {
      h = when(side_ * clock_.phi0, h);
      next = after(h);
    }
    if (now_.angle < 0.0 && next.angle >= 0.0) crossings_s.push_back(time_s_ + when(0.0, h));
    if (turns) side_ = -side_;
    now_ = next;
    time_s_ += h;
  }

  ClockParameters clock_;
  State now_;
  double time_s_ = 0.0, side_ = 1.0;
};

/// The crossings, from the first on, of a clock that starts with this amplitude and becomes another
/// `change` swings after the first, not always a whole number; with white jitter.
inline std::vector<double> crossings_of_a_changed_clock(const ClockParameters& before,
                                                        const ClockParameters& after,
                                                        double amplitude, double change,
                                                        std::size_t crossings, double jitter_s,
                                                        std::uint64_t seed) {
  std::vector<double> times_s;
  DrivenPendulum pendulum(before, amplitude);
  const double T0 = before.nominal_period_s, whole = std::floor(change);
  while (times_s.size() < static_cast<std::size_t>(whole) + 1)
    pendulum.run_for(0.01 * T0, times_s);
  pendulum.run_until(times_s.back() + (change - whole) * T0, times_s);
  pendulum.change(after);
  while (times_s.size() < crossings)
    pendulum.run_for(T0, times_s);
  times_s.resize(crossings);
  RandomStream noise(seed, StreamPurpose::jitter);
  for (double& time : times_s)
    time += jitter_s * noise.normal();
  return times_s;
}

} // namespace goingrate::test
