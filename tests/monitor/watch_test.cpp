#include "monitor/watched_clock.hpp"
#include "watch_json.hpp"

#include <filesystem>
#include <fstream>
#include <numbers>

namespace goingrate::apps {
namespace {

using MonitorWatchTest = WatchedClockTest;

TEST_F(MonitorWatchTest, TellsTheRate) {
  ClockWatch watch(options_);
  hear(watch, 0, 8000);
  const auto rate = watch.going().minutes().rate_over(60, period_s);
  ASSERT_TRUE(rate);
  EXPECT_NEAR(rate->value, 20e-6, 4.0 * rate->sigma);
  EXPECT_LT(rate->sigma, 1e-7); // 1.4e-5 s over sixty minutes is 4e-9
  EXPECT_EQ(watch.heard(), 8000);
  EXPECT_EQ(watch.acknowledged(), 8000);
}

// The last beat of every second minute is missed, and an event beside it taken for it.
TEST_F(MonitorWatchTest, AWrongBeatIsNoRate) {
  Going going;
  for (std::int64_t n = 0; n < 600; ++n) {
    Beat beat = event_at({1764201600 + n, n % 120 == 59 ? 0.1 : 0.0});
    beat.cycle = n;
    going.add(beat, 0);
  }
  for (std::size_t i = 1; i + 1 < going.minutes().all().size(); ++i)
    EXPECT_NEAR(*going.minutes().rate_of(i, 1.0), 0.0, 1e-15) << i;
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

TEST_F(MonitorWatchTest, DirectionsAreToldFromTimes) {
  options_.log.both_edges = true;
  options_.log.nominal_period_s = period_s;
  const auto hear_both = [&](ClockWatch& watch, int from, int to) { // in half-periods
    for (int n = from; n < to; ++n) {
      const double at = 0.5 * n + (n % 2 != 0 ? 0.01 : 0.0);
      hear_event(watch, event_at(Instant::from_seconds(at)), at, n);
    }
    watch.idle(log_, began + (0.5 * to + 0.1));
  };
  {
    ClockWatch watch(options_);
    hear_both(watch, 0, 1200);
    EXPECT_EQ(watch.going().last()->cycle, 599);
    EXPECT_NEAR(*watch.going().minutes().all().front().beat_error_s(), 0.02, 1e-6);
  }
  ClockWatch watch(options_);
  hear_both(watch, 1301, 1500); // the first one is downward
  EXPECT_EQ(watch.going().last()->cycle, 749);
  EXPECT_NEAR(*watch.going().minutes().all().back().beat_error_s(), 0.02, 1e-6);
}

// A period that the source told, and no rounded mean would be.
TEST_F(MonitorWatchTest, ThePeriodThatWasToldOutlivesARestart) {
  log_.nominal_period_s = 1.001;
  {
    ClockWatch watch(options_);
    hear(watch, 0, 300);
    EXPECT_EQ(watch.nominal_period_s(), 1.001);
  }
  const ClockWatch watch(options_);
  EXPECT_EQ(watch.nominal_period_s(), 1.001);
  EXPECT_TRUE(watch.assumptions().empty());
}

// Both directions without labels and without a period, out of beat and in beat; and with one.
TEST_F(MonitorWatchTest, WhatIsAssumedIsSaid) {
  const auto said = [&](double beat_error_s) {
    std::filesystem::remove_all(options_.folder);
    ClockWatch watch(options_);
    for (std::int64_t n = 0; n < 120; ++n) {
      const double at = 0.5 * time_of(n) + (n % 2 == 0 ? 0.0 : 0.5 * beat_error_s);
      hear_event(watch, event_at(Instant::from_seconds(at)), at, n);
    }
    watch.idle(log_, began + 61.0);
    std::string words;
    for (const Assumption& assumption : watch.assumptions())
      words += assumption.text + "\n";
    return words;
  };
  EXPECT_EQ(said(0.0), "");
  log_.nominal_period_s.reset();
  EXPECT_EQ(said(0.0), "nominal period 0.5 s, the mean period 0.499990 s rounded (see "
                       "--nominal-period)\n"
                       "every event is a crossing in the same direction; if every other one is in "
                       "the other, the period is twice that (see --both-edges)\n");
  EXPECT_NE(said(0.02).find("intervals alternate, as those between both do (see --both-edges)"),
            std::string::npos);
}

TEST_F(MonitorWatchTest, WidthsOfAFlagGiveAmplitudes) {
  options_.log.flag_width_rad = 0.002;
  options_.log.nominal_period_s = period_s;
  {
    ClockWatch watch(options_);
    for (int n = 0; n < 200; ++n) {
      EventValues values;
      values.width_s = 0.002 / (0.03 * 2.0 * std::numbers::pi); // of small swings of 30 mrad
      watch.add({event_at({n, 0.0}), values}, log_, began + n);
    }
    watch.idle(log_, began + 201.0);
    ASSERT_TRUE(watch.going().minutes().all().front().amplitude_rad());
    EXPECT_NEAR(*watch.going().minutes().all().front().amplitude_rad(), 0.03, 1e-5); // of 3e-4
  }
  EXPECT_NEAR(*ClockWatch(options_).going().minutes().all().front().amplitude_rad(), 0.03, 1e-5);
}

// Ten times as long as the beats that judge a single one.
TEST_F(MonitorWatchTest, ALongAbsenceIsCounted) {
  {
    ClockWatch watch(options_);
    hear(watch, 0, 20000);
  }
  ClockWatch watch(options_);
  hear(watch, 27000, 27040);
  EXPECT_EQ(watch.going().last()->cycle, 27039);
  ASSERT_EQ(watch.breaks().size(), 1U);
  EXPECT_EQ(watch.breaks()[0].missing, 7000);
  EXPECT_GT(watch.breaks()[0].probability, 0.99);
  EXPECT_NEAR(watch.going().first_of_run()->time - began, 0.0, 1.0);
}

TEST_F(MonitorWatchTest, ALoggerThatBeginsAgainKeepsItsPlaceInTime) {
  ClockWatch watch(options_);
  hear(watch, 0, 1000);
  hear(watch, 1100, 2000, 1095.0); // it counts from 0 again
  const Instant last = watch.going().last()->time;
  EXPECT_NEAR(last - began, 1999.0, 0.2); // its beats are heard 0.05 s late
  EXPECT_NEAR(static_cast<double>(watch.going().last()->cycle), 1999.0, 0.5);
}

TEST_F(MonitorWatchTest, WithoutItsIndexItSaysTheSame) {
  {
    ClockWatch watch(options_);
    hear_at_once(watch, 200000); // more than two days
  }
  const auto told = [&] {
    const ClockWatch watch(options_);
    WatchAnswering answering("x");
    const WatchAnswers& answers = answering.at(began, watch);
    return answers.hours + answers.days;
  };
  const std::string with = told();
  std::filesystem::remove(options_.folder + "/.index.sqlite");
  EXPECT_EQ(told(), with);
}

TEST_F(MonitorWatchTest, TheErrorIsCountedFromTheSameBeatAfterARestart) {
  options_.place.start = began;
  double before = 0.0;
  {
    ClockWatch watch(options_);
    hear_at_once(watch, 17 * 86400);
    before = *watch.going().deviation_s(period_s);
    EXPECT_NEAR(before, 17.0 * 86400.0 * 20e-6, 1e-2);
  }
  const ClockWatch watch(options_);
  EXPECT_NEAR(*watch.going().deviation_s(period_s), before, 1e-3); // jitter of a beat
  EXPECT_NEAR(watch.going().first_of_run()->time - began, 0.0, 1.0);
}

// A step of 5 ppm is told of a clock that is known, not in its first weeks.
TEST_F(MonitorWatchTest, WhatAlarmsHaveLearntOutlivesARestart) {
  options_.place.start = began;
  constexpr std::int64_t beats = 25 * 86400;
  {
    ClockWatch watch(options_);
    hear_at_once(watch, beats);
  }
  const std::string without_index = options_.folder + "-copy";
  std::filesystem::remove_all(without_index);
  std::filesystem::copy(options_.folder, without_index);
  std::filesystem::remove(without_index + "/.index.sqlite");
  for (const std::string& folder : {options_.folder, without_index}) {
    WatchOptions options = options_;
    options.folder = folder;
    ClockWatch watch(options);
    const double end = time_of(beats);
    for (std::int64_t n = 0; n < 1200; ++n)
      hear_event(watch,
                 event_at(Instant::from_seconds(end + static_cast<double>(n) / (1.0 + 25e-6))),
                 end + static_cast<double>(n), n);
    int told = 0;
    for (const AlarmChange& change : watch.take_alarm_changes())
      told += change.kind == AlarmKind::rate_step && change.is_raised ? 1 : 0;
    EXPECT_EQ(told, 1) << folder;
  }
  std::filesystem::remove_all(without_index);
}

TEST_F(MonitorWatchTest, ADayWithoutABeatBreaksNoIndex) {
  log_.origin = TimeOrigin::epoch;
  options_.place.source_is_live = false;
  const auto hear_day = [&](ClockWatch& watch, std::int64_t day) {
    for (std::int64_t n = 0; n < 1000; ++n)
      watch.add(event_at(began + static_cast<double>(86400 * day + n)), log_, began + 1e7);
  };
  {
    ClockWatch watch(options_);
    watch.note("nothing yet", began + -86400.0);
    for (const std::int64_t day : {0, 1, 2, 10, 11, 12, 13, 14})
      hear_day(watch, day);
    watch.end(log_, began + 1e7);
  }
  std::ofstream(options_.folder + "/" + day_of(began + 5.0 * 86400.0) + ".csv") << "# silent\n";
  const auto days_of_index = [&] { return ArchiveIndex(options_.folder).days().size(); };
  EXPECT_EQ(ClockWatch(options_).going().beats(), 8000);
  EXPECT_EQ(days_of_index(), 9U); // all but the last: eight with beats, two without
  log_.origin = TimeOrigin::none;
}

TEST_F(MonitorWatchTest, AnIndexOfOtherFilesIsNotBelieved) {
  options_.place.start = began;
  {
    ClockWatch watch(options_);
    hear_at_once(watch, 200000);
  }
  const auto beats = [&] { return ClockWatch(options_).going().beats(); };
  EXPECT_EQ(beats(), 200000);
  {
    std::ofstream day(options_.folder + "/" + day_of(began) + ".csv", std::ios::app);
    day << "# a comment of a person\n";
  }
  EXPECT_FALSE(ArchiveIndex(options_.folder).is_of_the_files());
  EXPECT_EQ(beats(), 200000); // made again
  EXPECT_TRUE(ArchiveIndex(options_.folder).is_of_the_files());
}

TEST_F(MonitorWatchTest, AlarmsOutliveARestartAndTheIndex) {
  const auto stopped = [](const ClockWatch& watch) {
    return !watch.alarms().raised().empty() &&
           watch.alarms().raised()[0].kind == AlarmKind::stopped;
  };
  {
    ClockWatch watch(options_);
    hear(watch, 0, 100);
    watch.idle(log_, began + 120.0);
    EXPECT_TRUE(stopped(watch));
  }
  std::filesystem::remove(options_.folder + "/.index.sqlite");
  ClockWatch watch(options_);
  ASSERT_EQ(watch.alarm_records().size(), 1U); // read from the day's comments
  EXPECT_EQ(watch.alarm_records()[0].text, "no beat for 21 s: has the clock stopped?");
  EXPECT_NEAR(watch.alarm_records()[0].at_s, began.to_double() + 120.0, 1e-3);
  EXPECT_TRUE(stopped(watch));
  hear(watch, 200, 210);
  EXPECT_FALSE(stopped(watch));
}

TEST_F(MonitorWatchTest, AClockThatIsSilentFromTheBeginningIsCalledStopped) {
  {
    ClockWatch watch(options_);
    hear(watch, 0, 100);
  }
  ClockWatch watch(options_);
  watch.idle(log_, began + 200.0);
  EXPECT_TRUE(watch.take_alarm_changes().empty());
  watch.idle(log_, began + 206.0);
  EXPECT_EQ(watch.take_alarm_changes().size(), 1U);
}

} // namespace
} // namespace goingrate::apps
