#include "goingrate/dynamics/averaged_pendulum.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/averaged.hpp"
#include "goingrate/dynamics/moments.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

using std::numbers::pi;

// lambda and phase by many small steps of Heun's rule: the slow obvious way.
struct Fine {
  double lambda, excess;
};
Fine fine_period(const ClockParameters& clock, double lambda, bool in_full) {
  const auto rate = [&](double x) {
    return (in_full ? circular_error(x) : -x * x / 16) - drive_moments(clock, x).b / x;
  };
  const auto growth = [&](double x) {
    return drive_moments(clock, x).a - friction_moment(clock, x);
  };
  double phase = 0.0, t = 0.0;
  const int steps = 4000;
  const double h = 2 * pi / steps;
  for (;;) { // until psi = 2 pi
    const double ahead = lambda + h * growth(lambda);
    const double mean_rate = 1 + 0.5 * (rate(lambda) + rate(ahead));
    const double left = 2 * pi - phase;
    const double share = std::min(1.0, left / (h * mean_rate));
    lambda += share * 0.5 * h * (growth(lambda) + growth(ahead));
    phase += share * h * mean_rate;
    t += share * h;
    if (share < 1.0) return {lambda, t - 2 * pi};
  }
}

TEST(AveragedPendulumTest, OnePeriodAgreesWithFineSteps) {
  ClockParameters torque{2.0, 2.5e-4, 4e-5, 0.03};
  ClockParameters rough = torque;
  rough.quadratic_drag = 1e-3;
  rough.dry_friction = 1e-6;
  ClockParameters impulse;
  impulse.epsilon = 1e-4;
  impulse.escapement = Escapement::single_impulse;
  impulse.impulse = 2e-6;
  impulse.impulse_angle = 0.01;
  for (const auto& clock : {torque, rough, impulse})
    for (const bool in_full : {false, true}) {
      const auto order = in_full ? AveragedOrder::first_in_full : AveragedOrder::first;
      AveragedPendulum pendulum(clock, 0.06, order);
      const auto step = pendulum.advance();
      const Fine fine = fine_period(clock, 0.06, in_full);
      EXPECT_NEAR(step.excess, fine.excess, 1e-11); // Heun: (2 pi/4000)^2 of 1e-6; its summing
      // Likewise 2.5e-6 of 1e-4, whose slope changes by 1e-4 of itself.
      EXPECT_NEAR(pendulum.velocity(), fine.lambda, 1e-13);
    }
}

TEST(AveragedPendulumTest, ManyPeriodsAgreeWithTheClosedForm) {
  const ClockParameters clock{2.0, 2.5e-4, 4e-5, 0.03};
  AveragedPendulum pendulum(clock, 0.04, AveragedOrder::first);
  const AveragedMotion<double> motion(2.5e-4, 4e-5, 0.03, 0.04 * 0.04);
  double t = 0.0;
  for (int i = 0; i < 3000; ++i)
    t += 2 * pi + pendulum.advance().excess;
  const auto state = motion.at(t);
  // 3000 roundings of 3e-19.
  EXPECT_NEAR(pendulum.velocity() * pendulum.velocity(), state.amplitude2, 1e-15);
  EXPECT_NEAR(t + state.phase_excess, 3000 * 2 * pi, 1e-9); // Simpson's rule, 3e-13 a period
}

TEST(AveragedPendulumTest, StationaryRatesAreThoseOfTheirEquations) {
  const ClockParameters c{2.0, 1.167245e-4, 1.5e-5, 0.03};
  AveragedPendulum first(c, *stationary_amplitude(c), AveragedOrder::first);
  // Roundings of terms of 1.5e-4, which cancel.
  EXPECT_NEAR(rate_excess_of(first.advance().excess), *stationary_rate_first_order(c), 2e-19);
  const auto cycle = limit_cycle(c);
  AveragedPendulum second(c, cycle->velocity, AveragedOrder::second);
  // The third order: epsilon times the second, 1.8e-8.
  EXPECT_NEAR(rate_excess_of(second.advance().excess), cycle->rate_excess, 5e-12);
}

TEST(AveragedPendulumTest, BelowTheSwitchingAngleItSaysThatItStalls) {
  const ClockParameters weak{2.0, 1e-2, 1e-4, 0.03};
  for (const auto order : {AveragedOrder::first, AveragedOrder::second}) {
    AveragedPendulum pendulum(weak, 0.05, order);
    PeriodStep step;
    for (int i = 0; i < 1000 && step.status == SwingStatus::crossed; ++i) {
      step = pendulum.advance();
      ASSERT_TRUE(std::isfinite(step.excess));
    }
    EXPECT_EQ(step.status, SwingStatus::stalled);
  }
}

} // namespace
} // namespace goingrate
