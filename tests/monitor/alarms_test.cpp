#include "alarm_commands.hpp"
#include "monitor/full_disk.hpp"
#include "monitor/watched_clock.hpp"

#include <fstream>
#include <sqlite3.h>
#include <thread>

namespace goingrate::apps {
namespace {

class MonitorAlarmsTest : public WatchedClockTest {
protected:
  // How often an alarm of a kind was raised and ended since the last call.
  struct Count {
    int raised = 0, ended = 0;
    bool operator==(const Count&) const = default;
  };
  static Count count(ClockWatch& watch, AlarmKind kind) {
    Count count;
    for (const AlarmChange& change : watch.take_alarm_changes()) {
      EXPECT_EQ(name_of(change.kind), name_of(kind)) << change.text;
      ++(change.is_raised ? count.raised : count.ended);
    }
    return count;
  }
  static constexpr Count begins{1, 0}, ends{0, 1}, silent{0, 0}, once{1, 1};
};

TEST_F(MonitorAlarmsTest, ASilentClockIsCalledStopped) {
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

TEST_F(MonitorAlarmsTest, AClockOutOfBeat) {
  ClockWatch watch(options_);
  std::int64_t n = 0;
  const auto hear_minutes = [&](int minutes, double tick_less_tock_s) {
    for (const std::int64_t end = n + minutes * 60; n < end; ++n) {
      const double at = time_of(n), down = at + 0.5 * period_s + 0.5 * tick_less_tock_s;
      hear_event(watch, event_at(Instant::from_seconds(at)), at, n);
      hear_event(watch, event_at(Instant::from_seconds(down), Edge::down), down, n);
    }
    return count(watch, AlarmKind::out_of_beat);
  };
  EXPECT_EQ(hear_minutes(60, 0.0), silent);
  EXPECT_EQ(hear_minutes(30, 0.015), silent); // 1.5 %
  EXPECT_EQ(hear_minutes(30, -0.025), begins);
  EXPECT_EQ(hear_minutes(30, -0.015), silent); // between its two limits
  hear(watch, n, n + 1800);                    // tocks are not heard: nothing is known of the beat
  n += 1800;
  EXPECT_EQ(count(watch, AlarmKind::out_of_beat), silent);
  EXPECT_EQ(hear_minutes(30, 0.005), ends);
}

TEST_F(MonitorAlarmsTest, ABeatNowAndThenIsNoClockThatGoes) {
  options_.patience_s = 3.0;
  ClockWatch watch(options_);
  hear(watch, 0, 50);
  for (std::int64_t n = 54; n < 100; n += 4) {
    watch.idle(log_, began + (time_of(n) - 0.5));
    hear_event(watch, event_at(Instant::from_seconds(time_of(n))), time_of(n), n);
  }
  int changes = 0;
  for (const AlarmChange& change : watch.take_alarm_changes())
    changes += change.kind == AlarmKind::stopped ? 1 : 0;
  EXPECT_EQ(changes, 1);
}

// What a sensor hears of a clock that has stopped is not a beat.
TEST_F(MonitorAlarmsTest, ASensorThatChattersHidesNoStop) {
  for (const bool is_stuck : {false, true}) {
    std::filesystem::remove_all(options_.folder);
    ClockWatch watch(options_);
    hear(watch, 0, 1000);
    int stopped = 0, failing = 0;
    double at = 1000.0;
    for (double next = at; at < 1120.0; at += 0.1) { // an event every 0.7 s on average
      for (; next < at; next += -0.7 * std::log(random_.uniform()))
        watch.add(event_at(Instant::from_seconds(is_stuck ? 1000.0 : next)), log_, began + next);
      watch.idle(log_, began + at);
      for (const AlarmChange& change : watch.take_alarm_changes()) {
        stopped += change.kind == AlarmKind::stopped ? 1 : 0;
        failing += change.kind == AlarmKind::sensor_failing ? 1 : 0;
        EXPECT_TRUE(change.kind != AlarmKind::stopped || at < 1030.0) << is_stuck;
      }
    }
    EXPECT_EQ(stopped, 1) << is_stuck;
    EXPECT_EQ(failing, 1) << is_stuck;
  }
}

// A sensor that tells every beat twice, the second time a while later, is called out, and no step.
TEST_F(MonitorAlarmsTest, ASensorThatFailsTellsNoSteps) {
  Going going;
  Alarms alarms(0.0);
  std::int64_t cycle = 0;
  for (int minute = 0; minute < 1200; ++minute) {
    const bool doubles = minute >= 600 && minute < 900;
    for (int n = 0; n < 60; ++n, ++cycle) {
      const double late = doubles && (minute % 7 < 3) ? 0.05 : 1e-5 * random_.normal();
      Beat beat = event_at(began + (static_cast<double>(cycle) + late));
      beat.cycle = cycle;
      going.add(beat, 0);
      alarms.heard(going, 1.0, false);
      if (doubles) going.add_spurious();
    }
  }
  int failing = 0;
  for (const AlarmChange& change : alarms.take_changes()) {
    EXPECT_EQ(change.kind, AlarmKind::sensor_failing) << change.text;
    ++failing;
  }
  EXPECT_EQ(failing, 2); // raised and over
}

// Nor is a clock out of beat of which a sensor tells every fourth event falsely, and tocks late:
// not while it fails, not before it is called failing, not after.
TEST_F(MonitorAlarmsTest, ASensorThatFailsTellsNoBeatError) {
  for (const int one_in : {4, 8}) {
    Going going;
    Alarms alarms(0.0);
    std::int64_t cycle = 0;
    for (int minute = 0; minute < 1200; ++minute) {
      const bool fails = minute >= 600 && minute < 900;
      for (int n = 0; n < 60; ++n, ++cycle) {
        const auto add = [&](double at, BeatFlag flag) {
          Beat beat = event_at(began + (static_cast<double>(cycle) + at));
          beat.cycle = cycle;
          beat.flag = flag;
          going.add(beat, 0);
        };
        add(1e-5 * random_.normal(), BeatFlag::good);
        alarms.heard(going, 1.0, false);
        add(fails ? 0.6 : 0.5, BeatFlag::down);
        if (fails && n % one_in == 0) going.add_spurious();
      }
    }
    int failing = 0;
    for (const AlarmChange& change : alarms.take_changes()) {
      EXPECT_EQ(change.kind, AlarmKind::sensor_failing) << change.text;
      ++failing;
    }
    EXPECT_EQ(failing, 2) << one_in; // raised and over
  }
}

TEST_F(MonitorAlarmsTest, EventsThatAreNoBeatsOfThePeriodAreToldOf) {
  options_.log.nominal_period_s = 1.5;
  log_.nominal_period_s = 1.5;
  ClockWatch watch(options_);
  for (int n = 0; n < 60; ++n) // both directions of 1.5 s
    hear_event(watch, event_at(Instant::from_seconds(0.75 * n)), 0.75 * n, n);
  watch.idle(log_, began + 45.0);
  EXPECT_EQ(count(watch, AlarmKind::sensor_failing), begins);
}

// As those of a sound card: what was heard in half a minute comes at its end.
TEST_F(MonitorAlarmsTest, LinesInBatchesAreNoStop) {
  options_.lateness_s = 60.0;
  ClockWatch watch(options_);
  for (std::int64_t n = 0; n < 600; ++n) {
    const double told = 15.0 + 30.0 * std::ceil((time_of(n) + 15.0) / 30.0);
    if (n % 30 == 16)
      for (double at = told - 29.0; at < told; at += 1.0)
        watch.idle(log_, began + at);
    watch.add(event_at(Instant::from_seconds(time_of(n))), log_, began + told);
  }
  EXPECT_EQ(count(watch, AlarmKind::stopped), silent);
  watch.idle(log_, began + 645.0 + 64.0);
  EXPECT_EQ(count(watch, AlarmKind::stopped), silent);
  watch.idle(log_, began + 645.0 + 66.0);
  EXPECT_EQ(count(watch, AlarmKind::stopped), begins);
}

// A logger that began again, or was set to another time, is believed after sixteen events.
TEST_F(MonitorAlarmsTest, EventsThatWaitForOthersAreNoStop) {
  for (const double leap_s : {-1000.0, 1000.0, 3600.0}) {
    std::filesystem::remove_all(options_.folder);
    ClockWatch watch(options_);
    hear(watch, 0, 2000);
    for (std::int64_t n = 2000; n < 2050; ++n) {
      watch.idle(log_, began + (static_cast<double>(n) - 0.1));
      hear_event(watch, event_at(Instant::from_seconds(time_of(n) + leap_s)), time_of(n), n);
    }
    EXPECT_EQ(count(watch, AlarmKind::stopped), silent) << leap_s;
    watch.idle(log_, began + 2060.0);
    EXPECT_EQ(count(watch, AlarmKind::stopped), begins) << leap_s;
  }
}

// Twelve lines tell the layout; a source of many lines that tell none is not a clock that goes.
TEST_F(MonitorAlarmsTest, LinesThatAreNotRecognisedYetMayBeBeats) {
  {
    ClockWatch watch(options_);
    hear(watch, 0, 100);
  }
  ClockWatch watch(options_);
  std::string text;
  for (int n = 0; n < 60; ++n) {
    const Instant now = began + (200.0 + n);
    watch.hold(text += "1000.0\n", now);
    for (int tenth = 0; tenth < 10; ++tenth) {
      watch.hold(text, now + 0.1 * tenth);
      watch.idle(log_, now + 0.1 * tenth);
    }
    if (n < 30) {
      EXPECT_EQ(count(watch, AlarmKind::stopped), silent) << n;
    }
  }
  EXPECT_EQ(count(watch, AlarmKind::stopped), begins);
}

TEST_F(MonitorAlarmsTest, ADiskThatIsFullNowAndThenIsToldOnce) {
  ClockWatch watch(options_);
  hear(watch, 0, 50);
  for (std::int64_t n = 50; n < 350; n += 20) {
    {
      const FullDisk disk(0);
      hear(watch, n, n + 10);
    }
    hear(watch, n + 10, n + 20);
  }
  EXPECT_EQ(count(watch, AlarmKind::archive_failing), begins);
}

TEST_F(MonitorAlarmsTest, AnAlarmHasOneCommentWhileItsIndexIsLocked) {
  ClockWatch watch(options_);
  hear(watch, 0, 100);
  sqlite3* reader = nullptr;
  ASSERT_EQ(sqlite3_open((options_.folder + "/.index.sqlite").c_str(), &reader), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(reader, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  for (int tenth = 0; tenth < 20; ++tenth)
    watch.idle(log_, began + (200.0 + 0.1 * tenth));
  sqlite3_close(reader);
  std::ifstream day(options_.folder + "/" + day_of(began) + ".csv");
  int comments = 0;
  for (std::string line; std::getline(day, line);)
    comments += line.starts_with("# alarm begins stopped") ? 1 : 0;
  EXPECT_EQ(comments, 1);
}

TEST_F(MonitorAlarmsTest, ASensorThatFails) {
  ClockWatch watch(options_);
  std::int64_t n = 0;
  // In every hundred beats `missed` are not heard, and `doubled` are heard twice, 0.3 s apart.
  const auto hear_minutes = [&](int minutes, int missed, int doubled) {
    for (const std::int64_t end = n + minutes * 60; n < end; ++n) {
      const double at = time_of(n);
      const auto place = n * 37 % 100;
      if (place >= missed) hear_event(watch, event_at(Instant::from_seconds(at)), at, n);
      if (place >= 100 - doubled)
        hear_event(watch, event_at(Instant::from_seconds(at + 0.3)), at + 0.3, n);
    }
    return count(watch, AlarmKind::sensor_failing);
  };
  EXPECT_EQ(hear_minutes(30, 0, 0), silent);
  EXPECT_EQ(hear_minutes(30, 5, 0), silent);
  EXPECT_EQ(hear_minutes(30, 20, 0), begins);
  EXPECT_EQ(hear_minutes(30, 5, 0), silent);
  EXPECT_EQ(hear_minutes(30, 0, 0), ends);
  EXPECT_EQ(hear_minutes(30, 0, 20), begins);
}

TEST_F(MonitorAlarmsTest, AnAmplitudeThatFalls) {
  ClockWatch watch(options_);
  std::int64_t n = 0;
  const auto hear_hours = [&](int hours, double amplitude_rad) {
    for (const std::int64_t end = n + hours * 3600; n < end; ++n) {
      Beat beat = event_at(Instant::from_seconds(time_of(n)));
      beat.amplitude_rad = amplitude_rad + 1e-4 * random_.normal();
      hear_event(watch, beat, time_of(n), n);
    }
    return count(watch, AlarmKind::amplitude_falling);
  };
  EXPECT_EQ(hear_hours(10, 0.05), silent);
  EXPECT_EQ(hear_hours(1, 0.044), silent); // 12 %, as it may while it is wound
  EXPECT_EQ(hear_hours(10, 0.05), silent);
  EXPECT_EQ(hear_hours(1, 0.041), begins);
  EXPECT_EQ(hear_hours(1, 0.035), silent); // the same fall
  EXPECT_EQ(hear_hours(2, 0.050), ends);
}

TEST_F(MonitorAlarmsTest, ARateThatSteps) {
  ClockWatch watch(options_);
  hear(watch, 0, 36000);
  EXPECT_EQ(count(watch, AlarmKind::rate_step), silent);
  gain_ = 0.0; // 20 ppm; half of it may be the winding of a clock that is not known yet
  for (std::int64_t n = 36000; n < 38000; ++n) {
    const double at = 36000.0 / (1.0 + 20e-6) + static_cast<double>(n - 36000) / (1.0 + gain_) +
                      1e-5 * random_.normal();
    hear_event(watch, event_at(Instant::from_seconds(at)), at, n);
  }
  EXPECT_EQ(count(watch, AlarmKind::rate_step), once);
}

TEST_F(MonitorAlarmsTest, WhatComesWhileTheDiskIsFullIsWrittenLater) {
  options_.place.start = began + -100.0; // so that a day begins while it is full
  {
    ClockWatch watch(options_);
    hear(watch, 0, 50);
    {
      const FullDisk disk(0);
      hear(watch, 50, 300); // over midnight
      EXPECT_EQ(count(watch, AlarmKind::archive_failing), begins);
      EXPECT_EQ(watch.heard(), 300);
      EXPECT_EQ(watch.acknowledged(), 50);
    }
    hear(watch, 300, 400);
    EXPECT_EQ(count(watch, AlarmKind::archive_failing), ends);
    EXPECT_EQ(watch.acknowledged(), 400);
    EXPECT_EQ(watch.going().last()->cycle, 399);
  }
  const Archive archive(options_.folder);
  std::size_t events = 0;
  for (const std::string& day : archive.days())
    events += archive.events_of(day).size();
  EXPECT_EQ(events, 400U);
  EXPECT_EQ(archive.days().size(), 2U);
  EXPECT_EQ(archive.origin(), began + -100.0); // its second header has it
}

TEST_F(MonitorAlarmsTest, WhatCannotBeKeptIsCountedAndSaid) {
  options_.most_pending = 50;
  ClockWatch watch(options_);
  hear(watch, 0, 50);
  {
    const FullDisk disk(0);
    hear(watch, 50, 300);
    EXPECT_EQ(watch.lost(), 200);
  }
  hear(watch, 300, 400);
  EXPECT_EQ(watch.acknowledged(), 200);
  EXPECT_EQ(watch.heard(), 400);
  EXPECT_EQ(watch.going().last()->cycle, 399); // the count goes on
  int told = 0;
  std::ifstream day(options_.folder + "/" + day_of(began) + ".csv");
  for (std::string line; std::getline(day, line);)
    told += line.starts_with("# 200 events were lost") ? 1 : 0;
  EXPECT_EQ(told, 1);
}

TEST_F(MonitorAlarmsTest, AnArchiveThatIsFullFromTheBeginning) {
  ClockWatch watch(options_);
  {
    const FullDisk disk(0);
    hear(watch, 0, 100);
    EXPECT_EQ(count(watch, AlarmKind::archive_failing), begins);
  }
  hear(watch, 100, 200);
  EXPECT_EQ(count(watch, AlarmKind::archive_failing), ends);
  EXPECT_EQ(watch.acknowledged(), 200);
}

TEST(AlarmCommandsTest, OneThatFailsIsNoticed) {
  const auto failure_of = [](const std::string& command) {
    AlarmCommands commands(command);
    commands.run({AlarmKind::stopped, true, {}, "it's quiet"});
    for (int tenth = 0; tenth < 300; ++tenth) { // a busy computer's half minute
      if (const auto failures = commands.take_failures(); !failures.empty()) return failures[0];
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      if (command == "true" && tenth == 10) break;
    }
    return std::string();
  };
  EXPECT_EQ(failure_of("[ \"$GOINGRATE_ALARM/$GOINGRATE_STATE\" = stopped/raised ] && exit 3"),
            "the command of alarm stopped failed with code 3");
  EXPECT_EQ(failure_of("true"), "");
}

} // namespace
} // namespace goingrate::apps
