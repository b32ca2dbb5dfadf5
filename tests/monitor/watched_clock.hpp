// A watched clock, for the tests of the monitor.
#pragma once

#include "clock_watch.hpp"

#include "goingrate/base/random.hpp"

#include <filesystem>
#include <gtest/gtest.h>
#include <limits>

namespace goingrate::apps {

// A watch of a clock whose period is one second less 20 ppm, with 1e-5 s of jitter; each beat is
// heard 0.05 s later.
class WatchedClockTest : public testing::Test {
protected:
  static constexpr double period_s = 1.0;
  static constexpr Instant began{1764201600, 0.0};

  void SetUp() override {
    options_.folder = testing::TempDir() + "watch-" +
                      testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(options_.folder);
    log_.nominal_period_s = period_s;
  }
  void TearDown() override { std::filesystem::remove_all(options_.folder); }

  // Beats `from` … `to` - 1, each heard 0.05 s later; source time counts from `source_zero` seconds
  // after `began`.
  void hear(ClockWatch& watch, std::int64_t from, std::int64_t to, double source_zero = 0.0) {
    for (std::int64_t n = from; n < to; ++n)
      hear_event(watch, event_at(Instant::from_seconds(time_of(n) - source_zero)), time_of(n), n);
    watch.idle(log_, began + (static_cast<double>(to) + 0.1));
  }
  void hear_event(ClockWatch& watch, const Beat& event, double at, std::int64_t n) {
    const Instant now = began + (at + 0.05);
    watch.add(event, log_, now);
    if (n % 10 == 0) watch.idle(log_, now + 0.1);
  }
  // The same all at once, as from a file.
  void hear_at_once(ClockWatch& watch, std::int64_t beats) {
    const Instant now = began + static_cast<double>(beats);
    watch.add(event_at(Instant::from_seconds(time_of(0))), log_, began);
    for (std::int64_t n = 1; n < beats; ++n)
      watch.add(event_at(Instant::from_seconds(time_of(n))), log_, now);
    watch.idle(log_, now + 1.0);
  }
  // The same each as it comes, by a calendar that is so far ahead of the steady clock.
  void hear_by_calendar(ClockWatch& watch, std::int64_t from, std::int64_t to, double ahead_s) {
    for (std::int64_t n = from; n < to; ++n) {
      const Moment now{began + (time_of(n) + ahead_s), time_of(n)};
      watch.add(event_at(Instant::from_seconds(time_of(n))), log_, now);
      watch.idle(log_, now);
    }
  }
  double time_of(std::int64_t beat) {
    return static_cast<double>(beat) * period_s / (1.0 + gain_) + 1e-5 * random_.normal();
  }

  WatchOptions options_;
  ClockLog log_;
  double gain_ = 20e-6;
  RandomStream random_{1, StreamPurpose::jitter};
};

} // namespace goingrate::apps
