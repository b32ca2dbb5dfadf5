#include "base/time_grain.hpp"

#include "goingrate/base/random.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace goingrate {
namespace {

double grain_of(const std::vector<double>& times, double period_s = 2.0) {
  return time_grain(times.size(), period_s, [&](std::size_t i) { return times[i] - times[0]; });
}

// Times of a clock of 2.0003 s with some jitter, rounded to steps.
std::vector<double> rounded_times(double step_s) {
  RandomStream random(1, StreamPurpose::jitter);
  std::vector<double> times;
  for (int i = 0; i < 3000; ++i)
    times.push_back(step_s * std::round((i * 2.0003 + 1e-4 * random.normal()) / step_s));
  return times;
}

TEST(TimeGrainTest, FindsTheStepsOfALogger) {
  for (const double step_s : {1e-6, 4e-6, 1e-3, 0.01, 0.1})
    EXPECT_NEAR(grain_of(rounded_times(step_s)), step_s, 1e-9 * step_s) << step_s;
}

TEST(TimeGrainTest, OfSteadyBeatsThePowerOfTenIsTaken) {
  std::vector<double> times;
  for (int i = 0; i < 100; ++i)
    times.push_back(2.0 * i);
  EXPECT_EQ(grain_of(times), 1.0) << "2 s is the clock's own step";
  for (double& time : times)
    time *= 1.0003;
  EXPECT_NEAR(grain_of(times), 1e-4, 1e-13) << "and 2.0006 s as well"; // 1e-9 of the step, as above
}

TEST(TimeGrainTest, TimesOnNoGridHaveNone) {
  RandomStream random(1, StreamPurpose::jitter);
  std::vector<double> times;
  for (int i = 0; i < 3000; ++i)
    times.push_back(2.0003 * i + 1e-5 * random.normal());
  EXPECT_LE(grain_of(times), 1e-9);
  EXPECT_EQ(time_grain(0, 2.0, [](std::size_t) { return 0.0; }), 0.0);
}

} // namespace
} // namespace goingrate
