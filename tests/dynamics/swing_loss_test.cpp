// The loss of a swing by friction, against the equation of motion integrated step by step.
#include "goingrate/dynamics/swing_loss.hpp"

#include "goingrate/base/errors.hpp"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

using std::numbers::pi;

// Angle, speed and the work done against friction.
using State = std::array<double, 3>;

State slope(const State& s, const Friction& f) {
  const double sign = s[1] > 0.0 ? 1.0 : -1.0;
  const double friction =
      2.0 * f.epsilon * s[1] + f.quadratic * std::abs(s[1]) * s[1] + f.dry * sign;
  return {s[1], -std::sin(s[0]) - friction, friction * s[1]};
}

State stepped(const State& s, const Friction& f, double dt) {
  const auto after = [&](const State& rate, double part) {
    return State{s[0] + part * rate[0], s[1] + part * rate[1], s[2] + part * rate[2]};
  };
  const State a = slope(s, f), b = slope(after(a, 0.5 * dt), f), c = slope(after(b, 0.5 * dt), f),
              d = slope(after(c, dt), f);
  State next;
  for (std::size_t i = 0; i < 3; ++i)
    next[i] = s[i] + dt / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
  return next;
}

// 1/Q from one swing from side to side: half a period.
double integrated_inverse_q(const Friction& friction, double amplitude) {
  constexpr double dt = 2e-4;
  State s{amplitude, -1e-15, 0.0};
  do
    s = stepped(s, friction, dt);
  while (s[1] < 0.0);
  return s[2] / (pi * (1.0 - std::cos(amplitude)));
}

TEST(SwingLossTest, IsWhatThePendulumLoses) {
  for (const double amplitude : {0.05, 0.3, 1.0, 2.0})
    for (const Friction& friction : {Friction{1e-5, 0.0, 0.0}, Friction{0.0, 1e-5, 0.0},
                                     Friction{0.0, 0.0, 1e-6}, Friction{1e-5, 2e-5, 3e-7}}) {
      const double integrated = integrated_inverse_q(friction, amplitude);
      // The swing ends a part 1/Q lower than it began, and the last step goes a little beyond.
      EXPECT_NEAR(1.0 / quality_factor(friction, amplitude), integrated,
                  integrated * std::max(2e-4, 4.0 * integrated))
          << amplitude << " rad, " << friction.epsilon << " " << friction.quadratic << " "
          << friction.dry;
    }
}

TEST(SwingLossTest, SmallSwingsLoseWhatTheAveragedEquationsSay) {
  constexpr double amplitude = 1e-3;
  const auto share = inverse_q_per_friction(amplitude);
  // The next order is A^2/8 or less.
  EXPECT_NEAR(share[0], 2.0, 1e-6);
  EXPECT_NEAR(share[1] / (8.0 / (3.0 * pi) * amplitude), 1.0, 1e-6);
  EXPECT_NEAR(share[2] / (4.0 / (pi * amplitude)), 1.0, 1e-6);
  EXPECT_NEAR(decay_periods_per_q(amplitude), 1.0 / pi, 1e-6);
  EXPECT_NEAR(circular_period_ratio(0.1), 1.0 + 0.01 / 16.0 + 11.0 / 3072.0 * 1e-4, 1e-9);
}

TEST(SwingLossTest, RefusesAmplitudesThatAreNone) {
  for (const double amplitude : {0.0, -0.1, pi, double(NAN)})
    EXPECT_THROW((void)inverse_q_per_friction(amplitude), ArgumentError);
}

} // namespace
} // namespace goingrate
