#include "goingrate/dynamics/direct.hpp"

#include "base/scaled_time.hpp"
#include "dynamics/point_c.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/dynamics/moments.hpp"
#include "goingrate/dynamics/stationary.hpp"
#include "support/noisy_oracle.hpp"

#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

using std::numbers::pi;

using test::clock_c, test::velocity_c, test::excess_c;

using test::error_of;

TEST(DirectTest, CrossingTimesOfPointC) {
  DirectPendulum pendulum(clock_c, velocity_c);
  TwoPart<double> excess;
  for (int cycle = 1; cycle <= 2000; ++cycle) {
    excess += pendulum.advance().excess;
    // Asked: 1e-13. Reached is 4e-15: a few units in the 18th place a period.
    ASSERT_LT(error_of(excess, excess_c * cycle), 3e-14) << cycle;
  }
}

TEST(DirectTest, CrossingTimesOfANoisyDrive) {
  // Asked: 1e-13 for 2000 periods, 1e-12 for 1e5 (tests/studies has those).
  EXPECT_LT(test::worst_noisy_error(DirectPendulum(clock_c, velocity_c), clock_c, 4000), 1e-13);
}

TEST(DirectTest, LimitCycleDoesNotFreeze) {
  // Started a part in 1e9 off, v must come back to within rounding of the limit cycle: rounding v
  // to a double every period would stop it some 1e-14 short. 30 relaxation times of 1/(4 pi eps)
  // periods.
  DirectPendulum pendulum(clock_c, velocity_c * (1 + 1e-9));
  for (int cycle = 0; cycle < 20500; ++cycle)
    (void)pendulum.advance();
  EXPECT_NEAR(pendulum.velocity() / velocity_c, 1.0, 3e-14); // the steps' error of 5e-17, collected
}

TEST(DirectTest, TimeIsAddedUpOverASwingBackwards) {
  // The undamped pendulum is symmetric in time: both halves of a period are equal.
  ClockParameters free;
  free.escapement = Escapement::none;
  DirectPendulum pendulum(free, 1.2);
  const auto step = pendulum.advance();
  EXPECT_EQ(step.excess, 2 * step.half_excess);
  EXPECT_EQ(pendulum.velocity(), 1.2);
}

TEST(DirectTest, TheSingleImpulseClockGoesAsEqBlow6Says) {
  ClockParameters clock;
  clock.epsilon = 1e-4;
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 1.5e-6;
  const double lambda = std::sqrt(clock.impulse / (2 * pi * clock.epsilon));
  for (const double angle : {-0.02, 0.0, 0.02}) {
    clock.impulse_angle = angle;
    const auto cycle = limit_cycle(clock);
    ASSERT_TRUE(cycle) << angle;
    const double tangent = angle / std::sqrt(lambda * lambda - angle * angle);
    const double rate = -clock.impulse / (32 * pi * clock.epsilon) - clock.epsilon * tangent;
    // Roundings of the moments, 1e-20 each.
    EXPECT_NEAR(*stationary_rate_first_order(clock), rate, 1e-18);
    EXPECT_NEAR(cycle->rate_excess, rate, 3e-7); // second order: 2 pi eps, lambda^2
  }
}

TEST(DirectTest, AProfileClockAndAConstantTorqueClockAreTheSameWhereTheyShould) {
  // A profile can be the constant torque of point A only for one direction at a time: its switch
  // at phi0 is part of the rising table, the one at -phi0 of the falling table.
  ClockParameters profile{two_pi, 2.5e-4, 0.0, 0.0, Escapement::profile};
  const double mu = 2e-5, far = 1.0, width = 1e-10;
  profile.rising.points = {{-far, mu}, {0.03, mu}, {0.03 + width, -mu}, {far, -mu}};
  profile.falling.points = {{-far, mu}, {-0.03 - width, mu}, {-0.03, -mu}, {far, -mu}};
  const auto table = limit_cycle(profile);
  const auto torque = limit_cycle({two_pi, 2.5e-4, 2e-5, 0.03});
  ASSERT_TRUE(table && torque);
  EXPECT_NEAR(table->rate_excess, torque->rate_excess, 1e-12); // the width times mu/phi0
}

TEST(DirectTest, QuadraticAndDryFrictionSlowTheSwingAsTheirAveragesSay) {
  ClockParameters clock;
  clock.epsilon = 1e-5;
  clock.quadratic_drag = 2e-3;
  clock.dry_friction = 1e-6;
  clock.escapement = Escapement::none;
  DirectPendulum pendulum(clock, 0.08);
  const double fall = 2 * pi * friction_moment(clock, 0.08);
  (void)pendulum.advance();
  EXPECT_NEAR((0.08 - pendulum.velocity()) / fall, 1.0, 5e-3); // second order: friction itself
}

TEST(DirectTest, SpeedAfterHalfAPeriod) {
  // For a free pendulum with a small swing and linear friction alone: exp(-epsilon pi) times the
  // speed, to second order in both; and the second half from there gives the period.
  ClockParameters clock;
  clock.epsilon = 1e-3;
  clock.escapement = Escapement::none;
  // The circular error, 6e-6, of the loss, 3e-3.
  EXPECT_NEAR(speed_after_half(clock, 0.01, 1.0) / 0.01, std::exp(-1e-3 * pi), 2e-8);
  const double half = speed_after_half(clock_c, 0.06, 1.3);
  DirectPendulum pendulum(clock_c, 0.06);
  (void)pendulum.advance(1.3);
  EXPECT_NE(half, 0.06);
  EXPECT_NE(half, pendulum.velocity());
  EXPECT_GT((half - 0.06) * (pendulum.velocity() - half), 0.0) << "between the two";
}

TEST(DirectTest, StartsOutsideTheSwingingPendulumAreRefused) {
  EXPECT_THROW(DirectPendulum(clock_c, 0.0), ArgumentError);
  EXPECT_THROW(DirectPendulum(clock_c, 2.0), ArgumentError);
}

} // namespace
} // namespace goingrate
