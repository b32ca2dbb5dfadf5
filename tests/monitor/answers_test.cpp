#include "monitor/watched_clock.hpp"
#include "watch_json.hpp"

#include <nlohmann/json.hpp>

namespace goingrate::apps {
namespace {

using MonitorAnswersTest = WatchedClockTest;

TEST_F(MonitorAnswersTest, LongAnswersAreMadeOnceAMinute) {
  ClockWatch watch(options_);
  hear(watch, 0, 610);
  WatchAnswering answering("x");
  const std::string before = answering.at(began + 610.0, watch).minutes;
  hear(watch, 610, 620);
  EXPECT_EQ(answering.at(began + 620.0, watch).minutes, before);
  EXPECT_NE(answering.at(began + 670.0, watch).minutes, before); // a minute old
  hear(watch, 620, 665);
  EXPECT_NE(answering.at(began + 665.0, watch).minutes.find("[1764202260,"), std::string::npos);
}

// Rates are those of the time before now, whenever the last beat was.
TEST_F(MonitorAnswersTest, RatesOfAStoppedClockArePast) {
  ClockWatch watch(options_);
  hear(watch, 0, 7260);
  const auto rates = [&](double at) {
    watch.idle(log_, began + at);
    WatchAnswering answering("x");
    const auto now = nlohmann::json::parse(answering.at(began + at, watch).now);
    return std::pair(!now["rate"]["ten_minutes"].is_null(), !now["rate"]["hour"].is_null());
  };
  EXPECT_EQ(rates(7261.0), std::pair(true, true));
  EXPECT_EQ(rates(7261.0 + 900.0), std::pair(false, true));
  EXPECT_EQ(rates(7261.0 + 3700.0), std::pair(false, false));
  hear(watch, 11000, 11130);
  EXPECT_EQ(rates(11130.0), std::pair(false, false)); // of two minutes
}

TEST_F(MonitorAnswersTest, AnswersAreJsonAndMetrics) {
  ClockWatch watch(options_);
  hear(watch, 0, 1000);
  WatchAnswering answering("the \"Hall\" <clock>\xff");
  const WatchAnswers& answers = answering.at(began + 1000.0, watch);
  for (const std::string* text : {&answers.now, &answers.minutes, &answers.hours, &answers.days,
                                  &answers.alarms, &answers.breaks})
    EXPECT_TRUE(nlohmann::json::accept(*text)) << *text;
  EXPECT_NE(answers.metrics.find("goingrate_beats_total 1000"), std::string::npos);
  EXPECT_NE(answers.metrics.find("goingrate_alarm{kind=\"stopped\"} 0"), std::string::npos);
}

} // namespace
} // namespace goingrate::apps
