#include "clock_watch.hpp"
#include "watch_json.hpp"

#include "goingrate/base/random.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace goingrate::apps {
namespace {

constexpr double period_s = 1.0;
constexpr Instant began{1764201600, 0.0};

class MonitorWatchTest : public testing::Test {
protected:
  void SetUp() override {
    options_.folder = testing::TempDir() + "watch-" +
                      testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(options_.folder);
    log_.nominal_period_s = period_s;
  }
  void TearDown() override { std::filesystem::remove_all(options_.folder); }

  // Beats `from` … `to` of a clock that gains 20 ppm, each heard a little later; source time counts
  // from `source_zero` seconds after `began`.
  void hear(ClockWatch& watch, std::int64_t from, std::int64_t to, double source_zero = 0.0) {
    for (std::int64_t n = from; n < to; ++n) {
      const double at = time_of(n);
      const Instant now = began + (at + 0.05);
      watch.add(event_at(Instant::from_seconds(at - source_zero)), log_, now);
      if (n % 10 == 0) watch.idle(log_, now + 0.1);
    }
    watch.idle(log_, began + (static_cast<double>(to) + 0.1));
  }
  // The same all at once, as from a file.
  void hear_at_once(ClockWatch& watch, std::int64_t beats) {
    const Instant now = began + static_cast<double>(beats);
    watch.add(event_at(Instant::from_seconds(time_of(0))), log_, began);
    for (std::int64_t n = 1; n < beats; ++n)
      watch.add(event_at(Instant::from_seconds(time_of(n))), log_, now);
    watch.idle(log_, now + 1.0);
  }
  double time_of(std::int64_t beat) {
    return static_cast<double>(beat) * period_s / (1.0 + 20e-6) + 1e-5 * random_.normal();
  }

  WatchOptions options_;
  ClockLog log_;
  RandomStream random_{1, StreamPurpose::jitter};
};

TEST_F(MonitorWatchTest, TellsTheRate) {
  ClockWatch watch(options_);
  hear(watch, 0, 8000);
  const auto rate = watch.going().minutes().rate_over(60, period_s);
  ASSERT_TRUE(rate);
  EXPECT_NEAR(rate->value, 20e-6, 4.0 * rate->sigma);
  EXPECT_LT(rate->sigma, 1e-7); // 1.4e-5 s over sixty minutes, and some
  EXPECT_EQ(watch.heard(), 8000);
  EXPECT_EQ(watch.acknowledged(), 8000);
}

TEST_F(MonitorWatchTest, TheCountIsCarriedOverABreakOfTheMonitor) {
  {
    ClockWatch watch(options_);
    hear(watch, 0, 3000);
    EXPECT_EQ(watch.going().last()->cycle, 2999);
  } // as after kill -9: nothing is written at the end
  ClockWatch watch(options_);
  EXPECT_EQ(watch.going().last()->cycle, 2999);
  hear(watch, 3500, 5000);
  EXPECT_EQ(watch.going().last()->cycle, 4999);
  ASSERT_EQ(watch.breaks().size(), 1U);
  EXPECT_EQ(watch.breaks()[0].missing, 500);
  EXPECT_GT(watch.breaks()[0].probability, 0.99);
}

TEST_F(MonitorWatchTest, ALoggerThatBeginsAgainKeepsItsPlaceInTime) {
  ClockWatch watch(options_);
  hear(watch, 0, 1000);
  hear(watch, 1100, 2000, 1095.0); // it counts from 0 again
  const Instant last = watch.going().last()->time;
  EXPECT_NEAR(last - began, 1999.0, 0.2); // what its beats are heard too late
  EXPECT_NEAR(static_cast<double>(watch.going().last()->cycle), 1999.0, 0.5);
}

TEST_F(MonitorWatchTest, WithoutItsIndexItSaysTheSame) {
  {
    ClockWatch watch(options_);
    hear_at_once(watch, 200000); // more than two days
  }
  const auto told = [&] {
    const ClockWatch watch(options_);
    return answers_of(watch, "x", began).hours + answers_of(watch, "x", began).days;
  };
  const std::string with = told();
  std::filesystem::remove(options_.folder + "/.index.sqlite");
  EXPECT_EQ(told(), with);
}

TEST_F(MonitorWatchTest, ASilentClockIsCalledStopped) {
  ClockWatch watch(options_);
  hear(watch, 0, 100);
  const Instant end = began + 100.0;
  watch.idle(log_, end + 4.0); // less than five periods
  EXPECT_TRUE(watch.take_alarm_changes().empty());
  watch.idle(log_, end + 6.0);
  const auto raised = watch.take_alarm_changes();
  ASSERT_EQ(raised.size(), 1U);
  EXPECT_EQ(raised[0].kind, AlarmKind::stopped);
  watch.idle(log_, end + 60.0);
  EXPECT_TRUE(watch.take_alarm_changes().empty()); // once
  hear(watch, 200, 300);
  const auto over = watch.take_alarm_changes();
  ASSERT_EQ(over.size(), 1U);
  EXPECT_FALSE(over[0].is_raised);
}

TEST_F(MonitorWatchTest, AnswersAreJsonAndMetrics) {
  ClockWatch watch(options_);
  hear(watch, 0, 1000);
  const auto answers = answers_of(watch, "the \"Hall\" <clock>\xff", began + 1000.0);
  for (const std::string* text : {&answers.now, &answers.minutes, &answers.hours, &answers.days,
                                  &answers.alarms, &answers.breaks})
    EXPECT_TRUE(nlohmann::json::accept(*text)) << *text;
  EXPECT_NE(answers.metrics.find("goingrate_beats_total 1000"), std::string::npos);
  EXPECT_NE(answers.metrics.find("goingrate_alarm{kind=\"stopped\"} 0"), std::string::npos);
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
  // Of 4 minutes a mean is 3 against 0.53 of their difference: 5.7, about the limit of that scale.
  EXPECT_LE(delay, 24);
  EXPECT_NEAR(found->size, 3.0, 3.0);
  EXPECT_TRUE(alarm.is_raised());
  for (int minute = 0; minute < 2000; ++minute)
    EXPECT_FALSE(alarm.add(random.normal() + 3.0)) << minute;
  EXPECT_FALSE(alarm.is_raised());
}

} // namespace
} // namespace goingrate::apps
