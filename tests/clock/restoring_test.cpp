#include "goingrate/clock/restoring.hpp"

#include "goingrate/base/errors.hpp"

#include <boost/math/special_functions/ellint_1.hpp>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

namespace goingrate {
namespace {

using std::numbers::pi;
constexpr double rounding = std::numeric_limits<double>::epsilon();

TEST(RestoringTest, AngleAndVelocityAreInverse) {
  for (const double share : {1.2, 1.0, 0.97, 0.4, 0.0, -2.0})
    for (const double angle : {1e-6, 0.03, 0.5, 1.8, 3.0, 4.7, 9.0}) {
      if (angle >= top_angle(share)) continue;
      const double velocity = velocity_of_turning_angle(share, angle);
      // An error of the velocity grows by v/(A v'(A)) on its way to the angle: some 20 at 3 rad
      // under gravity, where the pendulum nearly stands on its head.
      EXPECT_NEAR(turning_angle_of_velocity(share, velocity), angle, 40 * rounding * angle)
          << share << ' ' << angle;
    }
}

TEST(RestoringTest, TheTopIsWhereThePullEnds) {
  EXPECT_DOUBLE_EQ(top_angle(1.0), pi);
  for (const double share : {1.5, 1.01, 0.999, 0.9, 0.822}) {
    const double top = top_angle(share);
    const auto pull = [&](double x) { return (1.0 - share) * x + share * std::sin(x); };
    EXPECT_NEAR(pull(top), 0.0, 1e-14) << share;     // rounding of a few rad
    for (double x = 0.01; x < top - 0.01; x += 0.01) // none before it
      ASSERT_GT(pull(x), 0.0) << share << ' ' << x;
  }
  for (const double share : {0.8, 0.0, -2.0}) // nowhere: two turns
    EXPECT_DOUBLE_EQ(top_angle(share), 4.0 * pi) << share;
}

TEST(RestoringTest, NoTurningAngleBeyondTheTop) {
  EXPECT_TRUE(std::isnan(turning_angle_of_velocity(0.5, top_velocity(0.5) * 1.001)));
  EXPECT_TRUE(std::isnan(turning_angle_of_velocity(1.0, 2.001)));
  EXPECT_DOUBLE_EQ(top_velocity(1.0), 2.0);
  EXPECT_DOUBLE_EQ(top_velocity(0.0), 4.0 * pi);
  EXPECT_LT(top_velocity(1.2), 2.0);
  EXPECT_TRUE(std::isnan(turning_angle_of_velocity(1.2, 2.0)));
}

TEST(RestoringTest, PeriodUnderGravityIsTheEllipticIntegral) {
  for (const double angle : {1e-3, 0.1, 1.0, 1.8, 3.0})
    EXPECT_NEAR(free_period_ratio(1.0, angle),
                2.0 / pi * boost::math::ellint_1(std::sin(0.5 * angle)), 1e-14)
        << angle; // some ten roundings
}

TEST(RestoringTest, PassageUnderGravityIsTheEllipticIntegral) {
  for (const double angle : {0.05, 0.3, 1.8, 3.0})
    for (const double share_of_way : {0.01, 0.5, 0.99}) {
      const double half = share_of_way * angle, modulus = std::sin(0.5 * angle);
      EXPECT_NEAR(free_passage_time(1.0, angle, half),
                  2.0 * boost::math::ellint_1(modulus, std::asin(std::sin(0.5 * half) / modulus)),
                  1e-13)
          << angle << ' ' << share_of_way;
    }
  // Under torsion every swing is a sine.
  EXPECT_NEAR(free_passage_time(0.0, 2.0, 1.0), pi / 3.0, 1e-14);
  EXPECT_TRUE(std::isnan(free_passage_time(1.2, 2.9, 0.1)));
}

TEST(RestoringTest, CircularErrorIsTheShareOfGravitys) {
  EXPECT_DOUBLE_EQ(free_period_ratio(0.0, 2.5), 1.0);
  for (const double share : {0.9, 0.5, -1.0}) {
    const double angle = 0.01;
    // The next order is some A^4 s^2 / 100, 1e-10.
    EXPECT_NEAR(free_period_ratio(share, angle) - 1.0, share * angle * angle / 16.0, 2e-10);
  }
  // A large swing: 25 % at 1.8 rad under gravity.
  EXPECT_NEAR(free_period_ratio(1.0, 1.8), 1.25, 0.005);
}

TEST(RestoringTest, AmplitudesOutOfRangeAreRefused) {
  EXPECT_THROW((void)free_period_ratio(1.0, 0.0), ArgumentError);
  EXPECT_THROW((void)free_period_ratio(1.0, pi), ArgumentError);
  ClockParameters clock;
  EXPECT_THROW(check_velocity(clock, 2.0, "velocity"), ArgumentError);
  clock.gravity_share = 0.0;
  EXPECT_NO_THROW(check_velocity(clock, 6.0, "velocity"));
  EXPECT_THROW(check_velocity(clock, 12.6, "velocity"), ArgumentError);
}

} // namespace
} // namespace goingrate
