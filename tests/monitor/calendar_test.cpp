#include "monitor/watched_clock.hpp"

#include <filesystem>
#include <fstream>

namespace goingrate::apps {
namespace {

using MonitorCalendarTest = WatchedClockTest;

TEST_F(MonitorCalendarTest, DatesAreTheSourcesOwn) {
  log_.origin = TimeOrigin::epoch;
  options_.place.source_is_live = false;
  ClockWatch watch(options_);
  for (std::int64_t n = 0; n < 100; ++n)
    watch.add(event_at(began + (time_of(n) - 3e8)), log_, began + time_of(n));
  watch.end(log_, began + 100.0);
  EXPECT_NEAR(watch.going().last()->time - (began + -3e8), 99.0, 0.2);
}

TEST_F(MonitorCalendarTest, AComputersClockThatIsSetBackStopsNoSync) {
  ClockWatch watch(options_);
  hear(watch, 0, 100);
  for (std::int64_t n = 100; n < 110; ++n) {
    const double at = time_of(n);
    watch.add(event_at(Instant::from_seconds(at)), log_,
              {began + (at - 1800.0), began.to_double() + at});
    watch.idle(log_, {began + (at - 1799.5), began.to_double() + at + 0.5});
  }
  EXPECT_GE(watch.acknowledged(), 108);
}

TEST_F(MonitorCalendarTest, SilenceIsNotMeasuredByACalendar) {
  ClockWatch watch(options_);
  hear_by_calendar(watch, 0, 100, 0.0);
  watch.idle(log_, {began + 3700.5, 100.5}); // set forward between two beats
  hear_by_calendar(watch, 101, 200, 3600.0);
  EXPECT_TRUE(watch.take_alarm_changes().empty());
  watch.idle(log_, {began + 300.0, 210.0}); // set back, and it has stopped
  EXPECT_EQ(watch.take_alarm_changes().size(), 1U);
}

TEST_F(MonitorCalendarTest, ACalendarThatIsSetPlacesTheSourceAnew) {
  ClockWatch watch(options_);
  hear_by_calendar(watch, 0, 100, 0.0);
  hear_by_calendar(watch, 100, 200, 10800.0); // NTP tells the time to a computer that had none
  EXPECT_NEAR(watch.going().last()->time - began, 199.0 + 10800.0, 0.1); // heard at once
  EXPECT_EQ(watch.going().last()->cycle, 199); // the source itself went on
}

// Dates from a receiver that does not know the year yet.
TEST_F(MonitorCalendarTest, DatesThatAreFarFromTheComputersAreKeptAsComments) {
  log_.origin = TimeOrigin::epoch;
  ClockWatch watch(options_);
  const auto hear_dated = [&](std::int64_t from, std::int64_t to, double error_s) {
    for (std::int64_t n = from; n < to; ++n) {
      watch.add(event_at(began + (time_of(n) + error_s)), log_, began + (time_of(n) + 0.05));
      watch.idle(log_, began + (time_of(n) + 0.15));
    }
  };
  hear_dated(0, 200, 0.0);
  EXPECT_TRUE(watch.take_alarm_changes().empty());
  hear_dated(200, 203, 3.3e8);
  const auto raised = watch.take_alarm_changes();
  ASSERT_EQ(raised.size(), 1U);
  EXPECT_EQ(raised[0].kind, AlarmKind::sensor_failing);
  hear_dated(203, 1500, 0.0);
  EXPECT_EQ(watch.going().last()->cycle, 1499);
  EXPECT_GE(watch.going().minutes().all().size(), 25U);
  EXPECT_EQ(watch.take_alarm_changes().size(), 1U); // over
  watch.idle(log_, began + 1502.0);
  EXPECT_EQ(watch.acknowledged() + 3, watch.heard());
  EXPECT_FALSE(std::filesystem::exists(options_.folder + "/" + day_of(began + 3.3e8) + ".csv"));
  int comments = 0;
  std::ifstream day(options_.folder + "/" + day_of(began) + ".csv");
  for (std::string line; std::getline(day, line);)
    comments += line.starts_with("# left out, its date is +330000000 s from") ? 1 : 0;
  EXPECT_EQ(comments, 3);
  log_.origin = TimeOrigin::none;
}

TEST_F(MonitorCalendarTest, BlocksBeginAnewWhereDatesFallBack) {
  Going going;
  std::int64_t cycle = 0;
  const auto hear_from = [&](std::int64_t start, std::int64_t beats) {
    for (std::int64_t n = 0; n < beats; ++n) {
      Beat beat = event_at({1764201600 + start + n, 0.0});
      beat.cycle = cycle++;
      going.add(beat, 0);
    }
  };
  hear_from(0, 300);
  hear_from(330'000'000, 4);
  going.break_count();
  hear_from(310, 600);
  EXPECT_EQ(going.minutes().all().back().start_s, 1764201600 + 900);
  EXPECT_EQ(going.minutes().all().size(), 16U);
  EXPECT_TRUE(going.minutes().rate_over(5, 1.0));
  EXPECT_EQ(going.days().all().back().start_s, 1764201600 - 1764201600 % 86400);
}

} // namespace
} // namespace goingrate::apps
