#include "amplitude_fall.hpp"

#include "goingrate/base/random.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate::apps {
namespace {

// Minutes of a clock whose amplitude of 30 mrad falls, after steady days, by a share a day for
// sixty days; the day of the first alarm, if there is one.
struct FallTold {
  int times = 0;
  double first_day = 0.0;
};
FallTold fall_told(double share_a_day, int steady_days) {
  RandomStream random(5, StreamPurpose::jitter);
  AmplitudeFall watch;
  FallTold told;
  for (std::int64_t minute = 0; minute < (steady_days + 60) * 1440; ++minute) {
    const double day = static_cast<double>(minute) / 1440.0 - steady_days;
    const double level = 30.0 * (1.0 - share_a_day * std::max(0.0, day));
    if (level < 5.0) break;
    if (watch.add(minute, level + 0.1 * random.normal()) && told.times++ == 0) told.first_day = day;
  }
  return told;
}

TEST(AmplitudeFallTest, OneThatGoesOnIsToldOnce) {
  for (const double share : {0.005, 0.01, 0.03, 0.1})
    for (const int steady_days : {0, 40}) {
      const FallTold told = fall_told(share, steady_days);
      EXPECT_EQ(told.times, 1) << share << " " << steady_days;
      // Nine means of days, and the one that is going on.
      EXPECT_GT(told.first_day, 0.0) << share << " " << steady_days;
      EXPECT_LT(told.first_day, 10.1) << share << " " << steady_days;
    }
  EXPECT_EQ(fall_told(0.0, 0).times, 0);
}

TEST(AmplitudeFallTest, IsOverWhenItHasComeBackOrHeld) {
  for (const double after : {27.0, 29.5}) {
    RandomStream random(6, StreamPurpose::jitter);
    AmplitudeFall watch;
    std::int64_t minute = 0;
    const auto hear_days = [&](int days, double level) {
      int told = 0;
      for (const std::int64_t end = minute + days * 1440; minute < end; ++minute)
        told += watch.add(minute, level + 0.1 * random.normal()) ? 1 : 0;
      return told;
    };
    EXPECT_EQ(hear_days(24, 30.0), 0);
    EXPECT_EQ(hear_days(2, 27.0), 1);
    EXPECT_TRUE(watch.is_raised());
    EXPECT_EQ(hear_days(5, after), 0);
    EXPECT_EQ(watch.is_raised(), after < 28.5); // half way
    EXPECT_EQ(hear_days(35, after), 0);
    EXPECT_FALSE(watch.is_raised());
    EXPECT_EQ(hear_days(1, after - 3.0), 1); // another one
  }
}

// A spring clock whose amplitude sags by a tenth from one winding to the next.
TEST(AmplitudeFallTest, OneUnderTheSagOfAWeekIsTold) {
  for (const double share_a_day : {0.0, 0.01}) {
    RandomStream random(12, StreamPurpose::jitter);
    AmplitudeFall watch;
    double told_after_days = 0.0;
    for (std::int64_t minute = 0; minute < 120 * 1440 && told_after_days == 0.0; ++minute) {
      const double days = static_cast<double>(minute) / 1440.0 - 60.0;
      const double sag = 0.1 * static_cast<double>(minute % 10080) / 10080.0;
      const double level = 30.0 * (1.0 - sag - share_a_day * std::max(0.0, days));
      if (watch.add(minute, level + 0.1 * random.normal())) told_after_days = days;
    }
    EXPECT_EQ(told_after_days > 0.0, share_a_day > 0.0);
    EXPECT_LT(told_after_days, 43.0); // 4 changes of means of weeks, and the weeks themselves
  }
}

// A season takes 10 % and gives it back.
TEST(AmplitudeFallTest, ASeasonIsNone) {
  RandomStream random(9, StreamPurpose::jitter);
  AmplitudeFall watch;
  int told = 0;
  for (std::int64_t minute = 0; minute < 2 * 525960; ++minute) {
    const double year = 2.0 * std::numbers::pi * static_cast<double>(minute) / 525960.0;
    told += watch.add(minute, 30.0 * (1.0 + 0.1 * std::cos(year)) + 0.1 * random.normal()) ? 1 : 0;
  }
  EXPECT_EQ(told, 0);
}

// A clock that is wound every week and whose drive wanders is not called out.
TEST(AmplitudeFallTest, TheSagOfAWeekIsNone) {
  int told = 0;
  for (const double wander : {0.0, 0.3}) {
    RandomStream random(7, StreamPurpose::jitter);
    AmplitudeFall watch;
    double away = 0.0;
    for (std::int64_t minute = 0; minute < 2 * 525960; ++minute) {
      constexpr double memory_minutes = 2880.0;
      away += -away / memory_minutes + std::sqrt(2.0 / memory_minutes) * wander * random.normal();
      const double sag = 0.4 * static_cast<double>(minute % (7 * 1440)) / (7.0 * 1440.0);
      told += watch.add(minute, 30.0 + away - sag + 0.1 * random.normal()) ? 1 : 0;
    }
  }
  EXPECT_LE(told, 4); // years
}

TEST(DailyWaveTest, IsLearntAndTakenOut) {
  RandomStream random(8, StreamPurpose::jitter);
  DailyWave wave;
  constexpr std::int64_t day = 1440;
  double squares = 0.0, step_seen = 0.0;
  for (std::int64_t minute = 0; minute < 31 * day; ++minute) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(minute) / day;
    const double step = minute >= 30 * day ? 2.0 : 0.0;
    const double clock = 7.0 + 5.0 * std::sin(phase) + std::cos(2.0 * phase + 1.0);
    const auto without = wave.without(minute, clock + step + 0.1 * random.normal());
    ASSERT_TRUE(without);
    const double rest = *without - 7.0;
    if (minute >= 20 * day && minute < 30 * day) squares += rest * rest / (10.0 * day);
    if (minute >= 30 * day) step_seen += rest / day;
  }
  // 0.1 of noise, and the part of a wave of 5 that is held back: 720 of 720 + 12,000 minutes.
  EXPECT_LT(std::sqrt(squares), 0.1 + 0.28);
  EXPECT_NEAR(step_seen, 2.0, 0.2); // a level is not a wave; a day is a tenth of what is remembered
  EXPECT_FALSE(wave.without(31 * day, std::nullopt));
}

TEST(StepAlarmTest, FindsAStepAndTakesTheNewLevelForTheUsual) {
  RandomStream random(3, StreamPurpose::jitter);
  StepAlarm alarm;
  for (int minute = 0; minute < 3000; ++minute)
    EXPECT_FALSE(alarm.add(random.normal())) << minute;
  int delay = 0;
  std::optional<FoundStep> found;
  for (; delay < 200 && !found; ++delay)
    found = alarm.add(random.normal() + 3.0);
  ASSERT_TRUE(found);
  // A mean of 4 minutes is off by 3 against a sigma of 0.53: 5.7, about the limit of that scale.
  EXPECT_LE(delay, 24);
  EXPECT_NEAR(found->size, 3.0, 3.0);
  EXPECT_TRUE(alarm.is_raised());
  for (int minute = 0; minute < 2000; ++minute)
    EXPECT_FALSE(alarm.add(random.normal() + 3.0)) << minute;
  EXPECT_FALSE(alarm.is_raised());
}

// Rates of a steady clock, in ppm: minutes scatter by 0.1.
class WoundClock {
public:
  // Adds the minutes of so many days; returns how many steps were told.
  int hear_days(double days, double saw_tooth, double step) {
    int told = 0;
    const auto minutes = static_cast<std::int64_t>(days * 1440.0);
    for (const std::int64_t end = minute_ + minutes; minute_ < end; ++minute_) {
      constexpr std::int64_t week = 10080;
      const double since = static_cast<double>(minute_ % week) / static_cast<double>(week);
      const double rate = 0.1 * random_.normal() - saw_tooth * since + step;
      told += alarm.add(rate * 1e-6) ? 1 : 0;
    }
    return told;
  }
  StepAlarm alarm{10e-6};

private:
  RandomStream random_{10, StreamPurpose::jitter};
  std::int64_t minute_ = 0;
};

TEST(StepAlarmTest, WhatIsDoneEveryWeekIsAHabit) {
  for (const double saw_tooth : {0.3, 1.0, 3.0}) {
    WoundClock clock;
    EXPECT_EQ(clock.hear_days(183.0, saw_tooth, 0.0), 0) << saw_tooth;
    EXPECT_EQ(clock.hear_days(8.0 / 1440.0, saw_tooth, 5.0), 1) << saw_tooth;
    EXPECT_EQ(clock.hear_days(60.0, saw_tooth, 5.0), 0) << saw_tooth; // a second level, not a habit
    EXPECT_EQ(clock.hear_days(8.0 / 1440.0, saw_tooth, 10.0), 1) << saw_tooth;
  }
}

TEST(StepAlarmTest, AJumpThatHasCeasedIsToldWhenItComesAgain) {
  WoundClock clock;
  EXPECT_EQ(clock.hear_days(56.0, 3.0, 0.0), 0);
  EXPECT_EQ(clock.hear_days(100.0, 0.0, 0.0), 0);
  EXPECT_EQ(clock.hear_days(1.0, 0.0, 3.0), 1);
}

TEST(StepAlarmTest, InTheFirstThreeWeeksAStepMayBeAWinding) {
  for (const double step : {14.0, 17.0}) { // 1.5 times 10
    WoundClock clock;
    clock.hear_days(6.0, 0.0, 0.0);
    EXPECT_EQ(clock.hear_days(1.0, 0.0, step), step > 15.0 ? 1 : 0) << step;
  }
}

TEST(StepAlarmTest, GoesOnFromWhatIsLearnt) {
  WoundClock clock;
  clock.hear_days(40.0, 1.0, 0.0);
  Learnt written;
  clock.alarm.pass(written);
  Learnt read(written.numbers());
  StepAlarm alarm;
  alarm.pass(read);
  EXPECT_TRUE(read.is_read_whole());
  RandomStream random(11, StreamPurpose::jitter);
  for (int minute = 0; minute < 20000; ++minute) {
    const double rate = 1e-7 * random.normal() + (minute == 19999 ? 5e-6 : 0.0);
    EXPECT_EQ(clock.alarm.add(rate).has_value(), minute == 19999);
    EXPECT_EQ(alarm.add(rate).has_value(), minute == 19999);
  }
  auto torn = written.numbers();
  torn.pop_back();
  Learnt part(torn);
  alarm.pass(part);
  EXPECT_FALSE(part.is_read_whole());
}

} // namespace
} // namespace goingrate::apps
