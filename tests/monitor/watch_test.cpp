#include "monitor/watched_clock.hpp"
#include "watch_json.hpp"

#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>

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

// A source whose own times begin at second 100, with one line that gives another time.
TEST_F(MonitorWatchTest, OneWrongLineMovesNothing) {
  for (const double wrong : {3140.0, 40.0, 9999999999.5, -5e17, 2147483648e9}) {
    std::filesystem::remove_all(options_.folder);
    ClockWatch watch(options_);
    hear(watch, 0, 40, -100.0);
    hear_event(watch, event_at(Instant::from_seconds(wrong)), 40.0, 40);
    hear(watch, 41, 200, -100.0);
    EXPECT_EQ(watch.going().last()->cycle, 199) << wrong;
    EXPECT_NEAR(watch.going().last()->time - began, 199.0, 0.2) << wrong;
    EXPECT_TRUE(watch.breaks().empty()) << wrong;
  }
}

TEST_F(MonitorWatchTest, HalfALineAfterARestartMovesNothing) {
  {
    ClockWatch watch(options_);
    hear(watch, 0, 40, -5000.0);
  }
  ClockWatch watch(options_);
  hear_event(watch, event_at(Instant::from_seconds(42.0)), 42.0, 42); // the end of 5042.000000
  hear(watch, 43, 100, -5000.0);
  EXPECT_EQ(watch.going().last()->cycle, 99);
  EXPECT_NEAR(watch.going().last()->time - began, 99.0, 0.2);
}

TEST_F(MonitorWatchTest, AFileThatIsReadAgainIsNotStoredAgain) {
  options_.place.source_is_live = false;
  for (const bool is_dated : {false, true}) {
    std::filesystem::remove_all(options_.folder);
    log_.origin = is_dated ? TimeOrigin::epoch : TimeOrigin::none;
    std::vector<Beat> file;
    for (std::int64_t n = 0; n < 700; ++n)
      file.push_back(event_at(is_dated ? began + time_of(n) : Instant::from_seconds(time_of(n))));
    for (const std::size_t lines : {500, 500, 600, 700}) {
      ClockWatch watch(options_);
      for (std::size_t n = 0; n < lines; ++n)
        watch.add(file[n], log_, began + 1000.0);
      watch.end(log_, began + 1000.0);
      EXPECT_EQ(watch.going().last()->cycle, static_cast<std::int64_t>(lines) - 1);
    }
    const Archive archive(options_.folder);
    std::size_t rows = 0;
    for (const std::string& day : archive.days())
      rows += archive.events_of(day).size();
    EXPECT_EQ(rows, 700U) << is_dated;
  }
  log_.origin = TimeOrigin::none;
}

TEST_F(MonitorWatchTest, DatesAreTheSourcesOwn) {
  log_.origin = TimeOrigin::epoch;
  options_.place.source_is_live = false;
  ClockWatch watch(options_);
  for (std::int64_t n = 0; n < 100; ++n)
    watch.add(event_at(began + (time_of(n) - 3e8)), log_, began + time_of(n));
  watch.end(log_, began + 100.0);
  EXPECT_NEAR(watch.going().last()->time - (began + -3e8), 99.0, 0.2);
}

TEST_F(MonitorWatchTest, LinesWrittenBeforeItListenedAreInThePast) {
  ClockWatch watch(options_);
  for (std::int64_t n = 0; n < 12; ++n) // a burst, whose last line is heard as it is written
    watch.add(event_at(Instant::from_seconds(time_of(n))), log_, began + 11.05);
  hear(watch, 12, 60);
  EXPECT_NEAR(watch.going().last()->time - began, 59.0, 0.2);
}

TEST_F(MonitorWatchTest, ASourceThatBeganAgainInBetweenGetsANotedOrigin) {
  {
    ClockWatch watch(options_);
    hear(watch, 0, 100);
  }
  Instant last;
  {
    ClockWatch watch(options_); // the logger began again at 150
    hear(watch, 160, 300, 150.0);
    last = watch.going().last()->time;
    EXPECT_NEAR(last - began, 299.0, 0.2);
  }
  ClockWatch watch(options_); // and goes on
  hear(watch, 310, 320, 150.0);
  EXPECT_NEAR(watch.going().last()->time - last, 20.0, 1e-3);
}

TEST_F(MonitorWatchTest, AComputersClockThatIsSetBackStopsNoSync) {
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

TEST_F(MonitorWatchTest, SilenceIsNotMeasuredByACalendar) {
  ClockWatch watch(options_);
  hear_by_calendar(watch, 0, 100, 0.0);
  watch.idle(log_, {began + 3700.5, 100.5}); // set forward between two beats
  hear_by_calendar(watch, 101, 200, 3600.0);
  EXPECT_TRUE(watch.take_alarm_changes().empty());
  watch.idle(log_, {began + 300.0, 210.0}); // set back, and it has stopped
  EXPECT_EQ(watch.take_alarm_changes().size(), 1U);
}

TEST_F(MonitorWatchTest, ACalendarThatIsSetPlacesTheSourceAnew) {
  ClockWatch watch(options_);
  hear_by_calendar(watch, 0, 100, 0.0);
  hear_by_calendar(watch, 100, 200, 10800.0); // NTP tells the time to a computer that had none
  EXPECT_NEAR(watch.going().last()->time - began, 199.0 + 10800.0, 0.1); // heard at once
  EXPECT_EQ(watch.going().last()->cycle, 199); // the source itself went on
}

// Of dates of a receiver that does not know the year yet.
TEST_F(MonitorWatchTest, DatesThatAreFarFromTheComputersAreKeptAsComments) {
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

TEST_F(MonitorWatchTest, BlocksBeginAnewWhereDatesFallBack) {
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

// Killed while they wait for a third one.
TEST_F(MonitorWatchTest, EventsBehindAGapAreOnDiskAtOnce) {
  for (const double amplitude_rad : {std::nan(""), 0.03}) {
    std::filesystem::remove_all(options_.folder);
    const auto heard = [&](std::int64_t n) {
      return event_at(Instant::from_seconds(time_of(n)), Edge::up, 0, amplitude_rad);
    };
    {
      ClockWatch watch(options_);
      hear(watch, 0, 100);
      hear_event(watch, heard(300), 300.0, 300);
      hear_event(watch, heard(301), 301.0, 301);
      watch.idle(log_, began + 302.5);
      EXPECT_EQ(watch.going().last()->cycle, 99);
    }
    const auto notes = [&] {
      std::ifstream day(options_.folder + "/" + day_of(began) + ".csv");
      int count = 0;
      for (std::string line; std::getline(day, line);)
        count += line.starts_with("# waits for others") ? 1 : 0;
      return count;
    };
    EXPECT_EQ(notes(), 2);
    ClockWatch watch(options_);
    hear(watch, 302, 320);
    watch.end(log_, began + 321.0);
    EXPECT_EQ(watch.going().last()->cycle, 319);
    EXPECT_EQ(notes(), 2);
    std::ifstream day(options_.folder + "/" + day_of(began) + ".csv");
    int rows = 0;
    for (std::string line; std::getline(day, line);)
      rows += std::isdigit(static_cast<unsigned char>(line[0])) != 0 ? 1 : 0;
    EXPECT_EQ(rows, 100 + 20);
  }
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

// Of a source that says nothing of its layout, killed before there were lines enough.
TEST_F(MonitorWatchTest, LinesThatAreNotRecognisedYetOutliveAKill) {
  const std::string first = "0.000000\n1.000020\n", more = "2.000040\n3.0000";
  {
    ClockWatch watch(options_);
    EXPECT_EQ(watch.unread(), "");
    watch.hold(first, began);
    watch.hold(first + more, began + 2.0);
    watch.idle(log_, began + 2.1); // no event yet: nothing is cleared
  }
  ClockWatch watch(options_);
  EXPECT_EQ(watch.unread(), first + "2.000040\n"); // whole lines
  hear(watch, 0, 20);
  EXPECT_EQ(watch.unread(), "");
}

TEST_F(MonitorWatchTest, ALoggerThatTellsTheSameTimesAgainIsHeard) {
  for (const std::int64_t start : {0, 200}) {
    ClockWatch watch(options_);
    watch.hold("# goingrate log: 1\n", began + static_cast<double>(start));
    for (std::int64_t n = 0; n < 100; ++n) // a logger that is switched on counts from 0
      hear_event(watch, event_at({n, 0.0}), static_cast<double>(start + n), n);
    watch.end(log_, began + static_cast<double>(start + 101));
    EXPECT_EQ(watch.heard(), 100);
  }
  std::size_t rows = 0;
  const Archive archive(options_.folder);
  for (const std::string& day : archive.days())
    rows += archive.events_of(day).size();
  EXPECT_EQ(rows, 200U);
}

TEST_F(MonitorWatchTest, LinesThatAreStoredAlreadyAreNotStoredAgain) {
  std::vector<double> times;
  for (std::int64_t n = 0; n < 100; ++n)
    times.push_back(time_of(n));
  const auto hear_these = [&](ClockWatch& watch, std::size_t from, std::size_t to) {
    for (std::size_t n = from; n < to; ++n)
      watch.add(event_at(Instant::from_seconds(times[n])), log_,
                began + times[std::max<std::size_t>(n, 4)]); // the first five at once
  };
  {
    ClockWatch watch(options_);
    watch.hold("0\n1\n2\n", began);
    hear_these(watch, 0, 8);
  } // killed before it was idle: the lines are still there
  {
    ClockWatch watch(options_);
    EXPECT_FALSE(watch.unread().empty());
    hear_these(watch, 0, 100); // three lines that were held, and what the pipe still had
    watch.end(log_, began + 100.0);
    EXPECT_EQ(watch.going().last()->cycle, 99);
    EXPECT_TRUE(watch.unread().empty());
  }
  EXPECT_EQ(Archive(options_.folder).events_of(day_of(began)).size(), 100U);
}

} // namespace
} // namespace goingrate::apps
