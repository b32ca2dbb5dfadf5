#include "causes/slope_jumps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace goingrate::timing_model {
namespace {

constexpr double century_s = 3.2e9;

// Lateness, s, of a clock that gains 17 s a day, once in 2 s from a time on, with 0.1 ms of noise.
Track beats_from(double begin_s) {
  std::mt19937_64 random(20261128);
  std::normal_distribution<double> noise(0.0, 1e-4);
  Track track;
  for (int i = 0; i < 4000; ++i) {
    track.time.push_back(begin_s + 2.0 * i);
    track.value.push_back(1.96e-4 * track.time.back() + noise(random));
  }
  return track;
}

TEST(SlopeJumpsTest, SlopeOfALineIsItsSlope) {
  Track line;
  for (int i = 0; i < 50; ++i) {
    line.time.push_back(0.5 * i * i); // at unequal steps
    line.value.push_back(3.0 - 0.25 * line.time.back());
  }
  EXPECT_NEAR(slope_of(line, 7, 41), -0.25, 1e-14); // rounding
}

TEST(SlopeJumpsTest, ACenturyIsAsGoodAsAnHour) {
  constexpr std::size_t window = 30;
  const Jumps early = slope_jumps(beats_from(0.0), window, 1e-9);
  const Jumps late = slope_jumps(beats_from(century_s), window, 1e-9);
  EXPECT_NEAR(late.scatter, early.scatter, 1e-3 * early.scatter);
  for (std::size_t i = 0; i < early.jump.size(); ++i) // the late values are rounded to 1e-10 s
    ASSERT_NEAR(late.jump[i], early.jump[i], 1e-3 * early.scatter) << i;
}

TEST(SlopeJumpsTest, ACenturyWithoutAChangeHasNone) {
  constexpr double least_significance = 10.0; // as a diary asks for
  const Jumps jumps = slope_jumps(beats_from(century_s), 30, 1e-9);
  for (std::size_t i = 0; i < jumps.jump.size(); ++i)
    ASSERT_LT(jumps.score(i), least_significance) << i;
}

} // namespace
} // namespace goingrate::timing_model
