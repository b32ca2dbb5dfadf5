#include "goingrate/dynamics/rate_map.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(RateMapTest, EachPointIsThatOfItsClock) {
  // The paper's point C in one corner, a clock that stalls in another.
  const RateMap map = rate_map(0.03, {1.167245e-4, 1e-3}, {1e-7, 1.5e-5}, Equations::exact);
  ASSERT_EQ(map.rate_excess.size(), 2u);
  ASSERT_EQ(map.rate_excess[1].size(), 2u);
  const ClockParameters c{2.0, 1.167245e-4, 1.5e-5, 0.03};
  EXPECT_EQ(map.rate_excess[1][0], limit_cycle(c)->rate_excess);
  EXPECT_TRUE(std::isnan(map.rate_excess[0][1]));
  const RateMap first = rate_map(0.03, {1.167245e-4}, {1.5e-5}, Equations::first_order);
  EXPECT_EQ(first.rate_excess[0][0], *stationary_rate_first_order(c));
}

TEST(RateMapTest, RefusesWhatNoClockHas) {
  EXPECT_THROW((void)rate_map(0.03, {0.0}, {1e-5}, Equations::exact), ArgumentError);
  EXPECT_THROW((void)rate_map(0.03, {1e-4}, {std::nan("")}, Equations::exact), ArgumentError);
  EXPECT_THROW((void)rate_map(0.03, {1.5}, {1e-5}, Equations::exact), ArgumentError);
  EXPECT_THROW((void)rate_map(-1.0, {1e-4}, {1e-5}, Equations::exact), ArgumentError);
}

TEST(RateMapTest, AGridHasEqualRatios) {
  const auto grid = log_grid(1e-5, 1e-3, 5);
  ASSERT_EQ(grid.size(), 5u);
  EXPECT_EQ(grid.front(), 1e-5);
  EXPECT_EQ(grid.back(), 1e-3);
  for (std::size_t i = 1; i < grid.size(); ++i)
    EXPECT_NEAR(grid[i] / grid[i - 1], std::sqrt(10.0), 1e-14); // rounding of pow
  EXPECT_THROW((void)log_grid(1.0, 1.0, 5), ArgumentError);
  EXPECT_THROW((void)log_grid(0.0, 1.0, 5), ArgumentError);
  EXPECT_THROW((void)log_grid(0.1, 1.0, 1), ArgumentError);
}

} // namespace
} // namespace goingrate
