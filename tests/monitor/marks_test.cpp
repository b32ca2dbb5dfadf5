#include "going.hpp"

#include "goingrate/base/random.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate::apps {
namespace {

constexpr double period_s = 2.0, jitter_s = 2e-5;

// Seconds that a mark is behind a clock that beat at whole periods from `began` on.
double error_of(const ClockMark& mark, const Instant& began) {
  return (mark.time - began) - period_s * static_cast<double>(mark.cycle);
}

TEST(ClockMarksTest, TwoWrongBeats) {
  const Instant began{1764201600, 0.25};
  for (const double wrong_s : {-0.6, -3e-4, 3e-4, 0.6})
    for (int first = 0; first < 7; ++first)
      for (int second = first; second < 7; ++second) {
        ClockMarks marks;
        for (int n = 0; n < 7; ++n)
          marks.add({began + (period_s * n + (n == first || n == second ? wrong_s : 0.0)), n});
        // Times are rounded to 1e-16 s, and a slope of them is used over three periods.
        EXPECT_NEAR(error_of(marks.get(), began), 0.0, 1e-14) << wrong_s << first << second;
      }
}

// A minute of few beats.
TEST(ClockMarksTest, OneWrongBeatOfFour) {
  for (int wrong = 0; wrong < 4; ++wrong) {
    ClockMarks marks;
    for (int n = 0; n < 4; ++n)
      marks.add({Instant{0, 0.0} + (period_s * n + (n == wrong ? 0.3 : 0.0)), n});
    EXPECT_NEAR(error_of(marks.get(), {0, 0.0}), 0.0, 1e-14) << wrong; // as above
  }
}

TEST(ClockMarksTest, ScatterIsGaussian) {
  constexpr int count = 200'000;
  RandomStream jitter(1, StreamPurpose::jitter), missed(1, StreamPurpose::missed);
  double squares = 0.0, fourths = 0.0;
  for (int i = 0; i < count; ++i) {
    ClockMarks marks;
    for (int n = 0; n < 12; ++n) {
      const double time_s = period_s * n + jitter_s * jitter.normal();
      if (missed.uniform() > 0.04) marks.add({Instant{1, 0.0} + time_s, n});
    }
    const double error = error_of(marks.get(), {1, 0.0}) / jitter_s;
    squares += error * error / count;
    fourths += error * error * error * error / count;
  }
  EXPECT_NEAR(std::sqrt(squares), 0.44, 0.01);              // documented to two digits
  EXPECT_NEAR(fourths / (squares * squares), 3.055, 0.045); // four of its standard errors
}

} // namespace
} // namespace goingrate::apps
