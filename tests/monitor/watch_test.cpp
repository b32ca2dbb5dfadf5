#include "monitor/watched_clock.hpp"
#include "watch_json.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace goingrate::apps {
namespace {

using MonitorWatchTest = WatchedClockTest;

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

} // namespace
} // namespace goingrate::apps
