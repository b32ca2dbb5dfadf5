// The rating nut, compared with numbers worked out by hand.
#include "goingrate/clock/rating_nut.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(RatingNutTest, ASecondsPendulumIsNearlyAMetreLong) {
  EXPECT_NEAR(mathematical_length(2.0), 0.99396, 5e-6); // 9.81 / pi^2
  EXPECT_THROW((void)mathematical_length(0.0), ArgumentError);
}

TEST(RatingNutTest, AClockThatLosesWantsItsBobUp) {
  // 10 s a day of 0.99396 m: 2 x 0.99396 m x 10/86400 = 0.23008 mm, at 0.75 mm a turn 0.30678
  // turns.
  const RatingNut nut{0.75e-3, 0.99396};
  const NutTurns losing = turns_to_zero_rate(nut, -10.0 / 86400.0, 0.1 / 86400.0);
  EXPECT_NEAR(losing.turns, 0.30678, 1e-5); // the last digit given, here and below
  EXPECT_NEAR(losing.sigma, 0.0030678, 1e-7);
  EXPECT_NEAR(losing.raise_m, 0.23008e-3, 1e-8);
  EXPECT_NEAR(turns_to_zero_rate(nut, 10.0 / 86400.0, 0.0).turns, -0.30678, 1e-5);
  EXPECT_TRUE(std::isnan(turns_to_zero_rate(nut, 1e-4, NAN).sigma));
}

TEST(RatingNutTest, WhatCannotBeIsRefused) {
  EXPECT_THROW((void)turns_to_zero_rate({0.0, 1.0}, 1e-4, 0.0), ArgumentError);
  EXPECT_THROW((void)turns_to_zero_rate({1e-3, -1.0}, 1e-4, 0.0), ArgumentError);
}

} // namespace
} // namespace goingrate
